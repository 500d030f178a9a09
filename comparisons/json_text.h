#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace softfinger {

/// Parses a text that nobody vouches for.
/// @returns null for what is no JSON, or nested deeper than any of ours: some functions of the
/// library call themselves once per level and would run out of stack.
nlohmann::json parse_json(const std::string& text);

}  // namespace softfinger
