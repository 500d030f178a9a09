#pragma once

#include "comparisons/input/pad.h"
#include "comparisons/input/toml_reader.h"

/// Internal to the readers of files that hold a case.
namespace softfinger::input {

/// Whether [geometry] has a flat pad or a flat face.
bool is_flat_geometry(const toml::table& geometry);

/// @param contact  the table [contact], for `pressing` and `load_at_mm`
/// @throws InputError
PadPair read_pad_pair(const TomlReader& reader, const toml::table& geometry,
                      const toml::table& contact);

}  // namespace softfinger::input
