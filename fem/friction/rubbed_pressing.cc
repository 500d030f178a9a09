#include "fem/friction/rubbed_pressing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fem/algebra/positive_definite.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

using Eigen::Index;

namespace {

/// Load steps of the coarser of two paths, per element along the shorter semi-axis, and at least.
constexpr int steps_per_element = 2, fewest_steps = 12;

/// The contact grows by nearly the same width in each step: a³ ~ P.
double share_of_load(int step, int steps) {
  const double size = static_cast<double>(step) / steps;
  return size * size * size;
}

FrictionalContact pressed_in_steps(const SurfaceCompliance& surface, const Eigen::VectorXd& gap,
                                   const FrictionBound& bound, double load, int steps) {
  const Index count = surface.size();
  FrictionalContact contact(surface, gap, load, bound,
                            {Eigen::VectorXd::Zero(count), Eigen::VectorXd::Zero(2 * count),
                             Eigen::VectorXd::Zero(2 * count), 0});
  for (int step = 1; step <= steps; ++step) contact.press_to(share_of_load(step, steps) * load);
  return contact;
}

/// A contact and the share of its area that stuck in the last step: the extrapolated slip is none
/// that a step has made.
struct Extrapolated {
  FrictionalContact contact;
  double stick_share;
};

Extrapolated pressed_to(const SurfaceCompliance& surface, const Eigen::VectorXd& gap,
                        const FrictionBound& bound, double load, int steps) {
  const Eigen::VectorXd coarse = pressed_in_steps(surface, gap, bound, load, steps).state().slip;
  FrictionalContact contact = pressed_in_steps(surface, gap, bound, load, 2 * steps);
  const double stick_share = 1 - contact.slip_fraction();
  contact.settle_slip(2 * contact.state().slip - coarse);
  return {std::move(contact), stick_share};
}

/// The contact whose approach is the one that is asked for: secant steps in the logarithms, between
/// which load is nearly a power of the approach.
Extrapolated pressed_at(const SurfaceCompliance& surface, const Eigen::VectorXd& gap,
                        const FrictionBound& bound, double approach, double guess, int steps) {
  constexpr int limit = 12;
  constexpr double tolerance = 1e-7;
  double load = guess, exponent = 1.5;
  double last_load = 0, last_approach = 0, off = 1;
  for (int iteration = 0; iteration < limit; ++iteration) {
    Extrapolated found = pressed_to(surface, gap, bound, load, steps);
    const double reached = found.contact.approach();
    off = approach / reached - 1;
    if (std::abs(off) <= tolerance) return found;
    if (last_load > 0 && reached != last_approach)
      exponent = std::log(load / last_load) / std::log(reached / last_approach);
    last_load = load;
    last_approach = reached;
    load *= std::pow(approach / reached, exponent);
  }
  throw ConvergenceError("load of a given approach with friction", limit, off,
                         "give the load in place of the approach");
}

}  // namespace

RubbedPressing press_rubbing(const PressedContact& contact, const QuarterCompliances& quarters,
                             const PressingGoal& goal) {
  const SurfaceCompliance surface = surface_compliance(quarters, Invariance::mirrors);
  const FrictionBound bound(contact.law, {});
  const Eigen::VectorXd gap = contact.gap(surface.model_node);
  const int steps = std::max(
      fewest_steps, steps_per_element * contact.model.discretisation().elements_per_semi_axis);
  const auto [pressed, stick_share] =
      goal.approach > 0 ? pressed_at(surface, gap, bound, goal.approach, contact.load, steps)
                        : pressed_to(surface, gap, bound, goal.load, steps);
  FrictionState last;
  find_touching(contact, surface, pressed, last);

  const RubbedState found = pressed.state();
  const Eigen::VectorXd lift = product_with_zeros(surface.normal_tangential, found.tangential);
  const auto nodes = static_cast<Index>(contact.model.nodes().size());
  RubbedPressing result;
  result.state = {Eigen::VectorXd::Zero(nodes), Eigen::VectorXd::Zero(2 * nodes),
                  Eigen::VectorXd::Zero(2 * nodes), found.approach};
  result.lift = Eigen::VectorXd::Zero(nodes);
  for (Index i = 0; i < surface.size(); ++i) {
    const Index node = surface.model_node[static_cast<std::size_t>(i)];
    result.state.normal[node] = found.normal[i];
    result.state.tangential.segment<2>(2 * node) = found.tangential.segment<2>(2 * i);
    result.state.slip.segment<2>(2 * node) = found.slip.segment<2>(2 * i);
    result.lift[node] = lift[i];
  }
  result.load = copies(contact) * found.normal.sum();
  result.stick_share = stick_share;
  return result;
}

}  // namespace softfinger::fem
