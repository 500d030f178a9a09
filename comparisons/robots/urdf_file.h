#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace softfinger::robots {

/// URDF file prepared for MuJoCo, and what MuJoCo does not read of it.
struct UrdfFile {
  std::vector<std::string> notes;  ///< what is left out, a sentence each
  std::string with_all_links;      ///< the file, so that MuJoCo keeps links on fixed joints apart
};

/// @throws InputError for limits of a joint that no position fulfils, or that are no numbers
UrdfFile read_urdf(const std::filesystem::path& file);

/// Whether the root element of an XML file is <robot>.
bool is_urdf(const std::filesystem::path& file);

}  // namespace softfinger::robots
