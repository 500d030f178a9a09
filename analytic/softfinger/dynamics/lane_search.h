#pragma once

#include <Eigen/Core>

#include "softfinger/dynamics/impulse_search.h"
#include "softfinger/dynamics/proximal_lanes.h"

/// Internal: a search from several starts at once.
namespace softfinger::internal {

/// Searches with friction of the unit ball, one per lane. A lane that ends at wedged bodies goes on
/// from their least impulses; any other takes the next start.
class LaneSearch {
 public:
  LaneSearch(const ContactOperator& contacts, int contact_capacity);

  /// @param factor  of the problem; not kept beyond it
  /// @param first   of `go_to_start`, and how many lie between those that it takes
  void begin_problem(const VelocityFactor& factor, int first, int between);

  /// One of Newton's steps in each lane. True where a solution is known.
  bool advance(const ContactLcp& problem, ImpulseSearch::Effort effort, bool may_be_rounded);

  const ImpulseSearch::Found& found() const { return search_.found(); }

 private:
  struct Start {
    bool is_known = false;
    int eased = 0;  ///< how often
    Eigen::VectorXd wedged;
  };

  bool end(int lane, const Task& task, ImpulseSearch::Effort effort);
  void start_next(int lane);

  ImpulseSearch search_;
  ProximalLanes lanes_;
  ContactSolution solution_;
  LcpResult result_;
  Start starts_[ProximalLanes::kLanes];
  int next_ = 0, between_ = 1;
};

}  // namespace softfinger::internal
