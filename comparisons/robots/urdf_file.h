#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace softfinger::robots {

/// A URDF file that has been looked through before urdfdom reads it.
struct UrdfFile {
  std::string text;                ///< links and joints alone: urdfdom stops at faults of the rest
  std::vector<std::string> notes;  ///< what is left out, a sentence each
  std::map<std::string, int> line_of_link, line_of_joint;
  /// Shapes that are capsules, by the link's name and their number among its collisions, or its
  /// visual shapes from kVisual on: an element of Bullet and others, for which the text has a
  /// cylinder, since urdfdom does not know it.
  static constexpr int kVisual = 1 << 20;
  std::set<std::pair<std::string, int>> capsules;
  std::set<std::string> ball_joints;  ///< those that Bullet calls spherical; floating in the text
  std::map<std::string, int> line_of_mesh;  ///< by the name of its file
  /// Friction coefficients from the simulators' own elements: lateral_friction in `<contact>`
  /// (Bullet) and mu1 in `<gazebo>`.
  std::map<std::string, double> friction_of_link;
};

/// @throws InputError, with the line, for what is no XML, a xacro file, numbers that are none,
/// unknown kinds of joints and shapes, limits that no position fulfils, a link with two parents,
/// and too many links
UrdfFile read_urdf(const std::filesystem::path& file);

/// Whether the root element of an XML file is `<robot>`.
bool is_urdf(const std::filesystem::path& file);

}  // namespace softfinger::robots
