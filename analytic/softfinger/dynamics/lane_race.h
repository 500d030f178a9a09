#pragma once

#include <memory>
#include <vector>

#include "softfinger/dynamics/lane_search.h"

/// Internal: drawn starts of many contacts by all of a processor.
namespace softfinger::internal {

/// Groups of lanes that search from drawn starts, step by step, until one has a solution. Each
/// thread has its own groups. What counts is the step in which a group finds its solution, so that
/// the solution does not depend on the number of threads, nor on which of them is faster.
class LaneRace {
 public:
  /// As many groups as computers have cores at least: with more, one thread alone would wait longer
  /// for the first one that ends.
  static constexpr int kGroups = 2;

  LaneRace(const ContactOperator& contacts, int contact_capacity, int threads);

  /// Whether the problem of `search` is one for lanes, and the processor.
  static bool fits(const Task& task, ImpulseSearch& search);

  struct Limits {
    int first_start;
    int most_iterations;
    int unrounded;  ///< iterations before the rounding of W r is good enough
  };
  /// The best point becomes that of `search`. Returns whether it is a solution.
  bool find(const Task& task, ImpulseSearch& search, ImpulseSearch::Effort effort, Limits limits);

 private:
  const ContactOperator& contacts_;
  int contact_capacity_, threads_;
  std::vector<std::unique_ptr<LaneSearch>> groups_;
};

}  // namespace softfinger::internal
