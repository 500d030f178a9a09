#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/dynamics/contacts/contact_lcp.h"
#include "softfinger/dynamics/contacts/lcp_result.h"
#include "softfinger/dynamics/contacts/solve_task.h"
#include "softfinger/dynamics/facets/contact_system.h"

/// Internal: friction as a polytope, solved by Lemke's path.
namespace softfinger::internal {

/// Solves the contact problem with linearised friction, the method of the publication. A path
/// starts without vertices and gets those that its last solution violates; attempts that failed are
/// repeated with other covering vectors and tolerances, with all vertices from the start, and at
/// last with a little added to the diagonal of W.
///
/// Sized once: nothing below allocates after construction.
class FacetSolver {
 public:
  static constexpr int kMostAttempts = 32;

  FacetSolver(int contact_capacity, int vertex_capacity);

  /// Solves `problem` with friction in the convex hull of `vertices`, whatever its friction rule.
  /// The weights of the solution refer to these vertices.
  LcpResult solve(const ContactLcp& problem, const Eigen::Matrix3Xd& vertices,
                  ContactSolution& solution, int most_attempts = kMostAttempts);

  /// Whether the path without friction ends in a ray, ContactSolution::ray, which proves that the
  /// problem has no solution with any friction. Its pivots are added to the result.
  bool proves_infeasible(const Task& task);

 private:
  /// Settings in which one attempt at a problem differs from the others. Each attempt also has its
  /// own covering vector, chosen by its number.
  struct Attempt;

  static const Attempt& attempt(int number);

  void begin(const Task& task, const Eigen::Matrix3Xd& vertices);
  void make_attempts(const Task& task, int most_attempts);
  PathEnd follow(const Task& task, int number);
  void start(const Task& task, int number);
  PathEnd go_on_adding_vertices(const Task& task, PathEnd end, const PathOptions& options);
  bool add_violated_vertices();
  Eigen::Vector3d friction_alone(int contact) const;
  void keep_basis();
  PathEnd lead_to_last_basis(const PathOptions& options);
  bool is_infeasible(const Task& task);
  bool is_infeasible_without_friction(const Task& task);
  double read_path(const Task& task, int number);
  double extract(const Task& task);
  void clean_path(const Task& task);
  double complete(const Task& task);

  ContactSystem system_;
  ContactPath path_;
  const Eigen::Matrix3Xd* given_vertices_ = nullptr;
  BestPoint best_;
  int best_attempt_ = 0;
  double proximal_ = 0;  ///< that the system has now
  Eigen::VectorXd least_along_;
  std::vector<int> last_basis_;  ///< of the last path that was solved
  std::vector<int> basis_;
  ContactSolution uncleaned_;
  Eigen::Matrix3Xd no_vertices_;
};

}  // namespace softfinger::internal
