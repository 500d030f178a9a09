#pragma once

#include <limits>

#include "softfinger/dynamics/contacts/contact_lcp.h"
#include "softfinger/dynamics/contacts/contact_residual.h"
#include "softfinger/dynamics/contacts/lcp_result.h"

/// Internal: what the solvers of the contact problem share.
namespace softfinger::internal {

/// The problem that is being solved, and where the answer goes.
struct Task {
  const ContactLcp& problem;
  ContactSolution& solution;
  LcpResult& result;
  /// Largest rounding of W r that excuses the residual of a good point. A warm start allows more
  /// than a cold one, because the last solution had it, too; a cold start may find points better
  /// than the rounding of one of them suggests.
  double most_rounding = kSolved;

  /// Whether the solution at hand is as good as the rounding of its impulses allows.
  bool is_good(double residual) const {
    return residual <= kGood ||
           (residual <= most_rounding && residual <= rounding_of(problem, solution, most_rounding));
  }
  /// Whether the residual of the result is one of a solution.
  bool is_solved() const {
    return result.residual <= kSolved || result.residual <= rounding_of(problem, solution);
  }
};

/// The best point of a problem so far.
struct BestPoint {
  double residual = std::numeric_limits<double>::infinity();
  bool is_good = false;     ///< nothing better is looked for
  bool is_rounded = false;  ///< rounding alone explains the residual

  /// Whether it is a solution.
  bool is_solved(bool may_be_rounded) const {
    return residual <= kSolved || (may_be_rounded && is_rounded);
  }
  /// A solution is better than any other point.
  bool is_worse_than(double reached, bool rounded) const {
    const bool solves = reached <= kSolved || rounded;
    return solves != is_solved(true) ? solves : reached < residual;
  }
  void forget() { *this = {}; }
};

}  // namespace softfinger::internal
