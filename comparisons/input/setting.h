#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace softfinger::input {

/// A value from the command line that takes the place of one in a file.
struct Setting {
  std::string key;    ///< "layer.thickness_mm", "geometry.relative_radii_mm[0]", "layer[1].name"
  std::string value;  ///< TOML; a bare word stands for a text: finite for "finite"
  std::string where;  ///< for messages: "--set layer.thickness_mm=3"
};
using Settings = std::vector<Setting>;

/// Reads KEY=VALUE.
/// @throws InputError(where "--set ...") unless it has both, on one line
Setting parse_setting(const std::string& typed);

/// Refuses two values for one key, of which one would be lost without a word.
/// @throws InputError that names both
void require_each_key_once(const Settings& settings);

/// The text of a case, scene or sweep file; of standard input where the file is "-".
/// @throws InputError also when it is larger than any such file
std::string read_typed_text(const std::filesystem::path& file);

/// Name of an input in messages: the file, or "standard input" for "-".
std::filesystem::path name_of_typed(const std::filesystem::path& file);

/// Whether a text can be an id, which becomes the name of a folder of results: 1 to 64 letters,
/// digits, "_", "-" and ".", not starting with ".".
bool is_id(const std::string& text);

/// An id made of a file's name: the beginning of its stem, with "_" for each letter that no id may
/// have. "" for a file without a name.
std::string id_of(const std::filesystem::path& file);

}  // namespace softfinger::input
