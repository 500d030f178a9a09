#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace softfinger::robots {

/// A URDF file that has been looked through before urdfdom reads it.
struct UrdfFile {
  std::string text;                ///< links and joints alone: urdfdom stops at faults of the rest
  std::vector<std::string> notes;  ///< what is left out, a sentence each
  std::map<std::string, int> line_of_link, line_of_joint;
  std::map<std::string, int> line_of_mesh;  ///< by the name of its file
  /// What the simulators' own elements say of links: lateral_friction in <contact> (Bullet) and
  /// mu1 in <gazebo>.
  std::map<std::string, double> friction_of_link;
};

/// @throws InputError, with the line, for what is no XML, a xacro file, numbers that are none,
/// unknown kinds of joints and shapes, limits that no position fulfils, a link with two parents,
/// and too many links
UrdfFile read_urdf(const std::filesystem::path& file);

/// Whether the root element of an XML file is <robot>.
bool is_urdf(const std::filesystem::path& file);

}  // namespace softfinger::robots
