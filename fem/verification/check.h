#pragma once

#include <cmath>
#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

/// Verification of the finite elements against closed forms, solutions of integral equations and
/// invariants. No tolerance was tuned until a check passed: each is an expression with a reason.
namespace softfinger::fem::verification {

enum class Relation { equal, at_least, at_most };

struct Check {
  std::string group{}, name{}, quantity{};
  double expected = 0, measured = 0;
  /// Relative error that the solver states for this number; absent where it states none.
  std::optional<double> stated_error{};
  /// Relative to the expected value; absolute where that is zero.
  double tolerance = 0;
  std::string reason{};        ///< of the tolerance
  double reference_error = 0;  ///< relative: of the expected value and its model, in the tolerance
  Relation relation = Relation::equal;

  double error() const { return expected != 0 ? measured / expected - 1 : measured; }

  bool passes() const {
    if (relation == Relation::at_least) return measured >= expected;
    if (relation == Relation::at_most) return measured <= expected;
    return std::abs(error()) <= tolerance;  // false for a NaN
  }

  bool inside_stated() const { return std::abs(error()) <= *stated_error + reference_error; }
};

using Checks = std::vector<Check>;

/// A number that comes with its own error. Stated at 95 %: one in twenty may lie outside, but twice
/// as far off the statement itself is wrong.
Check stated_check(std::string group, std::string name, std::string quantity, double expected,
                   double measured, double stated_error, double reference_error,
                   const std::string& reference);

/// The two checks of the stated errors themselves: how often they hold, and whether they are not
/// merely large.
Checks check_stated_errors(const Checks& checks);

/// Markdown: a row per check, then the summary lines.
void print_table(const Checks& checks, std::ostream& out);

/// @returns the number of checks that fail
int count_failures(const Checks& checks);

}  // namespace softfinger::fem::verification
