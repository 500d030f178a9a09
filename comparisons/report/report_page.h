#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "comparisons/judgement/model_errors.h"

namespace softfinger::report {

/// The page of a comparison: one HTML file without outside references, from the object described in
/// README.md of this folder. All text, verdicts and numbers are HTML; JavaScript adds the charts
/// and the choice of a load. Values may be null or missing anywhere: they become dashes or words.
///
/// @param cases  the errors of the same cases, in the report's order: what is usable is judged by
///               them, not by the text of the report
/// @throws std::invalid_argument when `report` is not an object with an array `cases`, or not with
///         one for each of `cases`
std::string render_report(const nlohmann::json& report,
                          const std::vector<judgement::CaseErrors>& cases);

}  // namespace softfinger::report
