#include "comparisons/atlas/case_estimate.h"

#include <cmath>
#include <optional>

namespace softfinger {
namespace {

/// Of a round finger on a plane.
std::optional<double> radius_of_round_finger_m(const Case& contact_case) {
  const auto* pair = std::get_if<BodyPair>(&contact_case.geometry);
  if (!pair) return std::nullopt;
  const auto* object = std::get_if<QuadricBody>(&pair->object);
  if (!object || std::isfinite(object->radius_x_m) || std::isfinite(object->radius_y_m))
    return std::nullopt;
  if (const auto* sphere = std::get_if<SphereBody>(&pair->finger)) return sphere->radius_m;
  const auto* finger = std::get_if<QuadricBody>(&pair->finger);
  if (!finger || finger->taper_per_m != 0 || !(finger->radius_x_m > 0) ||
      finger->radius_x_m != finger->radius_y_m)
    return std::nullopt;
  return finger->radius_x_m;
}

}  // namespace

ErrorAtlas::Estimate estimate_error(const std::string& model, const Case& contact_case,
                                    const ContactProblem& problem) {
  if (!contact_case.fem_mesh.empty()) {
    ErrorAtlas::Estimate none;
    none.outside = "the error atlas knows no layers of a user's own mesh";
    return none;
  }
  if (!contact_case.fem_curved) return error_atlas().estimate(model, problem);
  const auto radius_m = radius_of_round_finger_m(contact_case);
  if (!radius_m) {
    ErrorAtlas::Estimate none;
    none.outside = "the error atlas knows curved layers on round fingers pressed on planes only";
    return none;
  }
  return error_atlas().estimate(model, problem, problem.layer.thickness_m / *radius_m);
}

QuantityErrors with_torque_rule(const ErrorAtlas::Estimate& estimate, const Prediction& prediction,
                                TorqueRule rule) {
  QuantityErrors bound = *estimate.bound;
  if (rule == TorqueRule::exact) return bound;
  const auto torque = std::size_t(Quantity::max_torque);
  const double ratio = prediction.torque_arm_paper_m / prediction.torque_arm_exact_m;
  const double mean = estimate.mean[torque], width = bound[torque] - std::abs(mean);
  bound[torque] = std::abs((1 + mean) * ratio - 1) + ratio * width;
  return bound;
}

}  // namespace softfinger
