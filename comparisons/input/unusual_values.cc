#include "comparisons/input/unusual_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/input/case.h"
#include "comparisons/input/scene.h"
#include "softfinger/input/constants.h"

namespace softfinger::input {
namespace {

/// Usual range of a value, in the unit of the files.
struct UsualRange {
  const char* name;
  double least, largest;
  const char* unit;
  double si_per_unit;
};

// Foam has some 10 kPa, tyre rubber 10 MPa; films of paint are 10 micrometres thick.
constexpr UsualRange kFriction = {"friction_coefficient", 0.01, 10, "", 1};
constexpr UsualRange kThickness = {"thickness_mm", 0.01, 100, " mm", 1e-3};
constexpr UsualRange kModulus = {"youngs_modulus_kPa", 1, 1e6, " kPa", 1e3};
constexpr UsualRange kShearStrength = {"shear_strength_kPa", 0.01, 1e5, " kPa", 1e3};
constexpr UsualRange kLoad = {"load_N", 1e-4, 1e4, " N", 1};
constexpr UsualRange kRadius = {"radii_mm", 0.05, 1e4, " mm", 1e-3};
constexpr UsualRange kSpeed = {"velocity_mm_per_s", 0, 1e5, " mm/s", 1e-3};
constexpr UsualRange kTurning = {"angular_velocity_deg_per_s", 0, 1e5, " deg/s", kPi / 180};
constexpr UsualRange kMass = {"mass_g", 1e-6, 1e6, " g", 1e-3};
constexpr UsualRange kGravity = {"gravity_m_per_s2", 0, 100, " m/s²", 1};

class UnusualValues {
 public:
  /// @param where  before the name: "body \"tip\": "
  void check(const UsualRange& usual, double value, const std::string& where = "") {
    const double typed = std::abs(value) / usual.si_per_unit;
    // A value at the end of the range may round to the other side of it.
    constexpr double kRounding = 1e-9;
    if (std::isinf(value) ||
        (typed >= usual.least * (1 - kRounding) && typed <= usual.largest * (1 + kRounding)))
      return;
    add(fmt::format("{}{} = {:.4g}: usual is {}{:g}{}", where, usual.name, typed,
                    usual.least > 0 ? fmt::format("{:g} to ", usual.least) : "at most ",
                    usual.largest, usual.unit));
  }

  void check(const ElasticLayer& layer, const std::string& where = "") {
    check(kThickness, layer.thickness_m, where);
    check(kModulus, layer.youngs_modulus_Pa, where);
  }

  void check(const ShearLaw& law) {
    if (law.has_friction_coefficient()) check(kFriction, law.friction_coefficient);
    if (law.has_shear_strength()) check(kShearStrength, law.shear_strength_Pa);
  }

  void add(const std::string& sentence) {
    constexpr std::size_t kMost = 10;
    if (sentences_.size() < kMost &&
        std::find(sentences_.begin(), sentences_.end(), sentence) == sentences_.end())
      sentences_.push_back(sentence);
  }

  const std::vector<std::string>& sentences() const { return sentences_; }

 private:
  std::vector<std::string> sentences_;
};

void check_radii(const CaseBody& body, const std::string& name, UnusualValues& found) {
  if (const auto* sphere = std::get_if<SphereBody>(&body))
    found.check(kRadius, sphere->radius_m, name + ".sphere_");
  const auto* quadric = std::get_if<QuadricBody>(&body);
  if (!quadric) return;
  for (const double radius_m : {quadric->radius_x_m, quadric->radius_y_m})
    found.check(kRadius, radius_m, name + ".");
}

/// A layer needs a core to lie on.
void check_core(const CaseBody& body, double thickness_m, UnusualValues& found) {
  double radius_m = kInfinity;
  if (const auto* quadric = std::get_if<QuadricBody>(&body))
    for (const double one : {quadric->radius_x_m, quadric->radius_y_m})
      if (one > 0) radius_m = std::min(radius_m, one);
  if (const auto* sphere = std::get_if<SphereBody>(&body)) radius_m = sphere->radius_m;
  if (thickness_m >= radius_m)
    found.add(
        fmt::format("the layer is {:.4g} mm thick on a radius of {:.4g} mm: no core is left "
                    "below it",
                    1e3 * thickness_m, 1e3 * radius_m));
}

}  // namespace

std::vector<std::string> unusual_values(const Case& contact_case) {
  UnusualValues found;
  if (contact_case.sublayers.empty()) found.check(contact_case.layer);
  for (const Sublayer& sublayer : contact_case.sublayers) found.check(sublayer.layer);
  if (contact_case.object_layer.thickness_m > 0)
    found.check(contact_case.object_layer, "[object_layer] ");
  found.check(contact_case.shear_law);
  for (const double load_N : contact_case.loads_N) found.check(kLoad, load_N);
  if (const auto* radii = std::get_if<RelativeRadii>(&contact_case.geometry)) {
    for (const double radius_m : {radii->major_m, radii->minor_m})
      found.check(kRadius, radius_m, "relative_");
    return found.sentences();
  }
  if (std::holds_alternative<PadPair>(contact_case.geometry)) return found.sentences();
  const auto& pair = std::get<BodyPair>(contact_case.geometry);
  check_radii(pair.finger, "finger", found);
  check_radii(pair.object, "object", found);
  check_core(contact_case.layer_on_object ? pair.object : pair.finger,
             contact_case.layer.thickness_m, found);
  if (contact_case.object_layer.thickness_m > 0)
    check_core(pair.object, contact_case.object_layer.thickness_m, found);
  return found.sentences();
}

std::vector<std::string> unusual_values(const Scene& scene) {
  UnusualValues found;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    const BodyDescription& description = scene.descriptions[b];
    const std::string where = "body \"" + body.name + "\": ";
    if (body.layer) found.check(*body.layer, where);
    found.check(kSpeed, description.velocity_m_per_s.norm(), where);
    found.check(kTurning, description.angular_velocity_rad_per_s.norm(), where);
    if (!description.fixed && !description.massless)
      found.check(kMass, description.mass.mass_kg, where);
  }
  for (const ContactRule& rule : scene.rules)
    // A contact without friction is a choice.
    if (rule.shear_law.friction_coefficient > 0 || rule.shear_law.has_shear_strength())
      found.check(rule.shear_law);
  found.check(kGravity, scene.gravity.values.rowwise().norm().maxCoeff());
  return found.sentences();
}

}  // namespace softfinger::input
