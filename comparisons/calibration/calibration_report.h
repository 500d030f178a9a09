#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "comparisons/calibration/case_calibration.h"

/// A calibration for people and for programs.
namespace softfinger::calibration {

/// A table of the parameters in mm and kPa, and sentences.
std::string describe(const CaseCalibration& calibration);

/// What `--json` prints, SI; described in comparisons/report/README.md.
nlohmann::json to_json(const CaseCalibration& calibration);

/// The same with what the page draws besides.
nlohmann::json page_data(const CaseCalibration& calibration, const std::string& data_text);

}  // namespace softfinger::calibration
