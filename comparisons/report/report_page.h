#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace softfinger::report {

/// The page of a comparison: one HTML file without outside references, from the object described in
/// README.md of this folder. All text, verdicts and numbers are HTML; JavaScript adds the charts
/// and the choice of a load. Values may be null or missing anywhere: they become dashes or words.
///
/// @throws std::invalid_argument when `report` is not an object with an array `cases`
std::string render_report(const nlohmann::json& report);

}  // namespace softfinger::report
