#pragma once

#include <vector>

#include "comparisons/judgement/model_errors.h"
#include "comparisons/report/html.h"

namespace softfinger::report {

/// Data that report.js draws: the report without its texts and tables, colours added, numbers
/// rounded to what a picture shows, profiles thinned to what a curve needs. Keeps the page small:
/// the tables carry the numbers, report.json the full precision.
/// @param cases  the errors of the report's cases
Json chart_data(const Json& report, const std::vector<judgement::CaseErrors>& cases);

}  // namespace softfinger::report
