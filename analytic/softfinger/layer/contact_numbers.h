#pragma once

#include "softfinger/input/constants.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/layer/bonded_layer_core.h"
#include "softfinger/math/always_inline.h"

namespace softfinger {

/// Inputs of a contact of one layer with a rigid object, as numbers that may carry derivatives or
/// stand for several contacts. SI, as in ContactProblem.
template <class Real>
struct ContactInputOf {
  Real normal_force_N, youngs_modulus_Pa, poisson_ratio, thickness_m;
  Real radius_major_m, radius_minor_m;
  Real finger_xx_per_m, finger_yy_per_m, finger_xy_per_m;
};

/// The numbers of a `Prediction`.
template <class Real>
struct ContactNumbersOf {
  Real a_m, b_m, indentation_m, peak_pressure_Pa, torque_arm_exact_m, torque_arm_paper_m;
};
using ContactNumbers = ContactNumbersOf<double>;

inline ContactInputOf<double> contact_input(const RelativeRadii& radii, const ElasticLayer& layer,
                                            double normal_force_N,
                                            const SurfaceCurvature& finger = {}) noexcept {
  return {normal_force_N,    layer.youngs_modulus_Pa, layer.poisson_ratio,
          layer.thickness_m, radii.major_m,           radii.minor_m,
          finger.xx_per_m,   finger.yy_per_m,         finger.xy_per_m};
}

/// The dimensionless numbers that a quadric on a flat layer depends on, besides Poisson's ratio.
template <class Real>
struct LayerArguments {
  Real mean_radius_m;    ///< R = sqrt(R' R'')
  Real log_load;         ///< ln(P R/(E* h³))
  Real log_radii_ratio;  ///< ln(R'/R'')
};

template <class Real>
SOFTFINGER_ALWAYS_INLINE inline LayerArguments<Real> layer_arguments(
    const ContactInputOf<Real>& input) noexcept {
  using plain::log;
  using plain::sqrt;
  const Real per_thickness = 1. / input.thickness_m;
  const Real R = sqrt(input.radius_major_m) * sqrt(input.radius_minor_m);
  const Real per_modulus =
      (1. - input.poisson_ratio * input.poisson_ratio) / input.youngs_modulus_Pa;
  return {
      R,
      log(input.normal_force_N * per_modulus * per_thickness * per_thickness * (R * per_thickness)),
      log(input.radius_major_m / input.radius_minor_m)};
}

/// Converts logarithms (LayerQuantity) to the contact itself.
template <class Real>
SOFTFINGER_ALWAYS_INLINE inline ContactNumbersOf<Real> contact_of_logarithms(
    const LayerQuantitiesOf<Real>& logarithms, const Real& mean_radius_m,
    const ContactInputOf<Real>& input) noexcept {
  using plain::exp;
  const Real size_m = input.thickness_m * exp(logarithms[kSize]);
  const Real aspect_root = exp(0.5 * logarithms[kAspect]);
  const Real arm_m = size_m * exp(logarithms[kArm]);
  return {size_m * aspect_root,
          size_m / aspect_root,
          size_m / mean_radius_m * size_m * exp(logarithms[kDepth]),
          input.normal_force_N / (kPi * size_m * size_m) * exp(logarithms[kPeak]),
          arm_m * exp(log_ring_arm(logarithms[kAspect])),
          arm_m};
}

/// `bonded_layer` in these numbers.
template <class Real>
SOFTFINGER_ALWAYS_INLINE inline ContactNumbersOf<Real> bonded_layer_numbers(
    const ContactInputOf<Real>& input) noexcept {
  const LayerArguments<Real> at = layer_arguments(input);
  return contact_of_logarithms<Real>(
      bonded_layer_logarithms(at.log_load, input.poisson_ratio, at.log_radii_ratio),
      at.mean_radius_m, input);
}

}  // namespace softfinger
