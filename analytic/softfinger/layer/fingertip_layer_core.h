#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "softfinger/layer/contact_numbers.h"
#include "softfinger/math/always_inline.h"

/// A layer on a curved finger at finite strain: `bonded_layer` times exp of small corrections, in
/// plain arithmetic on any kind of number (see bonded_layer_core.h).
namespace softfinger {

/// Effects that make a finger differ from a flat layer in linear theory. Each vanishes with h/R and
/// d/h. Those before kSymmetricEffects do not change when x and y are exchanged; they correct ln
/// sqrt(ab), ln d, ln peak and ln arm. The others change their sign; they correct ln(a/b).
///
/// e = d/h; gx = (a/R')², gy = (b/R'')²; ox, oy likewise with the object's curvature alone; kx, ky,
/// kxy the finger's curvature times h; l = s/(1 + s), s = sqrt(ab)/h; m = (a - b)/(a + b). All are
/// those of `bonded_layer`, and e, g, o and k are limited by `bounded`.
enum FingertipEffect {
  kStrain,             ///< e
  kStrainSquared,      ///< e²
  kSlope,              ///< gx + gy
  kSlopeOfLong,        ///< m (gx - gy)
  kObjectSlope,        ///< ox + oy
  kObjectSlopeOfLong,  ///< m (ox - oy)
  kBend,               ///< (kx + ky) l
  kBendOfLong,         ///< m (kx - ky) l
  kBendStrain,         ///< (kx + ky) e
  kBendSquared,        ///< (kx + ky)² l
  kBendDifference,     ///< (kx - ky)² l
  kTwist,              ///< kxy² l
  kSphere,             ///< ox + oy of an exact sphere; 0 of a paraboloid
  kStrainSlope,        ///< e (gx + gy)
  kSymmetricEffects,
  kLongStrain = kSymmetricEffects,  ///< m e
  kLongwiseSlope,                   ///< gx - gy
  kLongSlope,                       ///< m (gx + gy)
  kLongwiseObjectSlope,             ///< ox - oy
  kLongwiseBend,                    ///< (kx - ky) l
  kLongBend,                        ///< m (kx + ky) l
  kLongwiseBendStrain,              ///< (kx - ky) e
  kFingertipEffects
};

/// Each effect is multiplied by a polynomial: coefficients of the first so many of 1, n, l, n l,
/// n², l², n² l, n l², with n = 2 nu.
constexpr int kShapesOf[kFingertipEffects] = {8, 4, 6, 3, 3, 1, 6, 3, 3, 3, 1,
                                              2, 3, 2, 6, 6, 3, 2, 6, 3, 2};
constexpr int kLargestShapes = 8;

constexpr int shapes_before(int effect) {
  int sum = 0;
  for (int i = 0; i < effect; ++i) sum += kShapesOf[i];
  return sum;
}
constexpr int kSymmetricTerms = shapes_before(kSymmetricEffects);
constexpr int kAspectTerms = shapes_before(kFingertipEffects) - kSymmetricTerms;

/// Quantities that the symmetric terms correct, in the order of the table's columns.
enum FingertipColumn { kSizeColumn, kDepthColumn, kPeakColumn, kArmColumn, kFingertipColumns };

/// Relative width that holds 95 % of the errors of `fingertip_layer` in one quantity.
struct FingertipWidth {
  double least, per_size, power;
  /// @param size  departure_size
  template <class Real>
  Real at(const Real& size) const noexcept {
    using std::pow;
    return least + per_size * pow(size, power);
  }
};

/// Range of the finite-element runs to which the terms were fitted.
struct FingertipRange {
  double largest_size = 20;         ///< s = sqrt(ab)/h
  double largest_radii_ratio = 20;  ///< R'/R''
  double largest_bend = 0.6;        ///< h over the finger's smallest radius, so that a core is left
  double largest_flat_thickness = 5;  ///< h/sqrt(R' R'') of a flat layer under a curved object
  double largest_slope = 0.6;         ///< a/R' and b/R''
  double largest_strain = 0.42;       ///< d/h of `bonded_layer`
  double largest_fit = 0.1;           ///< `fit_of_object`
};
constexpr FingertipRange kFingertipRange;

/// Least squares over finite-element runs of whole fingers, by `softfinger atlas --fit`. One
/// contiguous block.
struct FingertipLayerTable {
  double symmetric[kSymmetricTerms][kFingertipColumns];
  double aspect[kAspectTerms];
  /// Error widths of a, b, indentation, area, peak pressure and largest torque, in this order.
  FingertipWidth widths[6];
  /// Errors of the same quantities in the runs themselves: 95 % of the runs state at most these.
  double finite_elements[6];
};
extern const FingertipLayerTable kFingertipLayerTable;

template <class Real>
using FingertipEffectsOf = std::array<Real, kFingertipEffects>;

/// The number that the effects' polynomials depend on besides 2 nu, and the effects.
template <class Real>
struct FingertipArguments {
  Real l;
  FingertipEffectsOf<Real> effects;
};

/// x for |x| well below `limit`, then towards `limit`: what lies far outside the runs changes the
/// answer no more than what lies at their end, and the answer keeps growing with the load.
template <class Real>
Real bounded(const Real& x, double limit) noexcept {
  using plain::sqrt;
  const Real part = x * (1 / limit);
  return x / sqrt(1. + part * part);
}
constexpr double kLimitOfStrain = 0.6, kLimitOfSlope = 0.4, kLimitOfBend = 1, kLimitOfRatio = 100,
                 kLimitOfSteepness = 4, kLimitOfDepth = 4;

/// @param flat  of `bonded_layer`
/// @param sphere  1 where the object is an exact sphere, else 0
template <class Real>
FingertipArguments<Real> fingertip_arguments(const ContactInputOf<Real>& input,
                                             const ContactNumbersOf<Real>& flat,
                                             double sphere) noexcept {
  using plain::sqrt;
  const Real& h = input.thickness_m;
  const Real s = sqrt(flat.a_m) * sqrt(flat.b_m) / h;
  const Real l = s / (1. + s);
  const Real m = (flat.a_m - flat.b_m) / (flat.a_m + flat.b_m);
  const Real strain = flat.indentation_m / h;
  const Real e = bounded<Real>(strain, kLimitOfStrain);
  const auto squared = [](const Real& slope) {
    return bounded<Real>(slope * slope, kLimitOfSlope);
  };
  const Real slope_x = flat.a_m / input.radius_major_m, slope_y = flat.b_m / input.radius_minor_m;
  const Real gx = squared(slope_x), gy = squared(slope_y);
  const Real ox = squared(slope_x - flat.a_m * input.finger_xx_per_m);
  const Real oy = squared(slope_y - flat.b_m * input.finger_yy_per_m);
  const Real kx = bounded<Real>(h * input.finger_xx_per_m, kLimitOfBend);
  const Real ky = bounded<Real>(h * input.finger_yy_per_m, kLimitOfBend);
  const Real kxy = bounded<Real>(h * input.finger_xy_per_m, kLimitOfBend);
  const Real slopes = gx + gy, slope = gx - gy, object = ox + oy, bend = kx + ky, bends = kx - ky;
  const Real bend_l = bend * l, bends_l = bends * l;
  FingertipArguments<Real> at = {
      l,
      {e, e * e, slopes, m * slope, object, m * (ox - oy), bend_l, m * bends_l, bend * e,
       bend * bend_l, bends * bends_l, kxy * kxy * l, sphere * object, e * slopes,
       //
       m * e, slope, m * slopes, ox - oy, bends_l, m * bend_l, bends * e}};
  // Contacts far longer, far steeper and far deeper than those of the runs return to the flat
  // layer's.
  const Real ratio = input.radius_major_m / input.radius_minor_m * (1 / kLimitOfRatio);
  const Real steep = (slope_x * slope_x + slope_y * slope_y) * (1 / kLimitOfSteepness);
  const Real deep = strain * strain * (1 / kLimitOfDepth);
  const Real near = 1. / (1. + ratio * ratio + steep * steep + deep * deep);
  for (Real& effect : at.effects) effect = effect * near;
  return at;
}

/// Measure of how closely a hollow object fits the finger, so that the gap depends on the shapes
/// and not on the radii of curvature alone: four times the gap's change from a paraboloid to an
/// ellipsoid, (a k)² (k R - 1) with the finger's curvature k and the gap's radius R, along the axis
/// where it is larger.
template <class Real>
Real fit_of_object(const ContactInputOf<Real>& input, const Real& a_m, const Real& b_m) noexcept {
  using plain::larger;
  const auto along = [](const Real& curvature_per_m, const Real& radius_m,
                        const Real& semi_axis_m) {
    const Real slope = semi_axis_m * curvature_per_m;
    return slope * slope * (curvature_per_m * radius_m - 1.);
  };
  return larger(larger(along(input.finger_xx_per_m, input.radius_major_m, a_m), 0.),
                along(input.finger_yy_per_m, input.radius_minor_m, b_m));
}

/// The size of all effects together: strain, slopes and curvature.
template <class Real>
Real departure_size(const FingertipArguments<Real>& at) noexcept {
  using plain::sqrt;
  using std::abs;
  return at.effects[kStrain] + at.effects[kSlope] + abs(at.effects[kBend]) +
         sqrt(at.effects[kTwist]);
}

/// The factors of the effects' polynomials.
template <class Real>
std::array<Real, kLargestShapes> fingertip_shapes(const Real& n, const Real& l) noexcept {
  const Real nl = n * l;
  return {Real{} + 1., n, l, nl, n * n, l * l, n * nl, nl * l};
}

/// Corrections of ln sqrt(ab), ln d, ln peak, ln arm (FingertipColumn) and ln(a/b).
template <class Real>
struct FingertipCorrectionOf {
  std::array<Real, kFingertipColumns> symmetric{};
  Real aspect{};
};

template <class Real>
FingertipCorrectionOf<Real> fingertip_correction(const FingertipLayerTable& table,
                                                 const FingertipArguments<Real>& at,
                                                 const Real& poisson_ratio) noexcept {
  const auto shapes = fingertip_shapes<Real>(2. * poisson_ratio, at.l);
  FingertipCorrectionOf<Real> correction;
  int term = 0;
  for (int effect = 0; effect < kSymmetricEffects; ++effect) {
    std::array<Real, kFingertipColumns> sum{};
    for (int shape = 0; shape < kShapesOf[effect]; ++shape, ++term)
      for (int column = 0; column < kFingertipColumns; ++column)
        sum[column] = sum[column] + shapes[shape] * table.symmetric[term][column];
    for (int column = 0; column < kFingertipColumns; ++column)
      correction.symmetric[column] =
          correction.symmetric[column] + at.effects[effect] * sum[column];
  }
  term = 0;
  for (int effect = kSymmetricEffects; effect < kFingertipEffects; ++effect) {
    Real sum{};
    for (int shape = 0; shape < kShapesOf[effect]; ++shape, ++term)
      sum = sum + shapes[shape] * table.aspect[term];
    correction.aspect = correction.aspect + at.effects[effect] * sum;
  }
  return correction;
}

/// Overload that carries derivatives: the polynomials are differentiated with respect to n and l
/// only, and the chain rule gives the rest.
template <int N>
FingertipCorrectionOf<Dual<N>> fingertip_correction(const FingertipLayerTable& table,
                                                    const FingertipArguments<Dual<N>>& at,
                                                    const Dual<N>& poisson_ratio) noexcept {
  const auto shapes = fingertip_shapes<Dual<2>>(Dual<2>::variable(2 * poisson_ratio.value, 0),
                                                Dual<2>::variable(at.l.value, 1));
  const auto add = [](double factor, const Dual<N>& number, Dual<N>& to) {
    for (std::size_t i = 0; i < N; ++i) to.slope[i] += factor * number.slope[i];
  };
  FingertipCorrectionOf<Dual<N>> correction;
  double by_n[kFingertipColumns] = {}, by_l[kFingertipColumns] = {};
  int term = 0;
  for (std::size_t effect = 0; effect < kSymmetricEffects; ++effect) {
    double sum[kFingertipColumns] = {}, sum_n[kFingertipColumns] = {},
           sum_l[kFingertipColumns] = {};
    for (std::size_t shape = 0; shape < std::size_t(kShapesOf[effect]); ++shape, ++term)
      for (int column = 0; column < kFingertipColumns; ++column) {
        const double coefficient = table.symmetric[term][column];
        sum[column] += shapes[shape].value * coefficient;
        sum_n[column] += shapes[shape].slope[0] * coefficient;
        sum_l[column] += shapes[shape].slope[1] * coefficient;
      }
    for (std::size_t column = 0; column < kFingertipColumns; ++column) {
      const Dual<N>& of = at.effects[effect];
      correction.symmetric[column].value += of.value * sum[column];
      by_n[column] += of.value * sum_n[column];
      by_l[column] += of.value * sum_l[column];
      add(sum[column], of, correction.symmetric[column]);
    }
  }
  for (std::size_t column = 0; column < kFingertipColumns; ++column) {
    add(2 * by_n[column], poisson_ratio, correction.symmetric[column]);
    add(by_l[column], at.l, correction.symmetric[column]);
  }
  double aspect_by_n = 0, aspect_by_l = 0;
  term = 0;
  for (std::size_t effect = kSymmetricEffects; effect < kFingertipEffects; ++effect) {
    double sum = 0, sum_n = 0, sum_l = 0;
    for (std::size_t shape = 0; shape < std::size_t(kShapesOf[effect]); ++shape, ++term) {
      const double coefficient = table.aspect[term];
      sum += shapes[shape].value * coefficient;
      sum_n += shapes[shape].slope[0] * coefficient;
      sum_l += shapes[shape].slope[1] * coefficient;
    }
    const Dual<N>& of = at.effects[effect];
    correction.aspect.value += of.value * sum;
    aspect_by_n += of.value * sum_n;
    aspect_by_l += of.value * sum_l;
    add(sum, of, correction.aspect);
  }
  add(2 * aspect_by_n, poisson_ratio, correction.aspect);
  add(aspect_by_l, at.l, correction.aspect);
  return correction;
}

/// Applies the corrections to the flat layer's logarithms.
template <class Real>
ContactNumbersOf<Real> corrected_contact(const LayerQuantitiesOf<Real>& flat,
                                         const ContactNumbersOf<Real>& flat_numbers,
                                         const FingertipCorrectionOf<Real>& correction,
                                         const ContactInputOf<Real>& input) noexcept {
  using plain::exp;
  using plain::larger;
  const auto& change = correction.symmetric;
  // The peak's correction is of the peak itself, the arm's of the arm over the ring's.
  const Real size_m = input.thickness_m * exp(flat[kSize] + change[kSizeColumn]);
  const Real aspect = larger(flat[kAspect] + correction.aspect, 0.);
  const Real aspect_root = exp(0.5 * aspect);
  const Real arm_m = size_m * exp(flat[kArm] + change[kArmColumn]);
  return {size_m * aspect_root,
          size_m / aspect_root,
          flat_numbers.indentation_m * exp(change[kDepthColumn]),
          flat_numbers.peak_pressure_Pa * exp(change[kPeakColumn]),
          arm_m * exp(log_ring_arm(aspect)),
          arm_m};
}

template <class Real>
SOFTFINGER_ALWAYS_INLINE inline ContactNumbersOf<Real> fingertip_layer_numbers(
    const ContactInputOf<Real>& input, double sphere) noexcept {
  const LayerArguments<Real> at = layer_arguments(input);
  const LayerQuantitiesOf<Real> flat =
      bonded_layer_logarithms(at.log_load, input.poisson_ratio, at.log_radii_ratio);
  const ContactNumbersOf<Real> numbers = contact_of_logarithms<Real>(flat, at.mean_radius_m, input);
  return corrected_contact<Real>(
      flat, numbers,
      fingertip_correction(kFingertipLayerTable, fingertip_arguments<Real>(input, numbers, sphere),
                           input.poisson_ratio),
      input);
}

}  // namespace softfinger
