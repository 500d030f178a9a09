#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "comparisons/report/html.h"

namespace softfinger::report {

/// The page of `softfinger experiments`: the theory against published measurements. From the object
/// described in README.md of this folder, with `provenance`; values may be null or missing.
/// @throws std::invalid_argument when there is no array `experiments`
std::string render_experiments(const nlohmann::json& experiments);

/// Short form for the report of a comparison: its `experiments`. Empty without them.
Html experiments_section(const Json& report);

}  // namespace softfinger::report
