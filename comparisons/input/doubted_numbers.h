#pragma once

#include "comparisons/input/doubt.h"
#include "comparisons/input/toml_reader.h"

/// Internal to the readers of files that hold a case.
namespace softfinger::input {

/// Puts the plain number in the place of each `{ value, factor }` and `{ value, std }`.
/// @returns what was replaced, in the file's order
/// @throws InputError for a factor that is not above 1, and for a std that is not positive
Doubts settle_doubts(const TomlReader& reader, toml::table& root);

/// Whether there is any in it. The root itself is no number, whatever its keys are.
bool has_doubts(const toml::table& root);

}  // namespace softfinger::input
