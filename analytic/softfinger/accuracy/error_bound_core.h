#pragma once

#include <array>
#include <cmath>

#include "softfinger/accuracy/error_bound.h"
#include "softfinger/layer/fingertip_layer_core.h"
#include "softfinger/layer/stack_contact.h"

/// Limits of what is known about the errors of a finger's contact, and the width of their band, in
/// plain arithmetic on any kind of number (see bonded_layer_core.h).
namespace softfinger {

/// One border of the contacts whose errors are known.
template <class Real>
struct ErrorLimit {
  Real excess;         ///< above 0: beyond
  const char* reason;  ///< in words, why nothing is known there
};
constexpr std::size_t kErrorLimits = 8;

/// @param flat  of `bonded_layer`
template <class Real>
std::array<ErrorLimit<Real>, kErrorLimits> error_limits(
    const ContactInputOf<Real>& input, const ContactNumbersOf<Real>& flat) noexcept {
  using plain::larger;
  using plain::sqrt;
  using std::abs;
  using std::hypot;
  constexpr const FingertipRange& kRange = kFingertipRange;
  const Real& h = input.thickness_m;
  const Real mean_per_m = 0.5 * (input.finger_xx_per_m + input.finger_yy_per_m);
  const Real spread_per_m =
      hypot(0.5 * (input.finger_xx_per_m - input.finger_yy_per_m), input.finger_xy_per_m);
  const Real largest_per_m = mean_per_m + spread_per_m;
  return {
      {{spread_per_m - 1e-9 * abs(largest_per_m) - mean_per_m,
        "not known for a hollow finger: the runs are of convex ones"},
       {input.radius_major_m - kRange.largest_radii_ratio * input.radius_minor_m,
        "not known for R'/R'' above 20"},
       {h * largest_per_m - kRange.largest_bend,
        "not known for layers thicker than 0.6 of the finger's smallest radius"},
       {h - kRange.largest_flat_thickness * sqrt(input.radius_major_m) * sqrt(input.radius_minor_m),
        "not known for layers thicker than five times the relative radius"},
       {sqrt(flat.a_m) * sqrt(flat.b_m) - kRange.largest_size * h,
        "not known for contacts larger than 20 h"},
       {larger(flat.a_m - kRange.largest_slope * input.radius_major_m,
               flat.b_m - kRange.largest_slope * input.radius_minor_m),
        "not known for slopes above 0.6 at the edge of the contact"},
       {flat.indentation_m - kRange.largest_strain * h,
        "not known for layers compressed by more than 40 %"},
       {fit_of_object(input, flat.a_m, flat.b_m) - kRange.largest_fit,
        "not known where a hollow object nearly fits the finger: their shapes decide there, "
        "not their radii"}}};
}

/// Half-width of the torque's error band where strain, slope and curvature are small. There
/// bonded_layer is known better than the finite elements that tested it: it is within 0.002 % of
/// the spectral solution, of which kSpectral is two and a half times. The rest of the departure is
/// at most a few times the sum of its terms' magnitudes, since their signs differ. For a, b, area
/// and peak pressure the finite elements scatter more than such a bound, so that no run could
/// confirm it.
template <class Real>
Real width_of_small_departures(const FingertipArguments<Real>& at, const Real& poisson_ratio,
                               const Real& ring_slope) noexcept {
  using std::abs;
  constexpr double kSpectral = 5e-5, kTimes = 3;
  const auto shapes = fingertip_shapes<Real>(2. * poisson_ratio, at.l);
  Real sum{};
  int term = 0;
  for (int effect = 0; effect < kSymmetricEffects; ++effect)
    for (int shape = 0; shape < kShapesOf[effect]; ++shape, ++term) {
      const auto& row = kFingertipLayerTable.symmetric[term];
      sum += abs(at.effects[std::size_t(effect)] * shapes[std::size_t(shape)] *
                 (row[kSizeColumn] + row[kArmColumn]));
    }
  term = 0;
  for (int effect = kSymmetricEffects; effect < kFingertipEffects; ++effect)
    for (int shape = 0; shape < kShapesOf[effect]; ++shape, ++term)
      sum += abs(at.effects[std::size_t(effect)] * shapes[std::size_t(shape)] *
                 kFingertipLayerTable.aspect[term] * ring_slope);
  return kSpectral + kTimes * sum;
}

/// Half-widths of the bands around `fingertip_layer` that hold 95 % of all fingers.
/// @param log_aspect  ln(a/b) of `bonded_layer`
template <class Real>
std::array<Real, kBoundedQuantities> error_widths(const FingertipArguments<Real>& at,
                                                  const Real& poisson_ratio,
                                                  const Real& log_aspect) noexcept {
  using plain::smaller;
  const Real size = departure_size(at);
  std::array<Real, kBoundedQuantities> widths;
  for (std::size_t q = 0; q < kBoundedQuantities; ++q)
    widths[q] = kFingertipLayerTable.widths[q].at(size);
  // The largest torque is the only quantity that the finite elements resolve to 0.1 %.
  Real& torque = widths[kBoundedQuantities - 1];
  torque = smaller(
      width_of_small_departures(at, poisson_ratio, Real(log_ring_arm_slope(log_aspect))), torque);
  return widths;
}

/// Largest relative errors of `stack_contact` against linear elasticity, in 95 % of all stacks.
///
/// Fitted to `layer_fredholm` and `layer_fft` on 1000 random stacks of two to five sublayers (half
/// of them under R'/R'' of 1 to 5; moduli to a ratio of 100, nu 0.3 to 0.499, shares of the
/// thickness 5 to 90 %, sqrt(ab) 0.1 to 5 thicknesses), checked on 1000 drawn anew
/// (tests/analytic/stack_layer_test.cc draws others). The errors grow where the surface is stiffer
/// than what lies below, and with the ellipse where the contact grows into other sublayers.
inline BoundedErrors stack_widths(const StackContact& contact, double log_radii_ratio) noexcept {
  struct Width {
    double least, softening, ellipse, both;
  };
  constexpr std::array<Width, kBoundedQuantities> kWidths = {{{0.0012, 6.5e-4, 0.005, 3e-4},
                                                              {0.0012, 6.5e-4, 0.06, 2e-4},
                                                              {0.0012, 2e-5, 0.02, 6e-4},
                                                              {0.0016, 1.4e-3, 0.07, 1e-4},
                                                              {0.002, 1.9e-3, 0.23, 1e-3},
                                                              {0.0006, 2.5e-4, 0.055, 3e-4}}};
  const double softening = contact.log_softening * contact.log_contrast;
  const double ellipse =
      log_radii_ratio * std::abs(contact.exponent_change) / std::fmax(contact.load_exponent, 1);
  BoundedErrors widths{};
  if (!(contact.log_contrast > 0)) return widths;
  for (std::size_t q = 0; q < kBoundedQuantities; ++q) {
    const Width& of = kWidths[q];
    widths[q] = of.least + of.softening * softening + of.ellipse * ellipse +
                of.both * log_radii_ratio * softening;
  }
  return widths;
}
/// Changes at finite strain that a stack has beyond those of its equivalent homogeneous layer: a
/// stretched skin that is stiffer than what lies below stiffens, and spreads the load.
struct StackStrain {
  BoundedErrors change{};  ///< ln(linear/finite strain)
  BoundedErrors width{};   ///< half-widths of the band around it
};

/// Proportional to e f, e = d/h of the equivalent layer, f = c/(1 + c/4), c = ln(E*_surface/
/// E*_softest). The factors are the middle and the half range of five firm skins on pulps pressed
/// by finite elements at finite strain without friction (E ratio 3 to 30, e 0.15 to 0.2), widened
/// by a fifth, since five are few; two soft skins on firm pulps agree with the homogeneous layer
/// within its own band, but for the peak.
inline StackStrain stack_strain(const StackContact& contact) noexcept {
  constexpr BoundedErrors kChange = {0.05, 0.05, 0.09, 0.1, -0.47, 0.14};
  constexpr BoundedErrors kHalfRange = {0.06, 0.05, 0.065, 0.11, 0.16, 0.04};
  constexpr double kPeak = 0.05;
  if (!(contact.log_contrast > 0)) return {};
  const double strain = contact.numbers.indentation_m / contact.equivalent.thickness_m;
  const double f = contact.log_softening / (1 + contact.log_softening / 4);
  StackStrain result;
  for (std::size_t q = 0; q < kBoundedQuantities; ++q) {
    result.change[q] = kChange[q] * strain * f;
    result.width[q] = kHalfRange[q] * strain * f;
  }
  result.width[4] += kPeak * strain * contact.log_contrast;
  return result;
}

/// Range of the stacks that `stack_widths` was fitted to.
constexpr double kLargestStackContrast = 5;    ///< `StackContact::log_contrast`
constexpr double kLargestStackRadiiRatio = 5;  ///< R'/R''

}  // namespace softfinger
