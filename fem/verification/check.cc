#include "fem/verification/check.h"

#include <algorithm>
#include <cstdio>
#include <ostream>
#include <utility>

namespace softfinger::fem::verification {
namespace {

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

const char* relation_text(Relation relation) {
  return relation == Relation::at_least ? "≥ " : relation == Relation::at_most ? "≤ " : "";
}

}  // namespace

Check stated_check(std::string group, std::string name, std::string quantity, double expected,
                   double measured, double stated_error, double reference_error,
                   const std::string& reference) {
  return {std::move(group),
          std::move(name),
          std::move(quantity),
          expected,
          measured,
          stated_error,
          2 * stated_error + reference_error,
          "2 x stated + " + reference,
          reference_error};
}

Checks check_stated_errors(const Checks& checks) {
  int inside = 0;
  std::vector<double> ratios;
  for (const Check& check : checks) {
    if (!check.stated_error) continue;
    inside += check.inside_stated();
    // The ratio has no meaning if the reference's own error is as large as the difference.
    if (std::abs(check.error()) > check.reference_error)
      ratios.push_back(*check.stated_error / std::abs(check.error()));
  }
  const auto count = static_cast<double>(std::count_if(
      checks.begin(), checks.end(), [](const Check& check) { return check.stated_error; }));
  if (ratios.empty()) return {};
  std::nth_element(ratios.begin(), ratios.begin() + static_cast<long>(ratios.size() / 2),
                   ratios.end());
  const std::string of = text("of %.0f errors", count);
  Check share{"stated errors", of, "share inside the stated one", 0.95, inside / count};
  share.relation = Relation::at_least;
  share.reason = "what 95 % confidence means";
  Check median{"stated errors", of, "median of stated / true", 10, ratios[ratios.size() / 2]};
  median.relation = Relation::at_most;
  median.reason = "an error that excuses everything is worth nothing";
  return {share, median};
}

void print_table(const Checks& checks, std::ostream& out) {
  out << "| group | check | quantity | expected | measured | error, % | stated, % | tolerance, % | "
         "why this tolerance | |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Check& check : checks) {
    const bool bound = check.relation != Relation::equal;
    out << "| " << check.group << " | " << check.name << " | " << check.quantity << " | "
        << relation_text(check.relation) << text("%.6g", check.expected) << " | "
        << text("%.6g", check.measured) << " | "
        << (bound ? ""
                  : text(std::abs(check.error()) < 1e-6 ? "%.1e" : "%+.4f", 100 * check.error()))
        << " | " << (check.stated_error ? text("%.4f", 100 * *check.stated_error) : "") << " | "
        << (bound ? "" : text(check.tolerance < 1e-6 ? "%.1e" : "%.4f", 100 * check.tolerance))
        << " | " << check.reason << " | " << (check.passes() ? "ok" : "**FAILS**") << " |\n";
  }
}

int count_failures(const Checks& checks) {
  return static_cast<int>(std::count_if(checks.begin(), checks.end(),
                                        [](const Check& check) { return !check.passes(); }));
}

}  // namespace softfinger::fem::verification
