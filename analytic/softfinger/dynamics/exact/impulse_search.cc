#include "softfinger/dynamics/exact/impulse_search.h"

#include <algorithm>

#include "softfinger/dynamics/contacts/contact_residual.h"
#include "softfinger/dynamics/exact/gauss_seidel.h"

namespace softfinger::internal {
namespace {

/// |F| of points that are close enough for Newton's method, or for easing.
constexpr double kClose = 1e-6;
/// Rounding may give wedged bodies these velocities over their natural size, tried in turn.
constexpr double kStillOfWedged[ImpulseSearch::kEasedStarts] = {1e-9, 1e-8, 1e-7, 1e-6};
/// The least impulses from which proximal points go on are as accurate as this.
constexpr double kEasedAccuracy = 1e-8;

/// Newton's values are within their bounds to the rounding of velocities. The torque of a short arm
/// hardly makes any, so that it can be much farther outside. Taken is the impulse within that
/// changes the velocities least, then the last digit is cut off.
Eigen::Vector4d within_limit(const ContactOperator& contacts, int i, Eigen::Vector4d own) {
  if (!(own[0] > 0)) return Eigen::Vector4d::Zero();
  const FrictionShape* shape = contacts.shape(i);
  auto friction = own.tail<3>();
  if (!(friction_gauge(shape, friction) > own[0])) return own;
  const Eigen::Vector3d metric = contacts.friction_metric(i);
  friction -= friction_excess(shape, metric.cwiseProduct(friction), own[0], metric)
                  .excess.cwiseQuotient(metric);
  const double gauge = friction_gauge(shape, friction);
  if (gauge > own[0]) friction *= own[0] / gauge;
  return own;
}

}  // namespace

ImpulseSearch::ImpulseSearch(const ContactOperator& contacts, int contact_capacity)
    : contacts_(contacts),
      newton_(contact_capacity),
      least_(contact_capacity),
      best_impulse_(4 * contact_capacity),
      impulse_(4 * contact_capacity),
      velocity_(4 * contact_capacity),
      wedged_(4 * contact_capacity) {}

void ImpulseSearch::start(int sweeps) { sweep(contacts_, sweeps, impulse_, velocity_); }

void ImpulseSearch::approach(const Task& task, int most_iterations, Effort effort) {
  const double reached = newton_.approach(contacts_, impulse_, most_iterations, effort.start);
  task.result.newton_iterations += newton_.iterations();
  keep_if_better(task);
  if (reached > kClose) return;
  if (reached > kGood || best_.residual > kSolved) polish(task, effort);
  if (best_.residual > kSolved) ease(task, effort);
}

/// Bodies that are wedged by impulses up to a thousand times larger than needed hide the solution
/// in the rounding of W r. Proximal points come closer from the least impulses that make the same
/// velocities.
void ImpulseSearch::ease(const Task& task, Effort effort) {
  wedged_.head(size()) = impulse_.head(size());
  for (int number = 0; number < effort.eased_starts; ++number) {
    if (!go_to_eased(task, number)) continue;
    if (best_.residual <= kSolved) return;
    newton_.approach(contacts_, impulse_, kMostIterationsOfEased);
    task.result.newton_iterations += newton_.iterations();
    keep_if_better(task);
    if (best_.residual <= kSolved) return;
  }
}

/// Goes to the least impulses with the velocities of wedged_. Which contacts stick and which slide
/// is uncertain, so that there are several candidates. False if this one does not exist.
bool ImpulseSearch::go_to_eased(const Task& task, int number) {
  impulse_.head(size()) = wedged_.head(size());
  contacts_.find_velocity(impulse_, velocity_);
  velocity_.head(size()) += contacts_.free_velocity().head(size());
  if (!least_.find(task.problem, contacts_, velocity_, impulse_, kStillOfWedged[number],
                   kEasedAccuracy))
    return false;
  keep_if_better(task);
  return true;
}

void ImpulseSearch::polish(const Task& task, Effort effort) {
  newton_.solve(contacts_, impulse_, effort.passes, effort.patience);
  task.result.newton_iterations += newton_.iterations();
  keep_if_better(task);
}

ImpulseSearch::Corrected ImpulseSearch::correct(const Task& task) {
  ++task.result.newton_iterations;
  if (least_.follow(contacts_, impulse_)) {
    keep_if_better(task);
    if (best_.is_good) return {true, true};
  }
  impulse_.head(size()) = best_impulse_.head(size());
  const bool corrected = newton_.correct(contacts_, impulse_);
  task.result.newton_iterations += newton_.iterations();
  keep_if_better(task);
  return {corrected && best_.is_good, false};
}

void ImpulseSearch::keep_if_better(const Task& task) {
  const double residual = extract(task);
  const bool is_rounded = residual > kSolved && residual <= kMostRounding &&
                          residual <= rounding_of(task.problem, task.solution);
  if (!best_.is_worse_than(residual, is_rounded)) return;
  best_.residual = residual;
  best_.is_good = task.is_good(residual);
  best_.is_rounded = is_rounded;
  best_impulse_.head(size()) = impulse_.head(size());
}

double ImpulseSearch::restore_best(const Task& task) {
  impulse_ = best_impulse_;
  return extract(task);
}

void ImpulseSearch::take_least_impulse(const Task& task) {
  impulse_ = best_impulse_;
  contacts_.find_velocity(impulse_, velocity_);
  velocity_.head(size()) += contacts_.free_velocity().head(size());
  if (!least_.find(task.problem, contacts_, velocity_, impulse_)) return;
  double reached = extract(task);
  const double residual = task.result.residual;
  // The velocities stay the same. But what is left of them where a contact sticks counts as soon as
  // it is loaded: the residual may be several times that of before, and is as much rounding.
  constexpr double kSeveral = 10;
  double accepted = residual > kSolved ? residual : std::min(kSeveral * residual, kSolved);
  // If bodies rest, a further correction leaves rounding alone, however much larger it is.
  if (reached > accepted && least_.follow(contacts_, impulse_)) {
    reached = extract(task);
    accepted = std::max(residual, kSolved);
  }
  if (reached <= accepted || task.is_good(reached)) {
    task.result.residual = reached;
  } else {
    task.result.residual = restore_best(task);
    least_.forget();
  }
}

/// Writes `impulse_` in the problem's units; returns its residual.
double ImpulseSearch::extract(const Task& task) const {
  ContactSolution& solution = task.solution;
  for (int i = 0; i < contacts_.contacts(); ++i) {
    const Eigen::Vector4d own = within_limit(contacts_, i, impulse_.segment<4>(4 * i));
    solution.impulse.segment<4>(4 * i) =
        contacts_.velocity_unit() * contacts_.impulse_scale().segment<4>(4 * i).cwiseProduct(own);
  }
  solution.velocity = task.problem.free_velocity;
  add_response(task.problem, solution.impulse, solution.velocity);
  return complete(task);
}

double ImpulseSearch::complete(const Task& task) const {
  for (int i = 0; i < contacts_.contacts(); ++i) {
    const Eigen::Vector3d slip = scaled_slip(task.problem, task.solution, i);
    task.solution.slip[i] =
        slip.squaredNorm() > 0 ? slip.dot(contacts_.boundary_point(i, slip)) : 0;
  }
  return exact_residual_of(task.problem, task.solution);
}

}  // namespace softfinger::internal
