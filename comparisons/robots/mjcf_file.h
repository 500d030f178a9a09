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
  /// The density, in kg/m3, of geoms from whose meshes the mass of a body follows, by name.
  std::map<std::string, double> density_of_mesh_geom;
  int visual_geoms = 0;  ///< that were left out: they touch nothing and weigh nothing
  /// Inertias that the file writes as matrices, by the body's name: xx, yy, zz, xy, xz, yz about
  /// the centre of mass, in the body's axes. The library keeps eight digits of their principal
  /// moments.
  std::map<std::string, std::array<double, 6>> full_inertia;
  /// The part of their weight by which bodies are held, by name.
  std::map<std::string, double> gravity_compensation;
};

/// The elements and attributes that a version of MJCF has: those of "parent/element".
using MjcfSchema = std::map<std::string, std::set<std::string>>;

/// The text with the masses of geoms, in kg, by name.
std::string with_masses(const std::string& text, const std::map<std::string, double>& mass_kg);

/// The schema of the MuJoCo library.
MjcfSchema schema_of_library();

/// @throws InputError with the line, for what changes the motion and is not known
MjcfFile read_mjcf(const std::filesystem::path& file, const MjcfSchema& schema);

}  // namespace softfinger::robots
