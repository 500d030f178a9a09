#include "comparisons/judgement/atlas/error_causes.h"

#include <algorithm>

#include "softfinger/friction/ellipsoid_deviation.h"
#include "softfinger/friction/linearised_friction.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/pressure/equivalent_exponent.h"

namespace softfinger::judgement {
namespace {

/// Finite elements of a round contact find a and b in either order.
double exact_arm(const TorqueContact& contact, double exponent) {
  return torque_arm_exact_m(std::max(contact.a, contact.b), std::min(contact.a, contact.b),
                            exponent);
}

}  // namespace

double exponent_of(const TorqueContact& contact) {
  Prediction prediction;
  prediction.has_answer = true;
  prediction.a_m = std::max(contact.a, contact.b);
  prediction.b_m = std::min(contact.a, contact.b);
  prediction.torque_arm_exact_m = contact.arm;
  return equivalent_exponent(prediction);
}

TorqueCauses torque_causes(const TorqueContact& model, const TorqueContact& truth) {
  const double exponent = exponent_of(model);
  const double with_true_ellipse = exact_arm(truth, exponent);
  TorqueCauses causes;
  causes.ellipse = exact_arm(model, exponent) / with_true_ellipse - 1;
  causes.pressure = with_true_ellipse / truth.arm - 1;
  const double a = std::max(model.a, model.b), b = std::min(model.a, model.b);
  causes.circle_rule = torque_arm_paper_m(a, b, 0.5) / torque_arm_exact_m(a, b, 0.5) - 1;
  return causes;
}

TorqueContact contact_of(const AtlasRun& run) {
  return {run.answer[std::size_t(Quantity::a)], run.answer[std::size_t(Quantity::b)],
          run.answer[std::size_t(Quantity::max_torque)]};
}

TorqueContact contact_of(const AtlasRun& run, const QuantityErrors& model_errors) {
  TorqueContact contact = contact_of(run);
  contact.a *= 1 + model_errors[std::size_t(Quantity::a)];
  contact.b *= 1 + model_errors[std::size_t(Quantity::b)];
  contact.arm *= 1 + model_errors[std::size_t(Quantity::max_torque)];
  return contact;
}

double ellipsoid_error(double a_over_b, double exponent) {
  const LimitSurface surface(a_over_b, 1, exponent, 1);
  const EllipsoidDeviation deviation = worst_ellipsoid_deviation(surface, surface.ellipsoid());
  return std::max(-deviation.lowest, deviation.highest);
}

double facet_error(int count) { return 1 - LinearisedFriction(count).inner_bound(); }

}  // namespace softfinger::judgement
