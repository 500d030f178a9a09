#pragma once

#include <array>
#include <cmath>

#include "softfinger/accuracy/error_bound.h"
#include "softfinger/layer/fingertip_layer_core.h"

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

}  // namespace softfinger
