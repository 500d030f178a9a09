#pragma once

#include <string>
#include <vector>

#include "comparisons/judgement/model_errors.h"
#include "comparisons/report/html.h"

/// The errors in a sample report.json, as `compare` would have handed them to the page.
namespace softfinger::tests {

std::vector<judgement::CaseErrors> compared_cases(const report::Json& report);
judgement::CaseErrors compared_case(const report::Json& report_case);
judgement::LoadErrors compared_load(const report::Json& load);
judgement::ModelError compared_model(const report::Json& model);

/// The page of a sample.
std::string page_of(const report::Json& report);

}  // namespace softfinger::tests
