#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace softfinger::report {

/// The page of `softfinger sweep`: what was swept, what follows from it, and one picture whose
/// axes, quantity and models the reader chooses. From the object described in README.md of this
/// folder; values may be null or missing.
/// @throws std::invalid_argument when `sweep` has no array `rows`
std::string render_sweep(const nlohmann::json& sweep);

}  // namespace softfinger::report
