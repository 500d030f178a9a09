#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/dynamics/friction_strategy.h"
#include "softfinger/dynamics/impulse_search.h"
#include "softfinger/dynamics/impulse_starts.h"

/// Internal: friction without facets, FrictionRule::ellipsoid and limit_surface.
namespace softfinger::internal {

/// The path finds a point close to the solution, from which Newton's method converges. Each contact
/// has vertices of its own on its friction limit. After each path the points of the limit that the
/// last solution violates are added to them.
class ExactFriction final : public FrictionStrategy {
 public:
  /// @param threads  see ContactLcpSolver
  ExactFriction(ContactSystem& system, int contact_capacity, int threads);

  /// Room for vertices of its own that a contact has: six to start with, up to two more per round.
  /// A solution has a weight for at most four; rounds that have filled the room come no closer.
  static constexpr int kOwnVertices = 40;

  void begin(const ContactLcp& problem) override;
  const Attempt& attempt(int number) const override;
  void start(const ContactLcp& problem, int attempt) override;
  void start_warm(const ContactLcp& problem) override;
  bool continue_impulse(const Task& task, const Eigen::VectorXd& last_impulse,
                        const std::vector<int>& continued) override;
  int continue_vertex(const ContactPair& pair, const Eigen::Vector3d& corner) override;
  bool add_vertices(const Task& task) override;
  void refine_path() override {}
  double read_path(const Task&) override { return search_.found().best.residual; }
  double read_zero(const Task& task) override { return search_.complete(task); }
  bool restore_best(const Task& task) override;
  bool do_before_path(const Task& task) override;
  bool has_more_before_path(const Task& task) const override { return is_many(task); }
  bool do_more_before_path(const Task& task) override;
  void do_without_path(const Task& task) override;
  void take_least_impulse(const Task& task) override;
  BestPoint& best() override { return search_.best(); }

 private:
  bool is_many(const Task& task) const;
  void use_first_vertices(const ContactLcp& problem);
  bool correct(const Task& task, const std::vector<int>& continued);
  bool add_violated_points();

  ContactSystem& system_;
  ImpulseSearch search_;
  ImpulseStarts starts_;
  bool is_still_ = false;  ///< the solution is that of the last problem
  int rounds_ = 0;         ///< paths of this attempt
  ImpulseSearch::Effort effort_{1, 1};
  Eigen::VectorXd swept_, swept_velocity_;  ///< scaled
};

}  // namespace softfinger::internal
