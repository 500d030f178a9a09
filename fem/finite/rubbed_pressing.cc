#include "fem/finite/rubbed_pressing.h"

#include <algorithm>

#include "fem/finite/frictional_pressing.h"

namespace softfinger::fem::finite {

namespace {

/// Load steps of the coarser of two paths, per element along the shorter semi-axis, and at least:
/// on fine meshes fewer steps left 0.8 % of d. (A layer that sticks, R = 5 h, d/h = 0.35.)
constexpr int steps_per_element = 2, fewest_steps = 12;

/// The contact grows by nearly the same width in each step: a³ ~ P, a² ~ d.
Drive share_of(const Drive& drive, int step, int steps) {
  const double size = static_cast<double>(step) / steps;
  return {size * size * size * drive.load, size * size * drive.approach};
}

}  // namespace

RubbedPressing press_rubbing(const std::shared_ptr<FiniteLayer>& layer,
                             const std::shared_ptr<const RigidObject>& object,
                             const FrictionBound& bound, const Drive& drive) {
  const auto unloaded = layer->state();
  const auto first_touched = [&](int of_steps) {
    layer->restore(*unloaded);
    auto result = std::make_shared<FinitePressing>(layer, object);
    result->press(share_of(drive, 1, of_steps));
    return result;
  };
  const auto press_on = [&](FrictionalPressing& contact, int of_steps) {
    for (int step = 2; step <= of_steps; ++step) contact.press_to(share_of(drive, step, of_steps));
  };
  const auto places_by = [&](int of_steps) {
    const auto start = first_touched(of_steps);
    FrictionalPressing contact(*start, bound);
    press_on(contact, of_steps);
    return contact.places();
  };
  const int steps =
      std::max(fewest_steps, steps_per_element * layer->discretisation().elements_per_semi_axis);
  const Eigen::Matrix3Xd coarse = places_by(steps);

  RubbedPressing result;
  result.pressing = first_touched(2 * steps);
  FrictionalPressing::State state;
  double out_of_balance = 0;
  {
    FrictionalPressing contact(*result.pressing, bound);
    press_on(contact, 2 * steps);
    result.stick_share = 1 - contact.slip_fraction();
    contact.settle_at(2 * contact.places() - coarse);
    state = contact.present();
    out_of_balance = contact.out_of_balance();
  }
  layer->restore(*state.layer);
  result.pressing->take_over(state.force, state.approach, out_of_balance);
  return result;
}

}  // namespace softfinger::fem::finite
