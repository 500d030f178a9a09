#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace softfinger::report {

/// The page of a survey of extremes: what was tried, how far, what each model answered. From the
/// object described in README.md of this folder; values may be null or missing.
/// @throws std::invalid_argument when `survey` has no array `models`
std::string render_extremes(const nlohmann::json& survey);

}  // namespace softfinger::report
