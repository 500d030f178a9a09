#include "fem/finite/rubbed_pressing.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "fem/finite/frictional_pressing.h"

namespace softfinger::fem::finite {

using Eigen::Index;

namespace {

/// Load steps of the coarser of two paths, per element along the shorter semi-axis, and at least:
/// on fine meshes fewer steps left 0.8 % of d. (A layer that sticks, R = 5 h, d/h = 0.35.)
constexpr int steps_per_element = 2, fewest_steps = 12;

/// The contact grows by nearly the same width in each step: a³ ~ P, a² ~ d.
Drive share_of(const Drive& drive, int step, int steps) {
  const double size = static_cast<double>(step) / steps;
  return {size * size * size * drive.load, size * size * drive.approach};
}

/// The nodes of a contact in the object's frame.
Eigen::Matrix3Xd places_of(const FinitePressing& pressing) {
  const FiniteLayer& layer = pressing.layer();
  Eigen::Matrix3Xd result(3, static_cast<Index>(layer.nodes().size()));
  for (Index i = 0; i < result.cols(); ++i)
    result.col(i) = layer.position(static_cast<std::size_t>(i));
  result.row(2).array() += pressing.equilibrium().approach;
  return result;
}

/// A smooth field near values at scattered places of the plane: a linear one and cubes of the
/// distances from them (Duchon's splines), bent the less the longer `blur` is. Rings of nodes come
/// to touch early or late in a load step, which scatters what they remember.
class SmoothField {
 public:
  SmoothField(const Eigen::Matrix2Xd& place, const Eigen::Matrix3Xd& value, double blur)
      : place_(place) {
    const Index count = place.cols();
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count + 3, count + 3);
    for (Index i = 0; i < count; ++i) matrix.col(i) = terms(place.col(i));
    matrix.rightCols<3>() = matrix.bottomRows<3>().transpose().eval();
    matrix.bottomRightCorner<3, 3>().setZero();
    matrix.diagonal().head(count).array() += std::pow(blur, 3);
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count + 3, 3);
    right.topRows(count) = value.transpose();
    weight_ = matrix.partialPivLu().solve(right);
  }

  Eigen::Vector3d operator()(const Eigen::Vector2d& at) const {
    return weight_.transpose() * terms(at);
  }

 private:
  Eigen::VectorXd terms(const Eigen::Vector2d& at) const {
    Eigen::VectorXd result(place_.cols() + 3);
    result.head(place_.cols()) =
        (place_.colwise() - at).colwise().norm().array().cube().transpose();
    result.tail<3>() << 1, at;
    return result;
  }

  Eigen::Matrix2Xd place_;
  Eigen::MatrixXd weight_;
};

/// Takes over the state that friction has led to.
void take_over(FrictionalPressing::State state, double out_of_balance, FiniteLayer& layer,
               FinitePressing& pressing) {
  layer.restore(*state.layer);
  pressing.take_over(state.force, state.approach, out_of_balance);
}

}  // namespace

Drag drag_to(const Eigen::Matrix3Xd& places, const FinitePressing& with_friction,
             const FinitePressing& frictionless) {
  std::vector<Index> touching;
  for (Index i = 0; i < places.cols(); ++i)
    if (with_friction.equilibrium().force[i] > 0) touching.push_back(i);
  Drag result;
  result.node.resize(2, static_cast<Index>(touching.size()));
  for (Index i = 0; i < result.node.cols(); ++i) {
    const auto& node =
        with_friction.layer()
            .nodes()[static_cast<std::size_t>(touching[static_cast<std::size_t>(i)])];
    result.node.col(i) << node.x, node.y;
  }
  result.moved = (places - places_of(frictionless))(Eigen::all, touching);
  result.spacing = node_spacing(with_friction.layer().discretisation());
  result.planes = with_friction.layer().planes();
  return result;
}

Eigen::Matrix3Xd dragged_places(const FinitePressing& frictionless, const Drag& drag) {
  Eigen::Matrix3Xd places = places_of(frictionless);
  constexpr double spacings = 1.5;
  const SmoothField moved(drag.node, drag.moved, spacings * drag.spacing);
  const auto& nodes = frictionless.layer().nodes();
  for (Index i = 0; i < places.cols(); ++i) {
    if (!(frictionless.equilibrium().force[i] > 0)) continue;
    const auto& node = nodes[static_cast<std::size_t>(i)];
    const Eigen::Vector3d signs(drag.planes.x && node.x < 0 ? -1 : 1,
                                drag.planes.y && node.y < 0 ? -1 : 1, 1);
    places.col(i) +=
        signs.cwiseProduct(moved(signs.head<2>().cwiseProduct(Eigen::Vector2d(node.x, node.y))));
  }
  return places;
}

RubbedPressing press_rubbing(const FinitePressing& frictionless,
                             const std::shared_ptr<FiniteLayer>& layer, const FrictionBound& bound,
                             const Drive& drive) {
  const auto unloaded = layer->state();
  const auto first_touched = [&](int of_steps) {
    layer->restore(*unloaded);
    auto result = std::make_shared<FinitePressing>(layer, frictionless.object());
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
  Eigen::Matrix3Xd places;
  double out_of_balance = 0, stick_share = 0;
  {
    FrictionalPressing contact(*result.pressing, bound);
    press_on(contact, 2 * steps);
    // The extrapolated places are none that a step has made.
    stick_share = 1 - contact.slip_fraction();
    places = 2 * contact.places() - coarse;
    contact.settle_at(places, drive);
    state = contact.present();
    out_of_balance = contact.out_of_balance();
  }
  take_over(std::move(state), out_of_balance, *layer, *result.pressing);
  result.drag = drag_to(places, *result.pressing, frictionless);
  result.drag.stick_share = stick_share;
  return result;
}

RubbedPressing press_dragged(const FinitePressing& frictionless,
                             const std::shared_ptr<FiniteLayer>& layer, const FrictionBound& bound,
                             const Drive& drive, const Drag& drag) {
  RubbedPressing result;
  result.drag = drag;
  result.pressing = std::make_shared<FinitePressing>(layer, frictionless.object());
  result.pressing->continue_from(frictionless);
  result.pressing->press(drive);
  const Eigen::Matrix3Xd places = dragged_places(*result.pressing, drag);
  FrictionalPressing::State state;
  double out_of_balance = 0;
  {
    FrictionalPressing contact(*result.pressing, bound);
    contact.settle_at(places, drive);
    state = contact.present();
    out_of_balance = contact.out_of_balance();
  }
  take_over(std::move(state), out_of_balance, *layer, *result.pressing);
  return result;
}

}  // namespace softfinger::fem::finite
