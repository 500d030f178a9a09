#pragma once

#include <Eigen/Core>
#include <memory>

#include "softfinger/dynamics/exact/impulse_search.h"
#include "softfinger/dynamics/facets/facet_solver.h"

/// Internal: friction without facets, FrictionRule::ellipsoid and limit_surface.
namespace softfinger::internal {

/// The point from which a solver begins.
struct ContactStart {
  /// 4 nc, in the problem's units: the impulses of a problem much like this one. Null: there are
  /// none, and the start is cold.
  const Eigen::VectorXd* impulse = nullptr;
  /// Contact by contact, the problem is the next step of the one that was solved last.
  bool is_next_step = false;
};

/// Solves the contact problem with exact friction by proximal points and Newton's method. The rungs
/// of its ladder, each tried only after those above it have failed (SolvedBy):
/// - still: the given impulses, as they are or corrected by what is kept of the last step;
/// - warm: Newton's method and a few proximal points from the given impulses;
/// - first start: proximal points from no impulses;
/// - drawn starts: the same from other impulses, unless the problem is proved infeasible;
/// - facets: the same from the solution with linearised friction.
///
/// Sized once: `solve` then allocates nothing until a first start fails. That takes memory for
/// FacetSolver, which is kept.
class ExactSolver {
 public:
  explicit ExactSolver(int contact_capacity);

  LcpResult solve(const ContactLcp& problem, const ContactStart& start, ContactSolution& solution);

 private:
  bool continue_from(const Task& task, const ContactStart& start);
  void start_cold(const Task& task);
  bool find_from_nothing(const Task& task);
  bool find_from_drawn(const Task& task);
  bool find_from_facets(const Task& task);
  bool proves_infeasible(const Task& task);
  FacetSolver& facets();
  void go_to(const ContactLcp& problem, const Eigen::VectorXd& impulse);
  BestPoint& best() { return search_.best(); }

  int contact_capacity_;
  ContactOperator contacts_;
  ImpulseSearch search_;
  bool has_least_impulse_ = false;  ///< the solution is the least one without further search
  std::unique_ptr<FacetSolver> facets_;
  Eigen::Matrix3Xd vertices_;  ///< of the last start
  ContactSolution of_facets_;
};

}  // namespace softfinger::internal
