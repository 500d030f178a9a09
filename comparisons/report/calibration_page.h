#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace softfinger::report {

/// Page of `softfinger calibrate`: what was found and what stays unknown, data and fit with its
/// band, residuals, confidence, models compared. Made from the object described in README.md of
/// this folder; values may be null or missing.
/// @throws std::invalid_argument when `calibration` has no object `parameters`
std::string render_calibration(const nlohmann::json& calibration);

}  // namespace softfinger::report
