#include "comparisons/robots/imported_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::robots {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

std::string list(const Vector3d& v) {
  const Vector3d positive = v.array() + 0.;  // -0 becomes 0
  return fmt::format("[{}, {}, {}]", positive.x(), positive.y(), positive.z());
}

std::string in_quotes(const std::string& text) {
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"' || letter == '\\') quoted += '\\';
    quoted += letter;
  }
  return quoted + "\"";
}

std::string rotation_deg(const Matrix3d& turn) {
  const double across = std::hypot(turn(2, 1), turn(2, 2));
  const bool is_locked = across < 1e-12;
  const Vector3d angles(
      is_locked ? 0 : std::atan2(turn(2, 1), turn(2, 2)), std::atan2(-turn(2, 0), across),
      is_locked ? std::atan2(-turn(0, 1), turn(1, 1)) : std::atan2(turn(1, 0), turn(0, 0)));
  return list(angles / kDegree);
}

std::string placed(const Isometry3d& at) {
  std::string text;
  if (!at.translation().isZero(0)) text += "position_mm = " + list(at.translation() / kMillimetre);
  if (at.linear().isIdentity(0)) return text;
  return text + (text.empty() ? "" : ", ") + "rotation_deg = " + rotation_deg(at.linear());
}

std::string placed_lines(const Isometry3d& at) {
  return fmt::format("position_mm = {}\nrotation_deg = {}\n", list(at.translation() / kMillimetre),
                     rotation_deg(at.linear()));
}

std::string mass_lines(double mass_kg, const Isometry3d& inertial, const Matrix3d& inertia_kg_m2) {
  const Matrix3d inertia = 1e6 * inertial.linear() * inertia_kg_m2 * inertial.linear().transpose();
  return fmt::format(
      "mass_g = {}\ncenter_of_mass_mm = {}\ninertia_kg_mm2 = [{}, {}, {}, {}, {}, {}]\n",
      1e3 * mass_kg, list(inertial.translation() / kMillimetre), inertia(0, 0), inertia(1, 1),
      inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2));
}

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= kLongestName &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char letter) { return letter >= 0x20 && letter != 0x7f; });
}

std::string layer_tables(const std::vector<FingerLayer>& layers,
                         const std::vector<std::string>& bodies) {
  std::string text;
  std::set<std::string> named;
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const FingerLayer& layer = layers[i];
    if (std::find(bodies.begin(), bodies.end(), layer.body) == bodies.end())
      throw InputError("--finger-layer", "body", layer.body,
                       "a body of the robot: " + fmt::to_string(fmt::join(bodies, ", ")));
    if (!named.insert(layer.body).second)
      throw InputError("--finger-layer", "body", layer.body, "each body once");
    text += fmt::format(
        "[[layer]]\nname = \"layer_{}\"\nthickness_mm = {}\nyoungs_modulus_kPa = {}\n"
        "poisson_ratio = {}\n\n",
        i + 1, layer.thickness_mm, layer.youngs_modulus_kPa, layer.poisson_ratio);
  }
  return text;
}

std::string layer_line(const std::vector<FingerLayer>& layers, const std::string& body) {
  for (std::size_t i = 0; i < layers.size(); ++i)
    if (layers[i].body == body) return fmt::format("layer = \"layer_{}\"\n", i + 1);
  return "";
}

}  // namespace softfinger::robots
