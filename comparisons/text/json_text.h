#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace softfinger::text {

/// Parses a text that nobody vouches for.
/// @returns null for what is no JSON, or nested deeper than any of ours: some functions of the
/// library call themselves once per level and would run out of stack.
nlohmann::json parse_json(const std::string& text);

/// JSON knows neither NaN nor infinity: they become null.
nlohmann::json finite_or_null(double value);

}  // namespace softfinger::text
