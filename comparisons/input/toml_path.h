#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "comparisons/input/toml_reader.h"

/// Internal to the readers of files: values by their path, "geometry.finger.radii_mm[0]".
namespace softfinger::input {

/// Splits a path into names of tables and indices of arrays. "radii_mm.0" means the same index as
/// "radii_mm[0]"; a name with dots is put in quotes: sweep."layer.thickness_mm". Empty for a text
/// that is no path.
std::vector<std::string> steps_of(const std::string& path);

/// An index of an array; for a text that is not one, an index larger than any array.
std::size_t place_of(const std::string& step);

/// The entry of a table or an array; null when there is none.
toml::node* find_entry(toml::node& node, const std::string& step);

/// Puts a value in the place of another, or adds it to its table; missing tables are made.
/// Messages about the value name the setting, not the file.
/// @throws InputError for a path that leads nowhere and a value that is no TOML
void apply_setting(const Setting& setting, toml::table& root);

}  // namespace softfinger::input
