#include "softfinger/dynamics/exact_friction.h"

#include <algorithm>
#include <cmath>

#include "softfinger/dynamics/gauss_seidel.h"

namespace softfinger::internal {
namespace {

/// Newton's passes in a start from the last problem's impulses and in one from its basis. They are
/// few, because a problem that they do not solve is solved otherwise: from the impulses by some
/// iterations of proximal points, then by a cold start.
constexpr int kPassesFromImpulse = 1, kPassesFromBasis = 2;
constexpr int kMostIterationsOfWarm = 60;
/// Sweeps of Gauss-Seidel before each of Newton's attempts without a path.
constexpr int kSweeps[] = {20, 40, 80, 160, 320, 640};
/// From that many contacts on, with friction of the ball or of shapes, proximal points are tried
/// before any path, which would take longer. Shapes cost more per iteration.
constexpr int kManyContacts = 16, kManyShapes = 40;
/// Of fewer contacts without any, because a path is quick.
constexpr int kMostIterationsOfFew = 60;
/// Where Newton's method does not converge from a path's end, proximal points may.
constexpr int kMostIterationsAfterPath = 150;
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

}  // namespace

ExactFriction::ExactFriction(ContactSystem& system, int contact_capacity, int threads)
    : system_(system),
      search_(system.contact_operator(), contact_capacity),
      starts_(system.contact_operator(), contact_capacity, threads),
      swept_(4 * contact_capacity),
      swept_velocity_(4 * contact_capacity) {}

void ExactFriction::begin(const ContactLcp& problem) {
  best().forget();
  is_still_ = false;
  search_.begin_problem();
  starts_.begin_problem();
  system_.set_with_own_vertices(problem, kOwnVertices);
}

const Attempt& ExactFriction::attempt(int number) const {
  if (number == 0) return kFirst;
  if (number >= kImpatientAttempts && number % 2 == 0) return kPatient;
  return number % 2 == 1 ? kTolerant : kUsual;
}

void ExactFriction::start(const ContactLcp& problem, int number) {
  rounds_ = 0;
  effort_.passes = attempt(number).newton_passes;
  // An iteration costs the cube of the contacts: many of them cannot wait as long.
  const int many = std::max(kFewContacts, system_.contacts());
  effort_.patience = std::max(kUsualPatience, attempt(number).newton_patience * kFewContacts *
                                                  kFewContacts / (many * many));
  use_first_vertices(problem);
}

void ExactFriction::start_warm(const ContactLcp& problem) {
  rounds_ = 0;
  effort_ = {kPassesFromBasis, kUsualPatience};
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
  Eigen::VectorXd& impulse = search_.impulse();
  for (int i = 0; i < contacts.contacts(); ++i) {
    impulse.segment<4>(4 * i).setZero();
    const int before = continued[std::size_t(i)];
    if (before < 0) continue;
    for (int row = 0; row < (contacts.has_friction(i) ? 4 : 1); ++row) {
      const double scale = contacts.impulse_scale()[4 * i + row];
      if (scale > 0)
        impulse[4 * i + row] = last_impulse[4 * before + row] / (contacts.velocity_unit() * scale);
    }
  }
  search_.keep_if_better(task);
  is_still_ = best().is_good;
  if (is_still_ || correct(task, continued)) return true;
  effort_ = {kPassesFromImpulse, kUsualPatience};
  search_.polish(task, effort_);
  restore_best(task);
  if (best().is_good) return true;
  ImpulseSearch::Effort from_near = effort_;
  from_near.start = ProximalCourse::Start::near;
  search_.approach(task, kMostIterationsOfWarm, from_near);
  restore_best(task);
  return best().residual <= kSolved;
}

/// Bodies at rest, or in steady motion: the last least impulse follows them, or the matrix of
/// Newton's last step corrects it.
bool ExactFriction::correct(const Task& task, const std::vector<int>& continued) {
  bool is_same = true;
  for (int i = 0; i < system_.contacts(); ++i) is_same = is_same && continued[std::size_t(i)] == i;
  if (!is_same) {
    search_.forget_still();
    return false;
  }
  const ImpulseSearch::Corrected corrected = search_.correct(task);
  is_still_ = corrected.is_still;
  return corrected.is_good;
}

/// The vertex is moved along its direction onto the friction limit of this problem.
int ExactFriction::continue_vertex(const ContactPair& pair, const Eigen::Vector3d& corner) {
  const double gauge = friction_gauge(system_.contact_operator().shape(pair.contact), corner);
  return system_.find_or_add_own_vertex(pair.contact, corner / gauge);
}

bool ExactFriction::add_vertices(const Task& task) {
  const int n = 4 * system_.contacts();
  search_.impulse().head(n) = system_.current().impulse.head(n);
  // Of many contacts Newton's method alone converges from hardly any path's end.
  if (!is_many(task)) search_.polish(task, effort_);
  if (best().residual > kSolved) {
    search_.impulse().head(n) = system_.current().impulse.head(n);
    search_.approach(task, kMostIterationsAfterPath, effort_);
  }
  if (++rounds_ >= kPathsForGood && best().residual <= kSolved) best().is_good = true;
  return !best().is_good && add_violated_points();
}

bool ExactFriction::is_many(const Task& task) const {
  const bool has_shapes = task.problem.friction_rule == FrictionRule::limit_surface;
  return system_.contacts() >= (has_shapes ? kManyShapes : kManyContacts);
}

bool ExactFriction::do_before_path(const Task& task) {
  effort_ = {kFirst.newton_passes, kUsualPatience};
  if (is_many(task)) return starts_.find_from_given(task, search_, effort_);
  if (system_.contacts() == 1) return false;
  search_.start_from([](int) { return 0.; }, 0);
  search_.approach(task, kMostIterationsOfFew, effort_);
  return best().residual <= kSolved;
}

bool ExactFriction::do_more_before_path(const Task& task) {
  effort_ = {kFirst.newton_passes, kUsualPatience};
  return starts_.find_from_drawn(task, search_, effort_);
}

/// Contacts repeated to nine digits can make every path end in a ray or in rounding. Gauss-Seidel's
/// sweeps come as close as a path does, if slowly.
void ExactFriction::do_without_path(const Task& task) {
  effort_ = {ExactNewton::kMostPasses, kLongPatience};
  swept_.head(4 * system_.contacts()).setZero();
  for (const int sweeps : kSweeps) {
    sweep(system_.contact_operator(), sweeps, swept_, swept_velocity_);
    search_.impulse() = swept_;
    search_.polish(task, effort_);
    if (best().residual <= kSolved) return;
  }
  if (is_many(task)) return;
  effort_ = {kFirst.newton_passes, kUsualPatience};
  if (!starts_.find_from_given(task, search_, effort_))
    starts_.find_from_drawn(task, search_, effort_);
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

bool ExactFriction::restore_best(const Task& task) {
  search_.restore_best(task);
  return true;
}

/// Redundant contacts share their impulses.
void ExactFriction::take_least_impulse(const Task& task) {
  if (!is_still_) search_.take_least_impulse(task);
}

}  // namespace softfinger::internal
