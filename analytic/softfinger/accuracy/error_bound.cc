#include "softfinger/accuracy/error_bound.h"

#include <algorithm>
#include <cmath>

#include "softfinger/layer/fingertip_layer_core.h"

namespace softfinger {
namespace {

ErrorBound outside(const char* reason) {
  ErrorBound nothing;
  nothing.outside = reason;
  return nothing;
}

BoundedErrors numbers_of(const Prediction& prediction) {
  return {prediction.a_m,
          prediction.b_m,
          prediction.indentation_m,
          prediction.area_m2(),
          prediction.peak_pressure_Pa,
          prediction.torque_arm_exact_m};
}

BoundedErrors numbers_of(const ContactNumbers& contact) {
  return {contact.a_m,
          contact.b_m,
          contact.indentation_m,
          kPi * contact.a_m * contact.b_m,
          contact.peak_pressure_Pa,
          contact.torque_arm_exact_m};
}

/// Index of the largest torque, the only quantity that the finite elements resolve to 0.1 %.
constexpr std::size_t kTorque = 5;

const char* reason_outside(const ContactProblem& problem, const ContactNumbers& flat) {
  const double h = problem.layer.thickness_m;
  const SurfaceCurvature& finger = problem.finger_curvature;
  const double mean_per_m = 0.5 * (finger.xx_per_m + finger.yy_per_m);
  const double spread_per_m =
      std::hypot(0.5 * (finger.xx_per_m - finger.yy_per_m), finger.xy_per_m);
  const double bend = h * (mean_per_m + spread_per_m);
  if (mean_per_m < spread_per_m - 1e-9 * std::abs(mean_per_m + spread_per_m))
    return "not known for a hollow finger: the runs are of convex ones";
  const RelativeRadii& radii = problem.radii;
  if (radii.major_m > kFingertipRange.largest_radii_ratio * radii.minor_m)
    return "not known for R'/R'' above 20";
  if (bend > kFingertipRange.largest_bend)
    return "not known for layers thicker than 0.6 of the finger's smallest radius";
  if (h >
      kFingertipRange.largest_flat_thickness * std::sqrt(radii.major_m) * std::sqrt(radii.minor_m))
    return "not known for layers thicker than five times the relative radius";
  if (std::sqrt(flat.a_m) * std::sqrt(flat.b_m) > kFingertipRange.largest_size * h)
    return "not known for contacts larger than 20 h";
  if (flat.a_m > kFingertipRange.largest_slope * radii.major_m ||
      flat.b_m > kFingertipRange.largest_slope * radii.minor_m)
    return "not known for slopes above 0.6 at the edge of the contact";
  if (flat.indentation_m > kFingertipRange.largest_strain * h)
    return "not known for layers compressed by more than 40 %";
  return nullptr;
}

ErrorCause cause_of(FingertipEffect effect) {
  switch (effect) {
    case kStrain:
    case kStrainSquared:
    case kLongStrain:
      return ErrorCause::strain;
    case kSlope:
    case kSlopeOfLong:
    case kObjectSlope:
    case kObjectSlopeOfLong:
    case kSphere:
    case kStrainSlope:
    case kLongwiseSlope:
    case kLongSlope:
    case kLongwiseObjectSlope:
      return ErrorCause::slope;
    default:
      return ErrorCause::curvature;
  }
}

/// Half-width of the torque's error band where strain, slope and curvature are small. There
/// bonded_layer is known better than the finite elements that tested it: it is within 0.002 % of
/// the spectral solution. The rest of the departure is at most a few times the sum of its terms'
/// magnitudes, since their signs differ. For a, b, area and peak pressure the finite elements
/// scatter more than such a bound, so that no run could confirm it.
double width_of_small_departures(const FingertipArguments<double>& at, double poisson_ratio,
                                 double ring_slope) {
  constexpr double kSpectral = 5e-5, kTimes = 3;
  const auto shapes = fingertip_shapes(2 * poisson_ratio, at.l);
  double sum = 0;
  int term = 0;
  for (int effect = 0; effect < kSymmetricEffects; ++effect)
    for (int shape = 0; shape < kShapesOf[effect]; ++shape, ++term) {
      const auto& row = kFingertipLayerTable.symmetric[term];
      sum += std::abs(at.effects[std::size_t(effect)] * shapes[std::size_t(shape)] *
                      (row[kSizeColumn] + row[kArmColumn]));
    }
  term = 0;
  for (int effect = kSymmetricEffects; effect < kFingertipEffects; ++effect)
    for (int shape = 0; shape < kShapesOf[effect]; ++shape, ++term)
      sum += std::abs(at.effects[std::size_t(effect)] * shapes[std::size_t(shape)] *
                      kFingertipLayerTable.aspect[term] * ring_slope);
  return kSpectral + kTimes * sum;
}

}  // namespace

ErrorBound error_bound(const ContactProblem& problem, const Prediction& prediction) noexcept {
  if (!prediction.has_answer) return outside("the model has no answer");
  if (problem.has_object_layer()) return outside("not known for two layers");
  const ContactInputOf<double> input = contact_input(
      problem.radii, problem.layer, problem.load.normal_force_N, problem.finger_curvature);
  const auto at = layer_arguments(input);
  const LayerQuantities logarithms =
      bonded_layer_logarithms(at.log_load, input.poisson_ratio, at.log_radii_ratio);
  const ContactNumbers flat = contact_of_logarithms(logarithms, at.mean_radius_m, input);
  // Written so that what is no number lies outside.
  if (!(flat.a_m > 0 && flat.b_m > 0 && flat.indentation_m > 0))
    return outside("bonded_layer, by which bounds are known, has no answer");
  if (const char* reason = reason_outside(problem, flat)) return outside(reason);
  if (!(fit_of_object(input, flat.a_m, flat.b_m) <= kFingertipRange.largest_fit))
    return outside(
        "not known where a hollow object nearly fits the finger: their shapes decide there, not "
        "their radii");
  const auto arguments = fingertip_arguments(input, flat, problem.is_object_spherical ? 1. : 0.);
  const BoundedErrors answer = numbers_of(prediction);
  ErrorBound result;
  result.known = true;
  // Adds one cause after the other, from the flat layer to the finger.
  BoundedErrors reference = numbers_of(flat);
  for (std::size_t q = 0; q < kBoundedQuantities; ++q)
    result.causes[std::size_t(ErrorCause::model)][q] = answer[q] / reference[q] - 1;
  FingertipArguments<double> taken = arguments;
  taken.effects.fill(0);
  for (const ErrorCause cause : {ErrorCause::strain, ErrorCause::slope, ErrorCause::curvature}) {
    for (std::size_t effect = 0; effect < kFingertipEffects; ++effect)
      if (cause_of(FingertipEffect(effect)) == cause)
        taken.effects[effect] = arguments.effects[effect];
    const BoundedErrors next = numbers_of(corrected_contact(
        logarithms, flat, fingertip_correction(kFingertipLayerTable, taken, input.poisson_ratio),
        input));
    for (std::size_t q = 0; q < kBoundedQuantities; ++q)
      result.causes[std::size_t(cause)][q] = answer[q] / next[q] - answer[q] / reference[q];
    reference = next;
  }
  const double size = departure_size(arguments);
  for (std::size_t q = 0; q < kBoundedQuantities; ++q) {
    const double ratio = answer[q] / reference[q];
    result.expected[q] = ratio - 1;
    double width = kFingertipLayerTable.widths[q].at(size);
    if (q == kTorque)
      width = std::min(width, width_of_small_departures(arguments, input.poisson_ratio,
                                                        log_ring_arm_slope(logarithms[kAspect])));
    result.bound[q] = std::abs(result.expected[q]) + ratio * width;
  }
  return result;
}

ErrorBound error_bound(const PressureModel& model, const ContactProblem& problem) noexcept {
  return error_bound(problem, model.predict(problem));
}

}  // namespace softfinger
