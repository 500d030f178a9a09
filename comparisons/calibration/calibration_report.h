#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "comparisons/calibration/case_calibration.h"

/// A calibration for people and for programs.
namespace softfinger::calibration {

/// A table of the parameters in mm and kPa, and sentences.
std::string describe(const CaseCalibration& calibration);

/// Object that `--json` prints, in SI units; described in comparisons/report/README.md.
nlohmann::json to_json(const CaseCalibration& calibration);

/// The object of `to_json`, with the curves, ellipses and sentences of the page besides.
nlohmann::json page_data(const CaseCalibration& calibration, const std::string& data_text);

}  // namespace softfinger::calibration
