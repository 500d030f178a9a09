#include "softfinger/dynamics/exact_friction.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/dynamics/contact_residual.h"
#include "softfinger/dynamics/gauss_seidel.h"
#include "softfinger/dynamics/repeatable_random.h"

namespace softfinger::internal {
namespace {

/// Newton's passes in a start from the last problem's impulses and in one from its basis. They are
/// few, because a problem that they do not solve is solved by a cold start.
constexpr int kPassesFromImpulse = 1, kPassesFromBasis = 2;
/// Sweeps of Gauss-Seidel before each of Newton's attempts without a path.
constexpr int kSweeps[] = {20, 40, 80, 160, 320, 640};
/// From that many contacts on, with friction of the ball or of shapes, proximal points are tried
/// before any path, after a few sweeps: a path would take longer. Shapes cost more per iteration.
constexpr int kManyContacts = 16, kManyShapes = 40, kFirstSweeps = 10;
/// All normal impulses before these sweeps; an impulse of 1 gives its contact the largest free
/// velocity. Of scenes of 100 random contacts 9 in 10 are solved from the first start, 36 in 37
/// from the three.
constexpr double kStarts[] = {0, 10, 100};
constexpr int kMostIterations = 400;
/// Then each contact has an impulse of its own, drawn between these, evenly in its logarithm. Where
/// the three failed, 1 in 1,200 iterations ends in a solution, whichever start they belong to: a
/// path costs as much as thousands. Of more contacts than the hundred that this was measured with
/// an iteration may cost the square of their number more.
constexpr double kLeastDrawn = 0.1, kMostDrawn = 1000;
constexpr int kMostIterationsOfDrawn = 1000, kMostIterationsInAll = 6000, kMostDraws = 60;
constexpr double kMeasuredContacts = 100;
/// Where Newton's method does not converge from a path's end, proximal points may.
constexpr int kMostIterationsAfterPath = 150;
/// Proximal points closer than this are close enough for Newton's method.
constexpr double kClose = 1e-6;
/// Of wedged bodies: velocities over their natural size that rounding may make, tried in turn, and
/// the proximal points from each.
constexpr double kStillOfWedged[] = {1e-9, 1e-8, 1e-7, 1e-6};
constexpr int kMostIterationsOfWedged = 100;
/// Newton's method may stop short of round-off between contacts that are nearly the same. After
/// that many paths of an attempt a solution is good enough, because others rarely come closer.
constexpr int kPathsForGood = 4;
// The attempts. Newton's method finds the last digits, so that no path has to allow smaller pivots.

constexpr Attempt with_newton(Attempt path, int passes, int patience) {
  path.newton_passes = passes;
  path.newton_patience = patience;
  return path;
}
/// A pass that converges halves |F| within a few iterations. Contacts that are the same to nine
/// digits can hold it up for hundreds.
constexpr int kUsualPatience = 20, kLongPatience = 300;
constexpr int kImpatientAttempts = 4, kFewContacts = 20;
/// The first attempt is cheap: Newton's method tries its smallest proximal term only.
constexpr Attempt kFirst = with_newton(kQuick, 2, kUsualPatience);
/// Later attempts run all passes of Newton's method. A larger tolerance of the ratio test
/// alternates with the usual one.
constexpr Attempt kTolerant =
    with_newton({1e-11, 1e-9, 1}, ExactNewton::kMostPasses, kUsualPatience);
constexpr Attempt kUsual = with_newton(kCareful, ExactNewton::kMostPasses, kUsualPatience);
/// Every other one after the first few.
constexpr Attempt kPatient = with_newton(kCareful, ExactNewton::kMostPasses, kLongPatience);

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

ExactFriction::ExactFriction(ContactSystem& system, int contact_capacity)
    : system_(system),
      newton_(contact_capacity),
      least_(contact_capacity),
      impulse_(4 * contact_capacity),
      best_impulse_(4 * contact_capacity),
      velocity_(4 * contact_capacity),
      swept_(4 * contact_capacity),
      wedged_(4 * contact_capacity) {}

void ExactFriction::begin(const ContactLcp& problem) {
  forget_best();
  is_still_ = false;
  newton_.begin_problem();
  system_.set_with_own_vertices(problem, kOwnVertices);
}

const Attempt& ExactFriction::attempt(int number) const {
  if (number == 0) return kFirst;
  if (number >= kImpatientAttempts && number % 2 == 0) return kPatient;
  return number % 2 == 1 ? kTolerant : kUsual;
}

void ExactFriction::start(const ContactLcp& problem, int number) {
  rounds_ = 0;
  newton_passes_ = attempt(number).newton_passes;
  // An iteration costs the cube of the contacts: many of them cannot wait as long.
  const int many = std::max(kFewContacts, system_.contacts());
  newton_patience_ = std::max(kUsualPatience, attempt(number).newton_patience * kFewContacts *
                                                  kFewContacts / (many * many));
  use_first_vertices(problem);
}

void ExactFriction::start_warm(const ContactLcp& problem) {
  rounds_ = 0;
  newton_passes_ = kPassesFromBasis;
  newton_patience_ = kUsualPatience;
  use_first_vertices(problem);
}

/// The first vertices of each contact are pure forces and pure torques.
void ExactFriction::use_first_vertices(const ContactLcp& problem) {
  system_.use_no_vertices();
  for (int i = 0; i < system_.contacts(); ++i) {
    if (!system_.contact_operator().has_friction(i)) continue;
    const int axes = problem.eccentricity_m[i] > 0 ? 3 : 2;
    for (int axis = 0; axis < axes; ++axis)
      for (const double sign : {1., -1.})
        system_.add_own_vertex(
            i, system_.contact_operator().boundary_point(i, sign * Eigen::Vector3d::Unit(axis)));
  }
}

bool ExactFriction::continue_impulse(const Task& task, const Eigen::VectorXd& last_impulse,
                                     const std::vector<int>& continued) {
  const ContactOperator& contacts = system_.contact_operator();
  for (int i = 0; i < contacts.contacts(); ++i) {
    impulse_.segment<4>(4 * i).setZero();
    const int before = continued[std::size_t(i)];
    if (before < 0) continue;
    for (int row = 0; row < (contacts.has_friction(i) ? 4 : 1); ++row) {
      const double scale = contacts.impulse_scale()[4 * i + row];
      if (scale > 0)
        impulse_[4 * i + row] = last_impulse[4 * before + row] / (contacts.velocity_unit() * scale);
    }
  }
  keep_if_better(task, extract(task));
  is_still_ = best_is_good_;
  if (is_still_ || correct(task, continued)) return true;
  newton_passes_ = kPassesFromImpulse;
  newton_patience_ = kUsualPatience;
  polish(task);
  return best_is_good_;
}

/// Bodies at rest, or in steady motion: the last least impulse follows them, or the matrix of
/// Newton's last step corrects it.
bool ExactFriction::correct(const Task& task, const std::vector<int>& continued) {
  const ContactOperator& contacts = system_.contact_operator();
  const int nc = contacts.contacts(), n = 4 * nc;
  bool is_same = true;
  for (int i = 0; i < nc; ++i) is_same = is_same && continued[std::size_t(i)] == i;
  if (!is_same) {
    least_.forget();
    return false;
  }
  ++task.result.newton_iterations;
  if (least_.follow(contacts, impulse_)) {
    keep_if_better(task, extract(task));
    if (best_is_good_) return is_still_ = true;
  }
  impulse_.head(n) = best_impulse_.head(n);
  const bool corrected = newton_.correct(contacts, impulse_);
  task.result.newton_iterations += newton_.iterations();
  keep_if_better(task, extract(task));
  return corrected && best_is_good_;
}

/// The vertex is moved along its direction onto the friction limit of this problem.
int ExactFriction::continue_vertex(const ContactPair& pair, const Eigen::Vector3d& corner) {
  const double gauge = friction_gauge(system_.contact_operator().shape(pair.contact), corner);
  return system_.find_or_add_own_vertex(pair.contact, corner / gauge);
}

bool ExactFriction::add_vertices(const Task& task) {
  const int n = 4 * system_.contacts();
  impulse_.head(n) = system_.current().impulse.head(n);
  // Of many contacts Newton's method alone converges from hardly any path's end.
  if (!is_many(task)) polish(task);
  if (best_residual_ > kSolved) {
    impulse_.head(n) = system_.current().impulse.head(n);
    approach(task, kMostIterationsAfterPath);
  }
  if (++rounds_ >= kPathsForGood && best_residual_ <= kSolved) best_is_good_ = true;
  return !best_is_good_ && add_violated_points();
}

bool ExactFriction::is_many(const Task& task) const {
  const bool has_shapes = task.problem.friction_rule == FrictionRule::limit_surface;
  return system_.contacts() >= (has_shapes ? kManyShapes : kManyContacts);
}

bool ExactFriction::do_before_path(const Task& task) {
  return is_many(task) && approach_from_starts(task);
}

/// By proximal points, from one start after another. Returns whether one led to a solution.
bool ExactFriction::approach_from_starts(const Task& task) {
  const ContactOperator& contacts = system_.contact_operator();
  newton_passes_ = kFirst.newton_passes;
  newton_patience_ = kUsualPatience;
  const auto approach_from = [&](const auto& normal_impulse, int most_iterations) {
    impulse_.head(4 * contacts.contacts()).setZero();
    for (int i = 0; i < contacts.contacts(); ++i) impulse_[4 * i] = normal_impulse(i);
    sweep(contacts, kFirstSweeps, impulse_, velocity_);
    const int before = task.result.newton_iterations;
    approach(task, most_iterations);
    return task.result.newton_iterations - before;
  };
  int iterations = 0;
  for (const double normal : kStarts) {
    iterations += approach_from([&](int) { return normal; }, kMostIterations);
    if (best_residual_ <= kSolved) return true;
  }
  const double larger = std::max(1., contacts.contacts() / kMeasuredContacts);
  for (int start = 0; start < kMostDraws && iterations * larger * larger < kMostIterationsInAll;
       ++start) {
    const auto drawn = [&](int contact) {
      return kLeastDrawn * std::pow(kMostDrawn / kLeastDrawn, hash_to_unit(start, contact));
    };
    iterations += approach_from(drawn, kMostIterationsOfDrawn);
    if (best_residual_ <= kSolved) return true;
  }
  return false;
}

/// Contacts repeated to nine digits can make every path end in a ray or in rounding. Gauss-Seidel's
/// sweeps come as close as a path does, if slowly.
void ExactFriction::do_without_path(const Task& task) {
  newton_passes_ = ExactNewton::kMostPasses;
  newton_patience_ = kLongPatience;
  swept_.head(4 * system_.contacts()).setZero();
  for (const int sweeps : kSweeps) {
    sweep(system_.contact_operator(), sweeps, swept_, velocity_);
    impulse_ = swept_;
    polish(task);
    if (best_residual_ <= kSolved) return;
  }
  if (!is_many(task)) approach_from_starts(task);
}

/// Adds vertices to each contact whose lambda = h(-u) the present vertices underestimate: the point
/// of the friction limit most opposite to the slip u, and the point grad h(nu) of
/// `friction_excess`.
bool ExactFriction::add_violated_points() {
  const ContactOperator& contacts = system_.contact_operator();
  const Motion& state = system_.current();
  bool found = false;
  for (int i = 0; i < contacts.contacts(); ++i) {
    if (!contacts.has_friction(i)) continue;
    const Eigen::Vector3d velocity = state.velocity.segment<3>(4 * i + 1);
    if (!(velocity.squaredNorm() > 0)) continue;
    const Eigen::Vector3d against = contacts.boundary_point(i, -velocity);
    const double known = state.slip[i] + kToleratedViolation * contacts.natural_size(i);
    if (-against.dot(velocity) <= known) continue;
    found |= system_.add_own_vertex(i, against);
    const Eigen::Vector3d metric = contacts.friction_metric(i);
    const FrictionExcess excess = friction_excess(
        contacts.shape(i), metric.cwiseProduct(state.impulse.segment<3>(4 * i + 1)) - velocity,
        state.impulse[4 * i], metric);
    if (excess.excess.squaredNorm() > 0) found |= system_.add_own_vertex(i, excess.boundary);
  }
  return found;
}

/// From `impulse_`, which may be far away, by proximal points; keeps the best point so far.
void ExactFriction::approach(const Task& task, int most_iterations) {
  const double reached = newton_.approach(system_.contact_operator(), impulse_, most_iterations);
  task.result.newton_iterations += newton_.iterations();
  keep_if_better(task, extract(task));
  if (reached <= kGood || reached > kClose) return;
  polish(task);
  if (best_residual_ > kSolved) ease(task);
}

/// Bodies that are wedged by impulses up to a thousand times larger than needed hide the solution
/// in the rounding of W r. From the least impulses that make the same velocities proximal points
/// come closer. What is still and what slides cannot be told for certain before.
void ExactFriction::ease(const Task& task) {
  const ContactOperator& contacts = system_.contact_operator();
  const int n = 4 * contacts.contacts();
  wedged_.head(n) = impulse_.head(n);
  for (const double still : kStillOfWedged) {
    impulse_.head(n) = wedged_.head(n);
    contacts.find_velocity(impulse_, velocity_);
    velocity_.head(n) += contacts.free_velocity().head(n);
    if (!least_.find(task.problem, contacts, velocity_, impulse_, still)) continue;
    keep_if_better(task, extract(task));
    if (best_residual_ <= kSolved) return;
    newton_.approach(contacts, impulse_, kMostIterationsOfWedged);
    task.result.newton_iterations += newton_.iterations();
    keep_if_better(task, extract(task));
    if (best_residual_ <= kSolved) return;
  }
}

/// From `impulse_` by Newton's method; keeps the best point so far.
void ExactFriction::polish(const Task& task) {
  newton_.solve(system_.contact_operator(), impulse_, newton_passes_, newton_patience_);
  task.result.newton_iterations += newton_.iterations();
  keep_if_better(task, extract(task));
}

void ExactFriction::keep_if_better(const Task& task, double residual) {
  if (!(residual < best_residual_)) return;
  const int n = 4 * system_.contacts();
  best_residual_ = residual;
  best_is_good_ = is_good(task, residual);
  best_impulse_.head(n) = impulse_.head(n);
}

bool ExactFriction::restore_best(const Task& task) {
  impulse_ = best_impulse_;
  extract(task);
  return true;
}

/// Redundant contacts share their impulses. The solution is left as it is where they then would not
/// be one to the same accuracy.
void ExactFriction::take_least_impulse(const Task& task) {
  if (is_still_) return;
  const ContactOperator& contacts = system_.contact_operator();
  const int n = 4 * contacts.contacts();
  impulse_ = best_impulse_;
  contacts.find_velocity(impulse_, velocity_);
  velocity_.head(n) += contacts.free_velocity().head(n);
  if (least_.find(task.problem, contacts, velocity_, impulse_)) {
    const double reached = extract(task);
    if (reached <= task.result.residual || is_good(task, reached)) {
      task.result.residual = reached;
    } else {
      impulse_ = best_impulse_;
      task.result.residual = extract(task);
    }
  }
}

/// Writes `impulse_` in the problem's units; returns its residual.
double ExactFriction::extract(const Task& task) {
  const ContactOperator& contacts = system_.contact_operator();
  const int nc = contacts.contacts(), n = 4 * nc;
  ContactSolution& solution = task.solution;
  for (int i = 0; i < nc; ++i) {
    const Eigen::Vector4d own = within_limit(contacts, i, impulse_.segment<4>(4 * i));
    solution.impulse.segment<4>(4 * i) =
        contacts.velocity_unit() * contacts.impulse_scale().segment<4>(4 * i).cwiseProduct(own);
  }
  solution.velocity.head(n) = task.problem.free_velocity;
  solution.velocity.noalias() += task.problem.delassus * solution.impulse;
  return complete(task);
}

/// Writes lambda = h(u); returns the residual.
double ExactFriction::complete(const Task& task) {
  for (int i = 0; i < system_.contacts(); ++i) {
    const Eigen::Vector3d slip = scaled_slip(task.problem, task.solution, i);
    task.solution.slip[i] =
        slip.squaredNorm() > 0 ? slip.dot(system_.contact_operator().boundary_point(i, slip)) : 0;
  }
  return exact_contact_residual(task.problem, task.solution);
}

}  // namespace softfinger::internal
