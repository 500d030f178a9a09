#include "fem/levels/friction_levels.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fem/base/threads.h"
#include "fem/levels/error_model.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

bool turns_about_centre(const FrictionRequest& request) {
  return request.twist_axis_x_m == 0 && request.twist_axis_y_m == 0;
}

double torque_of_pressure(const PressedContact& contact) {
  double sum = 0;
  const auto& nodes = contact.model.nodes();
  const Eigen::VectorXd friction = largest_friction(contact);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    sum += friction[static_cast<Eigen::Index>(i)] * nodes[i].position.head<2>().norm();
  return copies(contact) * sum;
}

Wrench in_newtons(const FrictionWrench& wrench, const Problem& problem) {
  const double h = problem.contact.layer.thickness_m;
  const double force = problem.contact.layer.youngs_modulus_Pa * h * h;
  return {force * wrench.force_x, force * wrench.force_y, force * h * wrench.torque};
}

}  // namespace

FrictionPlan plan_friction(const FrictionScale& scale, const Problem& problem) {
  const FrictionRequest& request = problem.friction;
  const double h = problem.contact.layer.thickness_m;
  FrictionPlan plan;
  if (request.torsion) {
    // The unit is the angle at which a contact that sticks everywhere would carry the whole torque.
    // At 0.7 of it the contact carries half the torque; by about 8 slip has reached the innermost
    // nodes.
    const double unit = scale.torque / scale.stiffness, first = 0.05, last = 10;
    for (int i = 0; i < request.increments; ++i) {
      const double share =
          request.increments > 1 ? static_cast<double>(i) / (request.increments - 1) : 1;
      const double angle = unit * first * std::pow(last / first, share);
      plan.twist.push_back(
          {angle * request.twist_axis_y_m / h, -angle * request.twist_axis_x_m / h, angle});
    }
  }
  const double arm = scale.torque / scale.force;
  plan.velocities = spread_velocities(request.limit_surface, arm);
  if (request.increments_to_slip > 0)
    for (const PlaneMotion& velocity : plan.velocities) {
      // A half-space slips everywhere after about mu P / (4 G b); a layer is stiffer and slips
      // earlier. The first steps are the smallest, because slip begins at once at the edge.
      const double smallest_shear_modulus = 1.0 / 3;  // in units of E
      const double reach = scale.force / (smallest_shear_modulus * scale.b) /
                           std::hypot(velocity.x, velocity.y, arm * velocity.turn_rad);
      std::vector<PlaneMotion> path;
      for (int i = 1; i <= request.increments_to_slip; ++i) {
        const double share = static_cast<double>(i) / request.increments_to_slip;
        const double distance = reach * share * share;
        path.push_back(
            {distance * velocity.x, distance * velocity.y, distance * velocity.turn_rad});
      }
      plan.paths.push_back(std::move(path));
    }
  return plan;
}

namespace {

std::vector<FrictionIncrement> in_newtons(const std::vector<FrictionState>& states,
                                          const Problem& problem) {
  const double h = problem.contact.layer.thickness_m;
  std::vector<FrictionIncrement> result;
  for (const FrictionState& state : states)
    result.push_back({state.motion.x * h, state.motion.y * h, state.motion.turn_rad,
                      in_newtons(state.wrench, problem), state.slip_fraction, state.sheared});
  return result;
}

void twist(const PressedContact& contact, const SurfaceCompliance& surface,
           const FrictionPlan& plan, const OrderedProgress& progress, const OnState& on_state,
           FrictionOfLevel& result) {
  progress("friction: twist of " + std::to_string(plan.twist.size()) + " increments, " +
           std::to_string(surface.size() * surface.copies) + " contact points");
  result.twist = move_through(contact, surface, plan.twist, on_state);
  result.full_slip = slide_through(contact, surface, {plan.twist.back()}).front().wrench.torque;
  progress("friction: slip on " +
           std::to_string(std::lround(100 * result.twist.back().slip_fraction)) +
           " % of the area at the last increment");
}

/// The limit surface, and paths to some of its points.
void slide(const PressedContact& contact, const SurfaceCompliance& surface,
           const FrictionPlan& plan, const OrderedProgress& progress, FrictionOfLevel& result) {
  progress("friction: limit surface of " + std::to_string(plan.velocities.size()) + " points, " +
           std::to_string(surface.size()) + " contact points");
  result.limit_surface = slide_through(contact, surface, plan.velocities);
  const std::size_t paths = plan.paths.size();
  result.paths.resize(paths);
  std::vector<OrderedProgress> tell;
  for (std::size_t i = 0; i < paths; ++i) tell.push_back(progress.place());
  in_parallel(static_cast<int>(paths), [&](int number) {
    const auto i = static_cast<std::size_t>(number);
    result.paths[i] = move_through(contact, surface, plan.paths[i], [](auto&&...) {});
    tell[i]("friction: path " + std::to_string(i + 1) + " of " + std::to_string(paths));
    tell[i].close();
  });
}

FrictionOfLevel friction_within_margin(const PressedContact& contact, const Problem& problem,
                                       KeptCompliances* kept, std::optional<FrictionPlan>& plan,
                                       const OrderedProgress& progress, const OnState& on_state) {
  const FrictionRequest& request = problem.friction;
  FrictionOfLevel result;
  const bool central = turns_about_centre(request);
  const bool symmetric = contact.model.planes().both();
  const Invariance of_twist = symmetric && central ? Invariance::half_turn : Invariance::none;
  const QuarterCompliances quarters =
      friction_compliances(contact, request.limit_surface == 0 ? of_twist : Invariance::none, kept);
  result.stiffness = stuck_torsional_stiffness(contact, quarters);
  if (!plan)
    plan = plan_friction({result.stiffness, torque_of_pressure(contact),
                          copies(contact) * largest_friction(contact).sum(), contact.b},
                         problem);
  std::optional<SurfaceCompliance> of_twisted, of_any_motion;
  if (request.torsion) of_twisted = surface_compliance(quarters, of_twist);
  const bool is_shared = of_twisted && of_twist == Invariance::none;
  const auto learn = [&](const std::vector<FrictionState>& states) {
    // The edge is known to half the distance of the nodes, which is a quarter of a cell.
    const double blur = 0.25 / contact.model.discretisation().elements_per_semi_axis;
    for (const FrictionState& state : states) plan->edge = std::max(plan->edge, state.edge + blur);
  };
  const OrderedProgress of_first = progress.place();
  side_by_side(
      [&] {
        if (of_twisted) twist(contact, *of_twisted, *plan, of_first, on_state, result);
        learn(result.twist);
        of_first.close();
      },
      [&] {
        if (request.limit_surface == 0) return;
        if (!is_shared)
          of_any_motion = surface_compliance(
              quarters, Invariance::none,
              request.increments_to_slip > 0 ? Blocks::all : Blocks::without_tangential);
        slide(contact, is_shared ? *of_twisted : *of_any_motion, *plan, progress, result);
      });
  learn(result.limit_surface);
  return result;
}

TouchedRegion region_of(const PressedContact& contact, const FrictionOfLevel& friction) {
  const auto& nodes = contact.model.nodes();
  std::vector<char> touched(nodes.size(), 0);
  const auto add = [&](const std::vector<FrictionState>& states) {
    for (const FrictionState& state : states)
      for (const int node : state.touching) touched[static_cast<std::size_t>(node)] = 1;
  };
  add(friction.twist);
  add(friction.limit_surface);
  for (const auto& path : friction.paths) add(path);
  TouchedRegion region;
  region.a = contact.a;
  region.b = contact.b;
  region.spacing = 0.5 / contact.model.discretisation().elements_per_semi_axis;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (touched[i] || contact.force[static_cast<Eigen::Index>(i)] > 0)
      region.places.emplace_back(nodes[i].x / region.a, nodes[i].y / region.b);
  return region;
}

}  // namespace

FrictionOfLevel friction_on(PressedContact contact, const Problem& problem, KeptCompliances* kept,
                            std::optional<FrictionPlan>& plan, const OrderedProgress& progress,
                            const OnState& on_state) {
  // A margin of one cell around the contact is enough for nearly every one, and each node in it
  // costs time.
  const LayerDiscretisation& mesh = contact.model.discretisation();
  const double all = (mesh.patch - contact.edge) * mesh.elements_per_semi_axis;
  if (plan) {
    contact.margin =
        std::max(1.0, (plan->edge - contact.edge) * mesh.elements_per_semi_axis + spare_margin);
    contact.region = plan->region;
  }
  contact.margin = std::min(contact.margin, all);
  FrictionOfLevel result;
  try {
    result = friction_within_margin(contact, problem, kept, plan, progress, on_state);
  } catch (const EdgeLeftMargin&) {
    if (contact.margin >= all && contact.region.places.empty()) throw;
    contact.margin = all;
    contact.region = {};
    progress(
        "friction: the contact's edge moves by more than a cell; once more on all of the patch");
    result = friction_within_margin(contact, problem, kept, plan, progress, on_state);
  }
  plan->region = region_of(contact, result);
  result.starts_as_pressed = contact.rubbed.has_value();
  return result;
}

namespace {

/// Largest difference of two levels' torques through the twist, relative to full slip.
double curve_difference(const FrictionOfLevel& coarse, const FrictionOfLevel& fine) {
  double largest = 0;
  for (std::size_t i = 0; i < fine.twist.size(); ++i)
    largest =
        std::max(largest, std::abs(coarse.twist[i].wrench.torque - fine.twist[i].wrench.torque) /
                              std::abs(fine.full_slip));
  return largest;
}

/// @param found  on the finer mesh
/// @param fine   the same, corrected
Torsion state_torsion(const FrictionOfLevel& coarse, const FrictionOfLevel& found,
                      const FrictionOfLevel& fine, double refinement, int elements,
                      const Problem& problem) {
  const double h = problem.contact.layer.thickness_m;
  const double torque_unit = problem.contact.layer.youngs_modulus_Pa * h * h * h;
  const auto stiffness =
      extrapolated_stiffness(coarse.stiffness, fine.stiffness, refinement, elements);
  const auto error = [&](double difference, double neglected) {
    return stated_error(difference, refinement, friction_integral) + neglected;
  };
  Torsion torsion;
  torsion.pressing = fine.starts_as_pressed ? problem.pressing : PressingFriction::none;
  torsion.increments = in_newtons(fine.twist, problem);
  torsion.stiffness_Nm_per_rad = torque_unit * stiffness.value;
  torsion.stiffness_error = stiffness.error;
  torsion.full_slip_Nm = torque_unit * fine.full_slip;
  torsion.full_slip_error =
      error(std::abs(coarse.full_slip / found.full_slip - 1), fine.neglected_of_full_slip);
  torsion.curve_error = error(curve_difference(coarse, found), fine.neglected_of_twist);
  return torsion;
}

/// Largest of the components, forces and torque relative to the largest ones.
double difference(const Wrench& one, const Wrench& other, double force_N, double torque_Nm) {
  return std::max({std::abs(one.force_x_N - other.force_x_N) / force_N,
                   std::abs(one.force_y_N - other.force_y_N) / force_N,
                   std::abs(one.torque_Nm - other.torque_Nm) / torque_Nm});
}

}  // namespace

namespace {

void add(const std::vector<FrictionState>& changes, double torque_ratio,
         std::vector<FrictionState>& states) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    states[i].wrench.force_x += changes[i].wrench.force_x;
    states[i].wrench.force_y += changes[i].wrench.force_y;
    states[i].wrench.torque += torque_ratio * changes[i].wrench.torque;
    states[i].slip_fraction = changes[i].slip_fraction;
    states[i].sheared = changes[i].sheared;
  }
}

}  // namespace

FrictionOfLevel corrected(const FrictionOfLevel& fine, const FrictionOfLevel& coarse) {
  FrictionOfLevel result = fine;
  if (!coarse.correction) return result;
  const FrictionCorrection& correction = *coarse.correction;
  const double torque_ratio = fine.full_slip / coarse.full_slip;
  add(correction.twist, torque_ratio, result.twist);
  add(correction.limit_surface, torque_ratio, result.limit_surface);
  for (std::size_t i = 0; i < result.paths.size(); ++i)
    add(correction.paths[i], torque_ratio, result.paths[i]);
  result.full_slip += torque_ratio * correction.full_slip;
  result.starts_as_pressed = correction.starts_as_pressed;
  result.neglected_of_twist = correction.twist_error;
  result.neglected_of_full_slip = correction.full_slip_error;
  result.neglected_of_slide = correction.slide_error;
  return result;
}

void state_friction(const FrictionOfLevel& coarse, const FrictionOfLevel& found, double refinement,
                    const Problem& problem, Result& result) {
  const FrictionOfLevel fine = corrected(found, coarse);
  if (problem.friction.torsion)
    result.torsion = state_torsion(coarse, found, fine, refinement,
                                   result.finest.elements_per_semi_axis, problem);
  if (fine.limit_surface.empty()) return;
  const double force_limit_N = result.finest.max_force_N;
  double largest = 0;
  for (std::size_t i = 0; i < fine.limit_surface.size(); ++i) {
    LimitPoint point;
    point.wrench = in_newtons(fine.limit_surface[i].wrench, problem);
    point.sheared = fine.limit_surface[i].sheared;
    if (!fine.paths.empty()) point.path = in_newtons(fine.paths[i], problem);
    largest = std::max(largest, difference(in_newtons(found.limit_surface[i].wrench, problem),
                                           in_newtons(coarse.limit_surface[i].wrench, problem),
                                           force_limit_N, result.finest.max_torque_Nm));
    result.limit_surface.push_back(std::move(point));
  }
  result.limit_surface_error =
      stated_error(largest, refinement, friction_integral) + fine.neglected_of_slide;
}

}  // namespace softfinger::fem
