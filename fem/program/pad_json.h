#pragma once

#include <nlohmann/json.hpp>

#include "fem/pad/pad_problem.h"
#include "fem/pad/pad_result.h"

namespace softfinger::fem {

/// A pad's answer with the keys of README.md, SI.
nlohmann::json to_json(const PadProblem& problem, const PadResult& result);

}  // namespace softfinger::fem
