#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <string>
#include <vector>

/// Parts of a scene's text, for the readers of robots' files.
namespace softfinger::robots {

/// A soft surface for a body of the robot.
struct FingerLayer {
  std::string body;
  double thickness_mm = 0, youngs_modulus_kPa = 0, poisson_ratio = 0;
};

struct ImportedScene {
  std::string text;                ///< TOML, as the scene reader takes it
  std::vector<std::string> notes;  ///< what is not as in the file, a sentence each
};

/// The limits that a scene's reader has; what is added to a name must fit, too.
constexpr double kMillimetre = 1e-3, kDegree = 3.14159265358979323846 / 180;
constexpr std::size_t kMostBodies = 1000, kLongestName = 90, kMostRules = 20000;

std::string list(const Eigen::Vector3d& v);
std::string in_quotes(const std::string& text);
/// Angles about the fixed axes x, y, z, in this order.
std::string rotation_deg(const Eigen::Matrix3d& turn);
/// position_mm and rotation_deg of an inline table, where they are not zero.
std::string placed(const Eigen::Isometry3d& at);
/// position_mm and rotation_deg as lines of a table.
std::string placed_lines(const Eigen::Isometry3d& at);
/// mass_g, center_of_mass_mm and inertia_kg_mm2 as lines.
/// @param inertial  of the centre of mass, in whose axes the inertia is
std::string mass_lines(double mass_kg, const Eigen::Isometry3d& inertial,
                       const Eigen::Matrix3d& inertia_kg_m2);
/// Whether a name can be one of a scene.
bool is_name(const std::string& name);
/// [[layer]] tables, named layer_1, ...
/// @throws InputError for a body that is none of `bodies`, or twice
std::string layer_tables(const std::vector<FingerLayer>& layers,
                         const std::vector<std::string>& bodies);
/// The line `layer = ...` of a body's table, or nothing.
std::string layer_line(const std::vector<FingerLayer>& layers, const std::string& body);

}  // namespace softfinger::robots
