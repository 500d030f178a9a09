#include "softfinger/pads/pad_law.h"

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"

namespace softfinger::pads {
namespace {

/// C = nu² (c0 + c1 nu²) s/(1 + (s/s1)²), G = 1/(1 + g1/t + g2 (1 + g3 (1 - 2 nu))/t²). Here r/H is
/// the radius of the disc of the same area over H, a the outline's size over r (1 for a disc, less
/// for a long outline), s = (r/H) a^x and t = (r/H) a^y. A thick pad is stiffened by its two end
/// zones, whose height goes with its width (C); it bulges more freely than the layer's equation
/// says (G).
struct PadCorrection {
  double c0, c1, s1, g1, g2, g3, x, y;
};

constexpr PadCorrection kPressing = {1.103,   1.4797, 2.0941,   0.15768,
                                     0.65739, 28.169, -0.89642, -0.23497};
constexpr PadCorrection kTilting = {0.80086, 1.3931, 3.0925,   0.12903,
                                    1.622,   29.992, -0.53037, 0.30823};

/// c = a^z nu² (r0 + r1 nu + r2 nu² + r6 nu^6), and the rim's width H/w.
struct RimCorrection {
  double r0, r1, r2, r6, w, z;
};

constexpr RimCorrection kStuckRim = {31.897, -159.81, 244.96, -536.02, 8.8673, 2.563};
constexpr RimCorrection kFrictionlessRim = {-4.3229, 1.5463, 2.5271, -130.35, 3.0771, -1.3323};

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

}  // namespace

template <class T>
PadLaw<T> pad_law(const PadShape& shape, const PadLayer<T>& layer, bool is_midplane) noexcept {
  const T nu = layer.poisson_ratio;
  const double radius_m = std::sqrt(shape.outline().area_m2() / kPi);
  const double slenderness = shape.size_m() / radius_m;
  const T width = radius_m / layer.thickness_m;
  const auto pressing = corrected(kPressing, nu, width, slenderness);
  const auto tilting = corrected(kTilting, nu, width, slenderness);
  const RimCorrection& rim = is_midplane ? kFrictionlessRim : kStuckRim;
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

double lift_off_factor(double size_m, double half_extent_m, const ElasticLayer& layer,
                       bool is_frictionless) noexcept {
  const double nu = layer.poisson_ratio, x = half_extent_m / layer.thickness_m;
  // A stuck rim presses more, a frictionless one less than the column there.
  if (!is_frictionless) return 1 + (1.055 * nu - 0.08) / (1 + 0.4334 * x);
  const double s = size_m / layer.thickness_m;
  return std::max(0.05, 1 - nu * (0.2703 + 0.7152 * nu) * s * std::pow(s / x, 0.186) /
                                (1 + 0.8574 * (1 - 2 * nu) * s * s));
}

template PadLaw<double> pad_law(const PadShape&, const PadLayer<double>&, bool) noexcept;
template PadLaw<PadDual> pad_law(const PadShape&, const PadLayer<PadDual>&, bool) noexcept;

}  // namespace softfinger::pads
