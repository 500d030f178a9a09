#include "softfinger/accuracy/error_bound.h"

#include <cmath>

#include "softfinger/accuracy/error_bound_core.h"
#include "softfinger/layer/stack_contact.h"

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

/// @return  null where the errors of contacts like this are known
const char* reason_outside(const ContactInputOf<double>& input, const ContactNumbers& flat) {
  for (const ErrorLimit<double>& limit : error_limits(input, flat))
    if (!(limit.excess <= 0)) return limit.reason;
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

}  // namespace

ErrorBound error_bound(const ContactProblem& problem, const Prediction& prediction) noexcept {
  if (!prediction.has_answer) return outside("the model has no answer");
  if (problem.has_object_layer()) return outside("not known for two layers");
  // Sublayers: strain, slope and curvature change the contact as that of the homogeneous layer.
  const bool is_stack = problem.stack.count > 0;
  StackContact stack;
  if (is_stack) stack = stack_contact(problem.radii, problem.stack, problem.load.normal_force_N);
  const ContactInputOf<double> input =
      contact_input(problem.radii, is_stack ? stack.equivalent : problem.layer,
                    problem.load.normal_force_N, problem.finger_curvature);
  const auto at = layer_arguments(input);
  const LayerQuantities logarithms =
      is_stack ? stack.logarithms
               : bonded_layer_logarithms(at.log_load, input.poisson_ratio, at.log_radii_ratio);
  const ContactNumbers flat = contact_of_logarithms(logarithms, at.mean_radius_m, input);
  // Written so that what is no number lies outside.
  if (!(flat.a_m > 0 && flat.b_m > 0 && flat.indentation_m > 0 && stack.is_solved))
    return outside("bonded_layer, by which bounds are known, has no answer");
  if (const char* reason = reason_outside(input, flat)) return outside(reason);
  if (stack.log_contrast > kLargestStackContrast)
    return outside("not known for sublayers whose moduli differ by more than a factor of 100");
  if (stack.log_contrast > 0 && std::exp(at.log_radii_ratio) > kLargestStackRadiiRatio * (1 + 1e-9))
    return outside("not known for sublayers and R'/R'' above 5");
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
  const StackStrain stretched = stack_strain(stack);
  for (std::size_t q = 0; q < kBoundedQuantities; ++q) {
    const double next = reference[q] * std::exp(-stretched.change[q]);
    result.causes[std::size_t(ErrorCause::strain)][q] +=
        answer[q] / next - answer[q] / reference[q];
    reference[q] = next;
  }
  BoundedErrors widths = error_widths(arguments, input.poisson_ratio, logarithms[kAspect]);
  const BoundedErrors of_stack = stack_widths(stack, at.log_radii_ratio);
  for (std::size_t q = 0; q < kBoundedQuantities; ++q)
    widths[q] += of_stack[q] + stretched.width[q];
  for (std::size_t q = 0; q < kBoundedQuantities; ++q) {
    const double ratio = answer[q] / reference[q];
    result.expected[q] = ratio - 1;
    result.bound[q] = std::abs(result.expected[q]) + ratio * widths[q];
  }
  return result;
}

ErrorBound error_bound(const PressureModel& model, const ContactProblem& problem) noexcept {
  return error_bound(problem, model.predict(problem));
}

}  // namespace softfinger
