#include "comparisons/judgement/atlas/case_estimate.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace softfinger::judgement {
namespace {

/// The radius of the finger, if the case is a round finger on a plane.
std::optional<double> radius_of_round_finger_m(const input::Case& contact_case) {
  const auto* pair = std::get_if<input::BodyPair>(&contact_case.geometry);
  if (!pair) return std::nullopt;
  const auto* object = std::get_if<input::QuadricBody>(&pair->object);
  if (!object || std::isfinite(object->radius_x_m) || std::isfinite(object->radius_y_m))
    return std::nullopt;
  if (const auto* sphere = std::get_if<input::SphereBody>(&pair->finger)) return sphere->radius_m;
  const auto* finger = std::get_if<input::QuadricBody>(&pair->finger);
  if (!finger || finger->taper_per_m != 0 || !(finger->radius_x_m > 0) ||
      finger->radius_x_m != finger->radius_y_m)
    return std::nullopt;
  return finger->radius_x_m;
}

/// The radius of the sphere, if the case is a sphere that is pressed into a flat finger.
std::optional<double> radius_of_sphere_on_flat_finger_m(const input::Case& contact_case) {
  const auto* pair = std::get_if<input::BodyPair>(&contact_case.geometry);
  if (!pair) return std::nullopt;
  const auto* finger = std::get_if<input::QuadricBody>(&pair->finger);
  const auto* sphere = std::get_if<input::SphereBody>(&pair->object);
  if (!finger || !sphere || std::isfinite(finger->radius_x_m) || std::isfinite(finger->radius_y_m))
    return std::nullopt;
  return sphere->radius_m;
}

ErrorAtlas::Estimate outside(const char* reason) {
  ErrorAtlas::Estimate none;
  none.outside = reason;
  return none;
}

ErrorAtlas::Estimate estimate_at_finite_strain(const std::string& model,
                                               const input::Case& contact_case,
                                               const ContactProblem& problem) {
  if (contact_case.fem_finite->material != "neo_hookean" ||
      contact_case.fem_finite->volumetric != "quadratic")
    return outside(
        "at finite strain the error atlas knows neo-Hookean layers of quadratic volume energy "
        "only");
  const auto radius_m = contact_case.fem_curved ? radius_of_round_finger_m(contact_case)
                                                : radius_of_sphere_on_flat_finger_m(contact_case);
  if (!radius_m)
    return outside(
        "at finite strain the error atlas knows spheres on flat layers and round fingers on "
        "planes only");
  return finite_strain_atlas().estimate(
      model, problem, contact_case.fem_curved ? AtlasKind::finite_curved : AtlasKind::finite_sphere,
      problem.layer.thickness_m / *radius_m);
}

}  // namespace

ErrorAtlas::Estimate estimate_error(const std::string& model, const input::Case& contact_case,
                                    const ContactProblem& problem) {
  if (!contact_case.sublayers.empty())
    return outside("the error atlas knows homogeneous layers only");
  if (contact_case.fem_finite) return estimate_at_finite_strain(model, contact_case, problem);
  if (!contact_case.fem_mesh.empty())
    return outside("the error atlas knows no layers of a user's own mesh");
  if (!contact_case.fem_curved) return error_atlas().estimate(model, problem);
  const auto radius_m = radius_of_round_finger_m(contact_case);
  if (!radius_m)
    return outside("the error atlas knows curved layers on round fingers pressed on planes only");
  return error_atlas().estimate(model, problem, AtlasKind::curved,
                                problem.layer.thickness_m / *radius_m);
}

QuantityErrors with_torque_rule(const ErrorAtlas::Estimate& estimate, const Prediction& prediction,
                                prediction::TorqueRule rule) {
  QuantityErrors bound = *estimate.bound;
  if (rule == prediction::TorqueRule::exact) return bound;
  const auto torque = std::size_t(Quantity::max_torque);
  const double ratio = prediction.torque_arm_paper_m / prediction.torque_arm_exact_m;
  const double mean = estimate.mean[torque], width = bound[torque] - std::abs(mean);
  bound[torque] = std::abs((1 + mean) * ratio - 1) + ratio * width;
  return bound;
}

QuantityErrors with_shear_law(QuantityErrors bound, const prediction::ModelAnswer& answer) {
  if (answer.shear_law.kind == ShearLaw::Kind::coulomb) return bound;
  const auto of = [&](Quantity quantity) { return bound[std::size_t(quantity)]; };
  const double arm = std::max({of(Quantity::a), of(Quantity::b), of(Quantity::max_torque)});
  bound[std::size_t(Quantity::max_torque)] = of(Quantity::area) + arm;
  return bound;
}

}  // namespace softfinger::judgement
