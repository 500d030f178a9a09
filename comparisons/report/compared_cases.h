#pragma once

#include <vector>

#include "comparisons/judgement/model_errors.h"
#include "comparisons/report/html.h"

/// The errors in a report.json: the page claims nothing that its own file does not hold, so that
/// every claim can be checked against the tables below it.
namespace softfinger::report {

std::vector<judgement::CaseErrors> compared_cases(const Json& report);

/// The same of one case, of one of its loads, of one model there.
judgement::CaseErrors compared_case(const Json& report_case);
judgement::LoadErrors compared_load(const Json& load);
judgement::ModelError compared_model(const Json& model);

/// Whether the model was given anything to answer with: a law that was not measured has nothing to
/// say, and is not shown.
bool is_asked(const Json& model);

/// The error up to which a model is usable; a tenth where the file does not say.
double tolerance(const Json& report);

}  // namespace softfinger::report
