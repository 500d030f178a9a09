#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace softfinger::robots {

/// A file in MJCF as the MuJoCo library takes it that this program has, which is older than many
/// files: what the library does not know is left out where it changes no motion, put in other words
/// where there are some, and refused otherwise.
struct MjcfFile {
  std::string text;                ///< with what it includes; empty: the library reads the file
  std::vector<std::string> notes;  ///< what is left out, a sentence each
  /// The actuators' force on a joint together, in N or N m, by the joint's name.
  std::map<std::string, std::array<double, 2>> actuator_force_range;
  /// The part of their weight by which bodies are held, by name.
  std::map<std::string, double> gravity_compensation;
};

/// The elements and attributes that a version of MJCF has: those of "parent/element".
using MjcfSchema = std::map<std::string, std::set<std::string>>;

/// The schema of the MuJoCo library.
MjcfSchema schema_of_library();

/// @throws InputError with the line, for what changes the motion and is not known
MjcfFile read_mjcf(const std::filesystem::path& file, const MjcfSchema& schema);

}  // namespace softfinger::robots
