#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace softfinger::text {

/// The value of the key "schema" in every JSON object that a command prints or writes: which names
/// and meanings its other keys have.
constexpr int kSchema = 2;

/// The object with its schema, as commands print and write it. Bytes that are no UTF-8, of a file's
/// name for one, are replaced.
std::string printed(nlohmann::json object);

/// Parses a text that may contain anything.
/// @returns null for text that is not JSON, and for JSON nested deeper than any file of this
/// project: some functions of the library are recursive and would run out of stack.
nlohmann::json parse_json(const std::string& text);

/// The number, or null for NaN and infinity, which JSON cannot express.
nlohmann::json finite_or_null(double value);

}  // namespace softfinger::text
