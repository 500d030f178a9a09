#include "softfinger/dynamics/contact_lcp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "softfinger/dynamics/contact_ray.h"
#include "softfinger/dynamics/contact_residual.h"
#include "softfinger/dynamics/contact_system.h"
#include "softfinger/dynamics/exact_friction.h"
#include "softfinger/dynamics/facet_friction.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using internal::all_finite;
using internal::ContactPair;
using internal::FrictionStrategy;
using internal::is_exact;
using internal::kMostAttempts;
using internal::kSolved;
using internal::largest_basis;
using internal::PathEnd;
using internal::Task;

/// After that many attempts any solution will do, good or not.
constexpr int kAttemptsForGood = 4;

[[noreturn]] void refuse(const char* field, const std::string& value, const std::string& allowed) {
  throw InputError("contact problem", field, value, allowed);
}

void check_sizes(const ContactLcp& problem, int contact_capacity, int vertex_capacity) {
  const int nc = problem.contacts(), u = int(problem.vertices.cols());
  if (nc > contact_capacity)
    refuse("contacts", std::to_string(nc), "at most " + std::to_string(contact_capacity));
  if (!is_exact(problem) && u > vertex_capacity)
    refuse("vertices", std::to_string(u), "at most " + std::to_string(vertex_capacity));
  if (problem.delassus.rows() != 4 * nc || problem.delassus.cols() != 4 * nc ||
      problem.free_velocity.size() != 4 * nc || problem.eccentricity_m.size() != nc)
    refuse("size", "", "4 rows per contact and one friction coefficient, one e_n");
  if (problem.root.cols() > 0 && problem.root.rows() != 4 * nc)
    refuse("G", std::to_string(problem.root.rows()) + " rows", "4 rows per contact");
  if (problem.friction_rule == FrictionRule::limit_surface && int(problem.shapes.size()) != nc)
    refuse("shapes", std::to_string(problem.shapes.size()), "one per contact");
}

void check_values(const ContactLcp& problem) {
  if (!all_finite(problem.delassus)) refuse("W", "", "finite numbers");
  for (Eigen::Index column = 0; column < problem.root.cols(); ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator one(problem.root, column); one; ++one)
      if (!std::isfinite(one.value())) refuse("G", "", "finite numbers");
  if (!all_finite(problem.free_velocity)) refuse("free velocity", "", "finite numbers");
  if (!is_exact(problem) && !all_finite(problem.vertices)) refuse("V", "", "finite numbers");
  for (int i = 0; i < problem.contacts(); ++i) {
    const double mu = problem.friction_coefficient[i], arm_m = problem.eccentricity_m[i];
    const double inverse_mass = problem.delassus(4 * i, 4 * i);
    if (!(mu >= 0 && std::isfinite(mu)))
      refuse("mu", std::to_string(mu), "finite numbers >= 0, one per contact");
    if (!(arm_m >= 0 && std::isfinite(arm_m)))
      refuse("en", std::to_string(arm_m), "finite numbers >= 0, one per contact");
    if (!(inverse_mass > 0))
      refuse("W_nn", std::to_string(inverse_mass) + " of contact " + std::to_string(i),
             "> 0: one of the two bodies has to be movable");
  }
}

bool is_solution(const Task& task) {
  return task.result.residual <= kSolved ||
         task.result.residual <= internal::rounding_of(task.problem, task.solution);
}

bool separates_without_impulses(const internal::ContactOperator& contacts) {
  for (int i = 0; i < contacts.contacts(); ++i)
    if (contacts.free_velocity()[4 * i] < 0) return false;
  return true;
}

/// The solution of the last problem, from which a warm start of the next one begins.
class LastProblem {
 public:
  explicit LastProblem(int contact_capacity)
      : impulse_(4 * contact_capacity), continues_as_(std::size_t(contact_capacity)) {
    basis_.reserve(std::size_t(largest_basis(contact_capacity)));
  }

  struct BasicPair {
    ContactPair pair;
    Eigen::Vector3d corner;  ///< the vertex itself
  };
  const std::vector<BasicPair>& basis() const { return basis_; }
  const Eigen::VectorXd& impulse() const { return impulse_; }

  void check_continued(const ContactLcp& problem, const std::vector<int>& continued) const {
    if (int(continued.size()) != problem.contacts())
      refuse("continued", std::to_string(continued.size()), "one per contact");
    for (const int contact : continued)
      if (contact < -1 || contact >= contacts_)
        refuse("continued", std::to_string(contact), "a contact of the last problem, or -1");
  }
  bool can_continue(const ContactLcp& problem) const {
    return contacts_ >= 0 && rule_ == problem.friction_rule &&
           (is_exact(problem) || vertices_ == problem.vertices.cols());
  }

  void forget_basis() { basis_.clear(); }
  void keep_basis(const internal::ContactSystem& system, const internal::ContactPath& path) {
    basis_.clear();
    for (int p = 0; p < path.basis_size(); ++p) {
      const ContactPair& pair = system.pair(path.basis_column(p));
      Eigen::Vector3d corner = Eigen::Vector3d::Zero();
      if (pair.kind == ContactPair::Kind::vertex)
        corner = system.vertices().vertex(pair.contact, pair.vertex);
      basis_.push_back({pair, corner});
    }
  }
  void keep(const ContactLcp& problem, const ContactSolution& solution) {
    contacts_ = problem.contacts();
    vertices_ = problem.vertices.cols();
    rule_ = problem.friction_rule;
    impulse_.head(4 * contacts_) = solution.impulse;
  }

  /// Changes the contacts' numbers in the basis to those of the new problem. Pairs of contacts that
  /// no longer exist are dropped.
  void renumber(const std::vector<int>& continued) {
    std::fill(continues_as_.begin(), continues_as_.end(), -1);
    for (std::size_t i = 0; i < continued.size(); ++i)
      if (continued[i] >= 0) continues_as_[std::size_t(continued[i])] = int(i);
    std::size_t kept = 0;
    for (BasicPair& basic : basis_) {
      const int contact = continues_as_[std::size_t(basic.pair.contact)];
      if (contact < 0) continue;
      basic.pair.contact = contact;
      basis_[kept++] = basic;
    }
    basis_.resize(kept);
  }

 private:
  int contacts_ = -1;  ///< -1: there was none
  Eigen::Index vertices_ = 0;
  FrictionRule rule_ = FrictionRule::facets;
  Eigen::VectorXd impulse_;  ///< in the problem's units
  std::vector<BasicPair> basis_;
  std::vector<int> continues_as_;
};

}  // namespace

void ContactSolution::resize(int contacts) {
  impulse.setZero(4 * contacts);
  velocity.setZero(4 * contacts);
  slip.setZero(contacts);
  ray.setZero(4 * contacts);
  weights.clear();
  weights.reserve(std::size_t(4 * contacts));
}

struct ContactLcpSolver::Workspace {
  Workspace(int contacts, int vertices, int threads)
      : contact_capacity(contacts),
        vertex_capacity(vertices),
        system(contacts, vertices),
        path(contacts * (vertices + 2), largest_basis(contacts)),
        facets(system, path, contacts),
        exact(system, contacts, threads),
        last(contacts) {
    basis.reserve(std::size_t(largest_basis(contacts)));
  }

  void solve_without_impulses(const Task& task, FrictionStrategy& friction);
  bool continue_last(const Task& task, FrictionStrategy& friction,
                     const std::vector<int>& continued);
  bool use_last_basis(const Task& task, FrictionStrategy& friction);
  void start_cold(const Task& task, FrictionStrategy& friction);
  bool end_without_path(const Task& task, FrictionStrategy& friction);
  void follow_paths(const Task& task, FrictionStrategy& friction);
  PathEnd follow(const Task& task, FrictionStrategy& friction, int attempt);
  PathEnd go_on_adding_vertices(const Task& task, FrictionStrategy& friction, PathEnd end,
                                const internal::PathOptions& options, bool is_warm = false);
  PathEnd lead_to_last_basis(const internal::PathOptions& options);
  bool is_infeasible(const Task& task);
  bool is_infeasible_without_friction(const Task& task);

  int contact_capacity, vertex_capacity;
  internal::ContactSystem system;
  internal::ContactPath path;
  internal::FacetFriction facets;
  internal::ExactFriction exact;
  LastProblem last;
  std::vector<int> basis;
};

void ContactLcpSolver::Workspace::solve_without_impulses(const Task& task,
                                                         FrictionStrategy& friction) {
  task.result.status = LcpStatus::solved;
  task.solution.velocity = task.problem.free_velocity;
  task.result.residual = friction.read_zero(task);
  last.forget_basis();
}

/// From the last solution: its impulses, then its basis. False where neither is good.
bool ContactLcpSolver::Workspace::continue_last(const Task& task, FrictionStrategy& friction,
                                                const std::vector<int>& continued) {
  last.renumber(continued);
  friction.best().forget();
  bool solved = friction.continue_impulse(task, last.impulse(), continued);
  task.result.residual = friction.best().residual;
  if (!solved) {
    system.choose_covering(0);
    if (!use_last_basis(task, friction)) return false;
    // More pivots than contacts have bounds are no gain over a cold start.
    internal::PathOptions options = internal::usual_path(system.contacts());
    options.most_pivots = 4 * system.contacts() + 10;
    const PathEnd end = path.follow_from(system, options, basis.data(), int(basis.size()));
    if (go_on_adding_vertices(task, friction, end, options, true) != PathEnd::solved) return false;
    task.result.residual = friction.read_path(task);
    solved = task.is_good(task.result.residual);
  }
  if (!solved) return false;
  if (is_solution(task)) task.result.status = LcpStatus::solved;
  task.result.warm = true;
  return true;
}

/// Writes the last problem's basis into `basis`, with its vertices in use; false where these find
/// no room.
bool ContactLcpSolver::Workspace::use_last_basis(const Task& task, FrictionStrategy& friction) {
  friction.start_warm(task.problem);
  basis.clear();
  for (const LastProblem::BasicPair& basic : last.basis()) {
    ContactPair pair = basic.pair;
    if (pair.kind != ContactPair::Kind::normal &&
        !system.contact_operator().has_friction(pair.contact))
      continue;
    if (pair.kind == ContactPair::Kind::vertex) {
      pair.vertex = friction.continue_vertex(pair, basic.corner);
      if (pair.vertex < 0) return false;
    }
    basis.push_back(system.index(pair));
  }
  return true;
}

/// Whether the solution is found before any path with friction, or it is proved that there is none.
bool ContactLcpSolver::Workspace::end_without_path(const Task& task, FrictionStrategy& friction) {
  if (friction.do_before_path(task)) return true;
  if (!friction.has_more_before_path(task)) return false;
  system.choose_covering(0);
  friction.start(task.problem, 0);
  if (is_infeasible_without_friction(task)) {
    task.result.proof = RayProof::infeasible;
    return true;
  }
  return friction.do_more_before_path(task);
}

/// Attempts from z = 0 until one is good, and the status that follows from the best.
void ContactLcpSolver::Workspace::start_cold(const Task& task, FrictionStrategy& friction) {
  LcpResult& result = task.result;
  friction.best().forget();
  last.forget_basis();
  if (!end_without_path(task, friction)) follow_paths(task, friction);
  result.residual = friction.best().residual;
  if (std::isfinite(result.residual) && !friction.restore_best(task) &&
      result.proof != RayProof::infeasible && friction.best_attempt() != result.attempts - 1) {
    follow(task, friction, friction.best_attempt());
    result.residual = friction.read_path(task);
  }
  if (is_solution(task)) {
    result.status = LcpStatus::solved;
    result.proof = RayProof::none;
  } else if (result.proof != RayProof::none) {
    result.status = LcpStatus::infeasible_or_ray;
    result.residual = std::numeric_limits<double>::infinity();
  }
}

void ContactLcpSolver::Workspace::follow_paths(const Task& task, FrictionStrategy& friction) {
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    const PathEnd end = follow(task, friction, attempt);
    if (friction.best().is_good) return;
    if (end == PathEnd::ray) {
      if (is_infeasible(task)) return;
      continue;
    }
    friction.read_path(task);
    if (friction.best().is_good) return;
    if (attempt + 1 >= kAttemptsForGood && friction.best().residual <= kSolved) return;
  }
  friction.do_without_path(task);
}

PathEnd ContactLcpSolver::Workspace::follow(const Task& task, FrictionStrategy& friction,
                                            int number) {
  const internal::Attempt& attempt = friction.attempt(number);
  internal::PathOptions options = internal::usual_path(system.contacts());
  options.tolerance = attempt.tolerance;
  options.smallest_pivot = attempt.smallest_pivot;
  options.refresh_after = attempt.refresh_after;
  ++task.result.attempts;
  system.choose_covering(number);
  friction.start(task.problem, number);
  return go_on_adding_vertices(task, friction, path.follow(system, options), options);
}

/// Adds vertices that the last solution violates and goes on from its basis, until none is
/// violated. Where a path ends elsewhere, it starts again from z = 0 with all vertices found so
/// far, led towards the last solution, unless it was a warm one.
PathEnd ContactLcpSolver::Workspace::go_on_adding_vertices(const Task& task,
                                                           FrictionStrategy& friction, PathEnd end,
                                                           const internal::PathOptions& options,
                                                           bool is_warm) {
  task.result.pivots += path.pivots();
  while (end == PathEnd::solved) {
    last.keep_basis(system, path);
    if (!friction.add_vertices(task)) {
      friction.refine_path();
      break;
    }
    end = path.follow(system, options, true);
    task.result.pivots += path.pivots();
    if (end == PathEnd::solved) continue;
    if (is_warm) break;
    end = lead_to_last_basis(options);
    task.result.pivots += path.pivots();
  }
  return end;
}

PathEnd ContactLcpSolver::Workspace::lead_to_last_basis(const internal::PathOptions& options) {
  basis.clear();
  for (const LastProblem::BasicPair& basic : last.basis())
    basis.push_back(system.index(basic.pair));
  system.cover_towards(basis.data(), int(basis.size()));
  const PathEnd end = path.follow(system, options);
  system.choose_covering(system.covering());
  return end;
}

/// After a ray: whether it, or that of the same problem without friction, proves that there is no
/// solution. Without friction infeasible means infeasible with any friction.
bool ContactLcpSolver::Workspace::is_infeasible(const Task& task) {
  const RayProof proof = internal::check_ray(system, task.problem, task.solution.ray);
  if (proof == RayProof::none) return false;
  task.result.proof = proof;
  if (proof != RayProof::infeasible && !is_infeasible_without_friction(task)) return false;
  task.result.proof = RayProof::infeasible;
  return true;
}

bool ContactLcpSolver::Workspace::is_infeasible_without_friction(const Task& task) {
  system.drop_friction();
  const PathEnd end = path.follow(system, internal::usual_path(system.contacts()));
  task.result.pivots += path.pivots();
  const bool infeasible =
      end == PathEnd::ray &&
      internal::check_ray(system, task.problem, task.solution.ray) == RayProof::infeasible;
  system.restore_friction();
  return infeasible;
}

ContactLcpSolver::ContactLcpSolver(int largest_contacts, int largest_vertices, int threads)
    : workspace_(std::make_unique<Workspace>(
          std::max(largest_contacts, 0),
          std::max(largest_vertices, internal::ExactFriction::kOwnVertices), threads)) {}
ContactLcpSolver::~ContactLcpSolver() = default;
ContactLcpSolver::ContactLcpSolver(ContactLcpSolver&&) noexcept = default;
ContactLcpSolver& ContactLcpSolver::operator=(ContactLcpSolver&&) noexcept = default;

LcpResult ContactLcpSolver::solve(const ContactLcp& problem, ContactSolution& solution,
                                  const std::vector<int>* continued) {
  Workspace& work = *workspace_;
  check_sizes(problem, work.contact_capacity, work.vertex_capacity);
  check_values(problem);
  if (continued) work.last.check_continued(problem, *continued);
  solution.resize(problem.contacts());
  LcpResult result;
  const Task cold{problem, solution, result};
  const Task warm{problem, solution, result, internal::kMostRoundingKept};
  FrictionStrategy& friction = is_exact(problem) ? static_cast<FrictionStrategy&>(work.exact)
                                                 : static_cast<FrictionStrategy&>(work.facets);
  friction.begin(problem);
  if (separates_without_impulses(work.system.contact_operator())) {
    work.solve_without_impulses(cold, friction);
    work.last.keep(problem, solution);
    return result;
  }
  const bool is_continued = continued && work.last.can_continue(problem) &&
                            work.continue_last(warm, friction, *continued);
  if (!is_continued) work.start_cold(cold, friction);
  if (result.status == LcpStatus::solved) friction.take_least_impulse(is_continued ? warm : cold);
  work.last.keep(problem, solution);
  return result;
}

}  // namespace softfinger
