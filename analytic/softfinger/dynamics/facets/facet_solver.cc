#include "softfinger/dynamics/facets/facet_solver.h"

#include <algorithm>
#include <cmath>

#include "softfinger/dynamics/contacts/contact_residual.h"
#include "softfinger/dynamics/facets/contact_ray.h"

namespace softfinger::internal {

struct FacetSolver::Attempt {
  double tolerance;               ///< see PathOptions
  double smallest_pivot;          ///< see PathOptions
  int refresh_after;              ///< see PathOptions
  bool has_all_vertices = false;  ///< from the start
  double proximal = 0;            ///< see ContactOperator::set
};

namespace {

/// The largest violation by the last solution, over the natural size, for which no vertex is added.
constexpr double kToleratedViolation = 1e-13;
/// Number of attempts after which any solution will do, good or not.
constexpr int kAttemptsForGood = 4;
/// Number of the first attempt with a changed diagonal of W, after six rounds of attempts.
constexpr int kFirstProximal = 24;

/// A path has at most so many basic z: P, lambda and four vertices per contact, z0, and two more as
/// a margin.
int largest_basis(int contacts) { return 6 * contacts + 3; }

/// The limits of a path that are the same for all attempts.
PathOptions usual_path(int contacts) {
  PathOptions options;
  options.tolerance = 1e-12;
  // Paths to a solution take far fewer pivots. One that takes so many repeats itself.
  options.most_pivots = 100 * contacts + 200;
  options.refresh_after = 8;
  return options;
}

}  // namespace

// Each attempt after the quick one has a reason of its own. The numbers were found by trial on
// random scenes (tests/dynamics/random_scene.h: masses over six decades, contacts repeated nearby),
// of which no single choice solves all.
const FacetSolver::Attempt& FacetSolver::attempt(int number) {
  // Cheap: values are only advanced from pivot to pivot and computed again after every eighth.
  static constexpr Attempt kQuick{1e-12, 1e-9, 8};
  // - The careful attempt has no rounding that accumulates between pivots.
  // - A path that goes on with new vertices may end in a ray that means nothing; one that has all
  //   of them from the start does not. Ties are more frequent: a larger tolerance.
  // - Nearly redundant contacts of stiff joints have true pivots below the usual limit. Elsewhere
  //   such pivots are round-off.
  static constexpr Attempt kRound[] = {
      {1e-12, 1e-9, 1}, {1e-11, 1e-9, 1, true}, {1e-12, 1e-11, 1}, {1e-11, 1e-11, 1, true}};
  // If contacts are nearly redundant, no basis may be accurate enough: with a little more on W's
  // diagonal they are not redundant. What that little adds to the residual, which is always that of
  // the problem itself, is far below its bound unless impulses are very large.
  static constexpr Attempt kProximalRound[] = {{1e-12, 1e-9, 1, false, 1e-14},
                                               {1e-11, 1e-9, 1, true, 1e-13},
                                               {1e-12, 1e-11, 1, false, 1e-12},
                                               {1e-11, 1e-11, 1, true, 1e-11}};
  if (number == 0) return kQuick;
  return number < kFirstProximal ? kRound[number % 4] : kProximalRound[number % 4];
}

FacetSolver::FacetSolver(int contact_capacity, int vertex_capacity)
    : system_(contact_capacity, vertex_capacity),
      path_(contact_capacity * (vertex_capacity + 2), largest_basis(contact_capacity)),
      least_along_(contact_capacity) {
  last_basis_.reserve(std::size_t(largest_basis(contact_capacity)));
  basis_.reserve(std::size_t(largest_basis(contact_capacity)));
  uncleaned_.resize(contact_capacity);
}

void FacetSolver::begin(const Task& task, const Eigen::Matrix3Xd& vertices) {
  given_vertices_ = &vertices;
  best_.forget();
  best_attempt_ = 0;
  proximal_ = 0;
  last_basis_.clear();
  system_.set(task.problem, vertices, 0);
}

LcpResult FacetSolver::solve(const ContactLcp& problem, const Eigen::Matrix3Xd& vertices,
                             ContactSolution& solution, int most_attempts) {
  LcpResult result;
  const Task task{problem, solution, result};
  begin(task, vertices);
  if (system_.contact_operator().separates()) {
    solution.velocity = problem.free_velocity;
    result.status = LcpStatus::solved;
    result.solved_by = SolvedBy::separating;
    result.residual = complete(task);
    return result;
  }
  make_attempts(task, most_attempts);
  result.residual = best_.residual;
  if (std::isfinite(result.residual) && result.proof != RayProof::infeasible &&
      best_attempt_ != result.attempts - 1) {
    follow(task, best_attempt_);
    result.residual = read_path(task, best_attempt_);
  }
  if (task.is_solved()) {
    result.status = LcpStatus::solved;
    result.solved_by = SolvedBy::facets;
    result.proof = RayProof::none;
  } else if (result.proof != RayProof::none) {
    result.status = LcpStatus::infeasible_or_ray;
    result.residual = std::numeric_limits<double>::infinity();
  }
  return result;
}

bool FacetSolver::proves_infeasible(const Task& task) {
  begin(task, no_vertices_);
  system_.choose_covering(0);
  system_.use_no_vertices();
  return is_infeasible_without_friction(task);
}

/// Makes attempts from z = 0 until one is good, or a proof says that none can be.
void FacetSolver::make_attempts(const Task& task, int most_attempts) {
  for (int number = 0; number < most_attempts; ++number) {
    const PathEnd end = follow(task, number);
    if (end == PathEnd::ray) {
      if (is_infeasible(task)) return;
      continue;
    }
    read_path(task, number);
    if (best_.is_good) return;
    if (number + 1 >= kAttemptsForGood && best_.residual <= kSolved) return;
  }
}

PathEnd FacetSolver::follow(const Task& task, int number) {
  PathOptions options = usual_path(system_.contacts());
  options.tolerance = attempt(number).tolerance;
  options.smallest_pivot = attempt(number).smallest_pivot;
  options.refresh_after = attempt(number).refresh_after;
  ++task.result.attempts;
  system_.choose_covering(number);
  start(task, number);
  return go_on_adding_vertices(task, path_.follow(system_, options), options);
}

/// Gives the system the diagonal and the vertices that this attempt starts with.
void FacetSolver::start(const Task& task, int number) {
  if (attempt(number).proximal != proximal_) {
    proximal_ = attempt(number).proximal;
    system_.set(task.problem, *given_vertices_, proximal_);
  }
  system_.use_no_vertices();
  if (!attempt(number).has_all_vertices) return;
  for (int i = 0; i < system_.contacts(); ++i) {
    if (!system_.contact_operator().has_friction(i)) continue;
    for (int j = 0; j < system_.vertices().count(); ++j) system_.use_vertex(i, j);
  }
}

/// Adds vertices that the last solution violates and goes on from its basis, until none is
/// violated. A path that ends elsewhere starts again from z = 0 with all vertices found so far, led
/// towards the last solution.
PathEnd FacetSolver::go_on_adding_vertices(const Task& task, PathEnd end,
                                           const PathOptions& options) {
  task.result.pivots += path_.pivots();
  while (end == PathEnd::solved) {
    keep_basis();
    if (!add_violated_vertices()) {
      path_.refine();
      break;
    }
    end = path_.follow(system_, options, true);
    task.result.pivots += path_.pivots();
    if (end == PathEnd::solved) continue;
    end = lead_to_last_basis(options);
    task.result.pivots += path_.pivots();
  }
  return end;
}

/// Adds vertices to each loaded contact whose lambda the vertices in use underestimate: the vertex
/// most opposite to the slip, and the corners of the facet on which its friction would lie if the
/// other contacts kept their impulses. A contact without load needs none, because its lambda
/// appears in no other row.
bool FacetSolver::add_violated_vertices() {
  const ContactOperator& contacts = system_.contact_operator();
  const FrictionVertices& vertices = system_.vertices();
  const Motion& state = system_.current();
  bool found = false;
  for (int i = 0; i < contacts.contacts(); ++i) {
    if (!contacts.has_friction(i) || !(state.impulse[4 * i] > 0)) continue;
    const Eigen::Vector3d slip = state.velocity.segment<3>(4 * i + 1);
    const double known = state.slip[i] + kToleratedViolation * contacts.natural_size(i);
    if (vertices.radius() * slip.norm() <= known) continue;
    const int worst = system_.vertex_beyond(-slip, known);
    if (worst < 0 || vertices.is_in_use(i, worst)) continue;
    system_.use_vertex(i, worst);
    found = true;
    FrictionPolytope::Facet facet;
    if (!system_.find_facet(friction_alone(i), facet)) continue;
    for (const int vertex : facet) system_.use_vertex(i, vertex);
  }
  return found;
}

/// The friction of a contact on the unit ball if the other contacts, and its own load, kept their
/// impulses: a few fixed-point steps from the last solution. Only a direction is wanted, so that
/// four are enough.
Eigen::Vector3d FacetSolver::friction_alone(int i) const {
  constexpr int kSteps = 4;
  const ContactOperator& contacts = system_.contact_operator();
  const Motion& state = system_.current();
  const auto own = contacts.delassus().block<3, 3>(4 * i + 1, 4 * i + 1);
  const Eigen::Vector3d metric = contacts.friction_metric(i);
  Eigen::Vector3d friction = state.impulse.segment<3>(4 * i + 1);
  Eigen::Vector3d slip = state.velocity.segment<3>(4 * i + 1);
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::Vector3d target = metric.cwiseProduct(friction) - slip;
    const Eigen::Vector3d excess =
        friction_excess(contacts.shape(i), target, state.impulse[4 * i], metric).excess;
    const Eigen::Vector3d next = (target - excess).cwiseQuotient(metric);
    slip += own * (next - friction);
    friction = next;
  }
  return friction;
}

void FacetSolver::keep_basis() {
  last_basis_.clear();
  for (int p = 0; p < path_.basis_size(); ++p) last_basis_.push_back(path_.basis_column(p));
}

PathEnd FacetSolver::lead_to_last_basis(const PathOptions& options) {
  system_.cover_towards(last_basis_.data(), int(last_basis_.size()));
  const PathEnd end = path_.follow(system_, options);
  system_.choose_covering(system_.covering());
  return end;
}

/// Returns whether the ray in which a path ended, or that of the problem without friction, proves
/// that there is no solution. A problem infeasible without friction is infeasible with any
/// friction.
bool FacetSolver::is_infeasible(const Task& task) {
  const RayProof proof = check_ray(system_, task.problem, task.solution.ray);
  if (proof == RayProof::none) return false;
  task.result.proof = proof;
  if (proof != RayProof::infeasible && !is_infeasible_without_friction(task)) return false;
  task.result.proof = RayProof::infeasible;
  return true;
}

bool FacetSolver::is_infeasible_without_friction(const Task& task) {
  system_.drop_friction();
  const PathEnd end = path_.follow(system_, usual_path(system_.contacts()));
  task.result.pivots += path_.pivots();
  const bool infeasible =
      end == PathEnd::ray &&
      check_ray(system_, task.problem, task.solution.ray) == RayProof::infeasible;
  system_.restore_friction();
  return infeasible;
}

/// Writes the point that the path has led to as the solution; returns its residual. Harris'
/// tolerance can leave something negative: a few more pivots without it then follow.
double FacetSolver::read_path(const Task& task, int number) {
  const double reached = extract(task);
  double best = reached;
  if (reached > kGood) {
    const int nc = system_.contacts();
    const ContactSolution& found = task.solution;
    uncleaned_.impulse.head(4 * nc) = found.impulse;
    uncleaned_.velocity.head(4 * nc) = found.velocity;
    uncleaned_.slip.head(nc) = found.slip;
    uncleaned_.weights = found.weights;
    clean_path(task);
    best = extract(task);
    if (!(best < reached)) {
      best = reached;
      task.solution.impulse = uncleaned_.impulse.head(4 * nc);
      task.solution.velocity = uncleaned_.velocity.head(4 * nc);
      task.solution.slip = uncleaned_.slip.head(nc);
      task.solution.weights = uncleaned_.weights;
    }
  }
  if (best < best_.residual) {
    best_.residual = best;
    best_.is_good = task.is_good(best);
    best_attempt_ = number;
  }
  return best;
}

void FacetSolver::clean_path(const Task& task) {
  basis_.clear();
  for (int p = 0; p < path_.basis_size(); ++p)
    if (path_.basis_column(p) != system_.pairs()) basis_.push_back(path_.basis_column(p));
  PathOptions options = usual_path(system_.contacts());
  options.tolerance = 1e-15;
  options.refresh_after = 1;
  options.most_pivots = system_.contacts() + 10;
  if (path_.follow_from(system_, options, basis_.data(), int(basis_.size())) == PathEnd::solved)
    path_.refine();
  task.result.pivots += path_.pivots();
}

/// Writes the basic z in the problem's units; returns the residual.
double FacetSolver::extract(const Task& task) {
  const ContactLcp& problem = task.problem;
  ContactSolution& solution = task.solution;
  const ContactOperator& contacts = system_.contact_operator();
  const int nc = contacts.contacts();
  solution.impulse.setZero(4 * nc);
  solution.slip.setZero(nc);
  solution.weights.clear();
  for (int p = 0; p < path_.basis_size(); ++p) {
    const double value = path_.basis_value(p);
    if (path_.basis_column(p) == system_.pairs() || !(value > 0)) continue;
    const ContactPair& pair = system_.pair(path_.basis_column(p));
    const int i = pair.contact;
    if (pair.kind == ContactPair::Kind::normal) {
      solution.impulse[4 * i] = contacts.impulse_scale()[4 * i] * contacts.velocity_unit() * value;
    } else if (pair.kind == ContactPair::Kind::slip) {
      solution.slip[i] = value * contacts.velocity_unit() / contacts.velocity_scale()[4 * i + 1];
    } else {
      const double weight = contacts.impulse_scale()[4 * i + 1] * contacts.velocity_unit() * value;
      const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[i]);
      solution.impulse.segment<3>(4 * i + 1) +=
          weight * arms.cwiseProduct(given_vertices_->col(pair.vertex));
      solution.weights.push_back({i, pair.vertex, weight});
    }
  }
  solution.velocity = problem.free_velocity;
  solution.velocity.noalias() += problem.delassus * solution.impulse;
  return complete(task);
}

/// Writes lambda of contacts without load or friction, which the path does not know because no
/// other row depends on it. Returns the residual.
double FacetSolver::complete(const Task& task) {
  ContactSolution& solution = task.solution;
  for (int i = 0; i < system_.contacts(); ++i) {
    least_along_[i] = system_.vertices().slip_against(scaled_slip(task.problem, solution, i));
    if (system_.contact_operator().has_friction(i) && solution.impulse[4 * i] > 0) continue;
    solution.slip[i] = std::max(0., -least_along_[i]);
  }
  // This is what `contact_residual` computes, several times faster where there are many vertices.
  return residual_of(task.problem, *given_vertices_, solution, least_along_);
}

}  // namespace softfinger::internal
