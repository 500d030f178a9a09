#pragma once

#include "comparisons/report/html.h"

namespace softfinger::report {

/// What report.js draws: the report without its texts and tables, colours added, numbers rounded to
/// what a picture shows, profiles thinned to what a curve needs. Keeps the page small: the tables
/// carry the numbers, report.json the full precision.
Json chart_data(const Json& report);

}  // namespace softfinger::report
