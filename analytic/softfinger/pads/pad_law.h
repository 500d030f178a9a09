#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "softfinger/input/constants.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/math/dual.h"
#include "softfinger/pads/pad_shape.h"

/// Internal to the pads' models: the pressure of a flat pad, written once for numbers and for
/// numbers with derivatives.
namespace softfinger::pads {

/// Young's modulus, Poisson's ratio and thickness h.
template <class T>
struct PadLayer {
  T youngs_modulus_Pa, poisson_ratio, thickness_m;
};

/// Pressure over E d/h, with d/h the strain of a column: of pressing
///   p = 1 + C + G b U + c (psi - mean of psi),   U of source 1,
/// and of tilting by d/h per metre about an axis
///   p = x (1 + C') + G' b V,                      V of source x,
/// where b = 6/((1 + nu) H²), k² = 3 (1 - 2 nu)/(nu² H²) and psi is 1 on the outline and decays
/// inwards over part of the thickness: the rim's peak. C, G and c are fitted. H is the thickness
/// between two stuck faces: h, or 2 h of a frictionless face, whose mirror image is the other half
/// of a stuck pad.
template <class T>
struct PadLaw {
  T excess_uniform, excess_layer;  ///< C and G
  T tilt_uniform, tilt_layer;      ///< C' and G'
  T rim, rim_per_m2;               ///< c and the k² of psi
  /// b/(k² + l) = 6 nu²/((1 + nu) (3 (1 - 2 nu) + nu² H² l)): regular at nu = 0 and 1/2.
  T numerator, compressible, per_stiffness;

  /// int of b U against what the row stands for.
  T layer_sum(const PadShape::Sums& sums, const PadShape::Row& row) const noexcept {
    T sum = 0;
    for (std::size_t i = 0; i < row.size(); ++i)
      sum += row[i] * (numerator / (compressible + per_stiffness * sums.stiffness_per_m2[i]));
    return sum;
  }
  /// int of 1 - psi.
  T rim_sum(const PadShape::Sums& sums, const PadShape::Row& row) const noexcept {
    T sum = 0;
    for (std::size_t i = 0; i < row.size(); ++i)
      sum += row[i] * (rim_per_m2 / (rim_per_m2 + sums.stiffness_per_m2[i]));
    return sum;
  }
};

/// C = nu² (c0 + c1 nu²) s/(1 + (s/s1)²), G = 1/(1 + g1/t + g2 (1 + g3 (1 - 2 nu))/t²). Here r/H is
/// the radius of the disc of the same area over H, a the outline's size over r (1 for a disc, less
/// for a long outline), s = (r/H) a^x and t = (r/H) a^y. A thick pad is stiffened by its two end
/// zones, whose height goes with its width (C); it bulges more freely than the layer's equation
/// says (G).
struct PadCorrection {
  double c0, c1, s1, g1, g2, g3, x, y;
};

inline constexpr PadCorrection kPressing = {1.103,   1.4797, 2.0941,   0.15768,
                                            0.65739, 28.169, -0.89642, -0.23497};
inline constexpr PadCorrection kTilting = {0.80086, 1.3931, 3.0925,   0.12903,
                                           1.622,   29.992, -0.53037, 0.30823};

/// c = a^z nu² (r0 + r1 nu + r2 nu² + r6 nu^6), and the rim's width H/w.
struct RimCorrection {
  double r0, r1, r2, r6, w, z;
};

inline constexpr RimCorrection kStuckRim = {31.897, -159.81, 244.96, -536.02, 8.8673, 2.563};
inline constexpr RimCorrection kFrictionlessRim = {-4.3229, 1.5463, 2.5271,
                                                   -130.35, 3.0771, -1.3323};

template <class T>
struct UniformAndLayer {
  T uniform, layer;
};

template <class T>
UniformAndLayer<T> corrected(const PadCorrection& fit, const T& nu, const T& width,
                             double slenderness) noexcept {
  const T s = width * std::pow(slenderness, fit.x), t = width * std::pow(slenderness, fit.y);
  const T part = s * (1 / fit.s1), g2 = fit.g2 * (1 + fit.g3 * (1 - 2 * nu));
  return {nu * nu * (fit.c0 + fit.c1 * nu * nu) * s / (1 + part * part),
          t * t / (t * t + fit.g1 * t + g2)};
}

template <class T>
PadLaw<T> pad_law(const PadShape& shape, PadLayer<T> layer, bool is_frictionless) noexcept {
  if (is_frictionless) layer.thickness_m = 2 * layer.thickness_m;
  const T nu = layer.poisson_ratio;
  const double radius_m = std::sqrt(shape.outline().area_m2() / kPi);
  const double slenderness = shape.size_m() / radius_m;
  const T width = radius_m / layer.thickness_m;
  const auto pressing = corrected(kPressing, nu, width, slenderness);
  const auto tilting = corrected(kTilting, nu, width, slenderness);
  const RimCorrection& rim = is_frictionless ? kFrictionlessRim : kStuckRim;
  const T per_thickness = rim.w / layer.thickness_m;
  PadLaw<T> law;
  law.numerator = 6 * nu * nu / (1 + nu);
  law.compressible = 3 * (1 - 2 * nu);
  law.per_stiffness = nu * nu * layer.thickness_m * layer.thickness_m;
  law.excess_uniform = pressing.uniform;
  law.excess_layer = pressing.layer;
  law.tilt_uniform = tilting.uniform;
  law.tilt_layer = tilting.layer;
  const T nu2 = nu * nu;
  law.rim = std::pow(slenderness, rim.z) * nu2 *
            (rim.r0 + rim.r1 * nu + rim.r2 * nu2 + rim.r6 * nu2 * nu2 * nu2);
  law.rim_per_m2 = per_thickness * per_thickness;
  return law;
}

/// Resultants of p, per E d/h and per E/h times a tilt: force, moments about the centroid, arms.
template <class T>
struct PadResultants {
  T force;                     ///< int p dA of pressing
  std::array<T, 2> moment;     ///< int x p, int y p of pressing
  T radius;                    ///< int r p of pressing
  std::array<T, 2> radius_by;  ///< int x/r p, int y/r p

  T centre(std::size_t axis) const noexcept { return moment[axis] / force; }
  /// Arm about the centre of pressure: to first order in its distance from the centroid, which is
  /// below a hundredth of the size; the second order is below 1e-4.
  T arm() const noexcept {
    return (radius - centre(0) * radius_by[0] - centre(1) * radius_by[1]) / force;
  }
};

template <class T>
PadResultants<T> pressing_resultants(const PadShape& shape, const PadLaw<T>& law) noexcept {
  const PadShape::Sums& sums = shape.sums(PadShape::constant);
  const double area = shape.outline().area_m2();
  const T rim_share = law.rim_sum(sums, sums.integral) / area;
  // int of p against a function of the row, whose own integral is `plain`.
  const auto against = [&](const PadShape::Row& row, double plain) {
    return plain * (1 + law.excess_uniform) + law.excess_layer * law.layer_sum(sums, row) +
           law.rim * (plain * rim_share - law.rim_sum(sums, row));
  };
  const Eigen::Vector2d& by_point = shape.radius_by_point_m2();
  return {against(sums.integral, area),
          {against(sums.moment_x, 0), against(sums.moment_y, 0)},
          against(sums.radius, shape.radius_integral_m3()),
          {against(sums.radius_by_x, by_point.x()), against(sums.radius_by_y, by_point.y())}};
}

/// Range of size over thickness that the corrections were fitted to; `size_m` is a disc's radius.
constexpr double kLeastWidth = 0.45, kLargestWidth = 16;
/// Narrower and wider pads than these, in the same measure, have no answer at all.
constexpr double kNarrowest = 1e-3, kWidest = 1e4;
/// Compression over thickness to which linear theory holds.
constexpr double kLargestStrain = 0.1;

/// Eccentricity of the load at which the rim lifts off, over that of columns under the same tilt,
/// which leave where the tilt takes back the approach. Stuck: fitted to 18 rows of finite elements,
/// on 146 others within 10 % (95 %) and 15 %. Frictionless: fitted to 73 rows, on as many others
/// within 0.23 (95 %): rough, because the very corners lift off first, and at least 0.05, because a
/// thin rim near nu = 1/2 lifts off by pressing alone.
/// @param half_extent_m  of the outline along the tilt
double lift_off_factor(double size_m, double half_extent_m, const ElasticLayer& layer,
                       bool is_frictionless) noexcept;

/// The faces keep a twisted pad from warping over this many sizes of its width.
constexpr double kWarping = 1;

/// p = E d/h, with nothing else: `pad_uniform`.
template <class T>
PadLaw<T> uniform_law() noexcept {
  return {0, 0, 0, 0, 0, 1, 0, 1, 0};
}

using PadDual = Dual<3>;  ///< by E, nu, h

}  // namespace softfinger::pads
