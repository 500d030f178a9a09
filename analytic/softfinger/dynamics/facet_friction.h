#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/dynamics/friction_strategy.h"

/// Internal: friction as a polytope, FrictionRule::facets.
namespace softfinger::internal {

/// The path itself arrives at the solution. It starts without vertices and gets those that the last
/// solution violates; attempts that failed are repeated with all vertices from the start.
class FacetFriction final : public FrictionStrategy {
 public:
  FacetFriction(ContactSystem& system, ContactPath& path, int contact_capacity);

  void begin(const ContactLcp& problem) override;
  const Attempt& attempt(int number) const override;
  void start(const ContactLcp& problem, int attempt) override;
  void start_warm(const ContactLcp&) override { system_.use_no_vertices(); }
  bool continue_impulse(const Task&, const Eigen::VectorXd&, const std::vector<int>&) override {
    return false;
  }
  int continue_vertex(const ContactPair& pair, const Eigen::Vector3d& corner) override;
  bool add_vertices(const Task& task) override;
  void refine_path() override { path_.refine(); }
  double read_path(const Task& task) override;
  double read_zero(const Task& task) override { return complete(task); }
  bool restore_best(const Task&) override { return false; }
  BestPoint& best() override { return best_; }

 private:
  Eigen::Vector3d friction_alone(int contact) const;
  double extract(const Task& task);
  void clean_path(const Task& task);
  double complete(const Task& task);

  ContactSystem& system_;
  ContactPath& path_;
  BestPoint best_;
  double proximal_ = 0;  ///< that the system has now
  Eigen::VectorXd least_along_;
  std::vector<int> basis_;
  ContactSolution uncleaned_;
};

}  // namespace softfinger::internal
