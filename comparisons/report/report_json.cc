#include "comparisons/report/report_json.h"

namespace softfinger::report {

double tolerance(const Json& report) { return number(report, "tolerance").value_or(0.10); }

bool is_asked(const Json& model) {
  const Json& checks = child(model, "validity");
  return !checks.is_array() || checks.empty() || text(checks[0], "check") != "power_law_known";
}

}  // namespace softfinger::report
