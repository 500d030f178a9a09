#pragma once

#include <array>

#include "softfinger/math/plain_functions.h"

namespace softfinger {

/// Results of `bonded_layer` for a contact, as logarithms of dimensionless numbers.
enum LayerQuantity { kSize, kAspect, kDepth, kArm, kPeak, kLayerQuantities };
/// kSize:   ln(sqrt(ab)/h)
/// kAspect: ln(a/b)
/// kDepth:  ln(d R/(a b)): 1 (Hertz, circle), 1/2 (Winkler), 1/4 (thin incompressible)
/// kArm:    ln of the torque arm over that of a ring, (2/pi) a E(m): 3 pi/16, 8/15, 16/35
/// kPeak:   ln of the peak over the mean pressure: 3/2, 2, 3
template <class Real>
using LayerQuantitiesOf = std::array<Real, kLayerQuantities>;
using LayerQuantities = LayerQuantitiesOf<double>;

/// Exponents: 1/s^k = 1/s_thick^k + 1/s_thin^k and s_thin^n = s_Winkler^n + s_incompressible^n.
/// Chosen to follow the circular contact within 12 %; n = 4 keeps it smooth in nu at nu = 1/2.
constexpr double kThickThinExponent = 2.5;
constexpr double kThinExponent = 4;

/// ln of 3 pi/16, 8/15, 16/35, of 3/2, 2, 3 and of 1/2.
constexpr double kLogHertzArm = -0.5292465477222714, kLogWinklerArm = -0.6286086594223742,
                 kLogIncompressibleArm = -0.7827593392496325;
constexpr double kLogHertzPeak = 0.40546510810816438, kLogWinklerPeak = 0.69314718055994531,
                 kLogIncompressiblePeak = 1.09861228866810969;
constexpr double kLogWinklerDepth = -0.69314718055994531;

/// The limits' properties that depend on the shape alone, functions of ln(R'/R'').
template <class Real>
struct LimitShapesOf {
  Real log_radii_ratio{};
  Real log_hertz_aspect{}, log_incompressible_aspect{};  ///< ln(a/b)
  Real log_hertz_depth{}, log_incompressible_depth{};    ///< ln(d R/(a b))
  Real log_hertz_size_at_unit_load{};                    ///< ln(sqrt(ab)/h) at P R/(E* h³) = 1
  Real log_incompressible_size_at_unit_load{};
};
using LimitShapes = LimitShapesOf<double>;

/// `radii_ratio` = R'/R'' >= 1. About 250 ns: it solves for Hertz's ellipse.
LimitShapes limit_shapes(double radii_ratio) noexcept;

/// Smooth blend of the three exact limits of a quadric on a bonded layer (thick: Hertz; thin:
/// confined Winkler; thin and incompressible). It is exact in each limit and off by a few to 20 %
/// between them. The table of corrections is read at coordinates that come from it.
/// @param log_load  ln(P R/(E* h³))
/// @param compressibility  1 - 2 nu in [0, 1]
template <class Real>
LayerQuantitiesOf<Real> layer_blend(const LimitShapesOf<Real>& shapes, const Real& log_load,
                                    const Real& compressibility) noexcept {
  using plain::exp;
  using plain::log;
  constexpr double k = kThickThinExponent;
  const Real log_hertz = shapes.log_hertz_size_at_unit_load + log_load * (1. / 3);
  const Real log_incompressible = shapes.log_incompressible_size_at_unit_load + log_load * (1. / 6);
  // s⁴ of the thin compressible layer, 4 P/(pi M/E*), over that of the incompressible one; M/E* =
  // (1 - nu)²/(1 - 2 nu). Zero at nu = 1/2.
  const Real one_minus_nu = 0.5 * (1. + compressibility);
  const Real softness = compressibility * (1.2732395447351628 / (one_minus_nu * one_minus_nu)) *
                        exp(log_load - kThinExponent * log_incompressible);
  const Real incompressible_in_thin = 1. / (1. + softness);
  const Real winkler_in_thin = softness * incompressible_in_thin;
  const Real log_thin = log_incompressible + log(1. + softness) * (1 / kThinExponent);
  const Real thick_to_thin = exp(k * (log_hertz - log_thin));
  const Real thick = 1. / (1. + thick_to_thin);
  const Real thin = thick_to_thin * thick;

  // Weights of the limits in a blended size are its derivatives with respect to theirs.
  const Real winkler = thin * winkler_in_thin;
  const Real incompressible = thin * incompressible_in_thin;
  LayerQuantitiesOf<Real> blend;
  blend[kSize] = log_hertz - log(1. + thick_to_thin) * (1 / k);
  blend[kAspect] = thick * shapes.log_hertz_aspect + winkler * (0.5 * shapes.log_radii_ratio) +
                   incompressible * shapes.log_incompressible_aspect;
  blend[kDepth] = thick * shapes.log_hertz_depth + winkler * kLogWinklerDepth +
                  incompressible * shapes.log_incompressible_depth;
  blend[kArm] =
      thick * kLogHertzArm + winkler * kLogWinklerArm + incompressible * kLogIncompressibleArm;
  blend[kPeak] =
      thick * kLogHertzPeak + winkler * kLogWinklerPeak + incompressible * kLogIncompressiblePeak;
  return blend;
}

/// Coordinates of the table of corrections: the blend's ln(sqrt(ab)/h); a measure of the
/// compressibility that follows the change from compressible to incompressible thin layers, which
/// happens at s² (1 - 2 nu) ~ 8; and a measure of ln(R'/R''). The first grows from
/// `kTableLogSizeMin` to `kTableLogSizeMax`, the second from 0 to 1, the third from 0.
template <class Real>
struct TableCoordinatesOf {
  Real log_size, compressibility, elongation;
};
using TableCoordinates = TableCoordinatesOf<double>;

constexpr double kTableLogSizeMin = -5.3;  ///< s = 0.005
constexpr double kTableLogSizeMax = 4.9;   ///< s = 134
constexpr double kTableRadiiRatioMax = 100;

/// `log_size` within the table's range.
template <class Real>
TableCoordinatesOf<Real> table_coordinates(const Real& log_size, const Real& compressibility,
                                           const Real& log_radii_ratio) noexcept {
  using plain::exp;
  using plain::log;
  using plain::sqrt;
  // At compressibility 1/K the coordinate leaves its linear range.
  const Real K = 2. + 0.5 * exp(2. * log_size);
  // sqrt(L² + 1) - 1 without its cancellation: even in L, linear for long ellipses
  const Real L2 = log_radii_ratio * log_radii_ratio;
  return {log_size, log(1. + compressibility * K) / log(1. + K), L2 / (sqrt(L2 + 1.) + 1.)};
}

/// The inverse of the second coordinate: 1 - 2 nu.
double compressibility_at(double log_size, double coordinate) noexcept;
/// The inverse of the third: ln(R'/R'').
double log_radii_ratio_at(double elongation) noexcept;

}  // namespace softfinger
