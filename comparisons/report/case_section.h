#pragma once

#include "comparisons/judgement/model_errors.h"
#include "comparisons/report/html.h"

namespace softfinger::report {

/// One case: question, verdict, places for the charts, every number as a table.
/// @param errors  of the same case
Html case_section(const Json& report, const Json& report_case, const judgement::CaseErrors& errors);

/// Fragment identifier of a case's section.
std::string case_anchor(const Json& report_case);

/// Text that the filter of cases searches.
std::string searched_text(const Json& report_case);

/// A coloured label that says its meaning in words too.
Html verdict_badge(const Json& report_case);

/// Name of a model with the line that stands for it in the charts.
Html model_key(const Json& report, const std::string& model);

}  // namespace softfinger::report
