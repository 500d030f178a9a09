#pragma once

#include <nlohmann/json.hpp>

#include "fem/pad/pad_problem.h"

namespace softfinger::fem {

/// Whether an input is a flat pad's: it has the key "pad".
bool is_pad(const nlohmann::json& input);

/// A flat pad with the keys of README.md, the type and range of every value checked. Shapes and the
/// place of the load are left to the solver. Keys that are not known are skipped.
/// @throws InputError naming the key ("pad.outline.radius_m")
PadProblem read_pad(const nlohmann::json& input);

}  // namespace softfinger::fem
