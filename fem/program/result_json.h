#pragma once

#include <nlohmann/json.hpp>

#include "fem/problem/problem.h"
#include "fem/problem/result.h"

namespace softfinger::fem {

/// A result with the keys of README.md.
nlohmann::json to_json(const Problem& problem, const Result& result);

}  // namespace softfinger::fem
