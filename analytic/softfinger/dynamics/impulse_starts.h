#pragma once

#include <memory>
#include <vector>

#include "softfinger/dynamics/impulse_search.h"
#include "softfinger/dynamics/lane_race.h"

/// Internal: where to look for the impulses of many contacts.
namespace softfinger::internal {

/// Proximal points from one start after another until one ends in a solution. Threads take the
/// starts as they come, but these count in their order, as if each had waited for the one before:
/// the solution does not depend on the number of threads, nor on which of them is faster.
class ImpulseStarts {
 public:
  /// @param threads  see ContactLcpSolver
  ImpulseStarts(const ContactOperator& contacts, int contact_capacity, int threads);

  void begin_problem();
  /// From the few starts that solve most problems: the first by `search` alone, the others beside
  /// it too. Returns whether one led to a solution, which is then the best point of `search`.
  bool find_from_given(const Task& task, ImpulseSearch& search, ImpulseSearch::Effort effort);
  /// The same from starts that are drawn, after those.
  bool find_from_drawn(const Task& task, ImpulseSearch& search, ImpulseSearch::Effort effort);

 private:
  /// A search of another thread.
  struct Beside {
    std::unique_ptr<ImpulseSearch> search;
    ContactSolution solution;
    LcpResult result;
  };
  class Queue;

  bool find(const Task& task, ImpulseSearch& search, ImpulseSearch::Effort effort, int first,
            int end);

  const ContactOperator& contacts_;
  int contact_capacity_, threads_;
  int iterations_ = 0;  ///< of this problem so far
  std::vector<Beside> beside_;
  LaneRace lanes_;
};

}  // namespace softfinger::internal
