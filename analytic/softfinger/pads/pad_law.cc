#include "softfinger/pads/pad_law.h"

#include <cmath>

#include "softfinger/input/constants.h"

namespace softfinger::pads {
namespace {

/// C = nu² (c0 + c1 nu) s/(1 + (s/s1)²), G = 1/(1 + g1/s + g2/s²), s the radius of the disc of the
/// same area over H. A thick pad is stiffened by its two end zones, whose height goes with its
/// width (C); the layer's equation counts from a thickness on that leaves it room (G).
struct PadCorrection {
  double c0, c1, s1, g1, g2_at_0, g2_by_nu;
};

constexpr PadCorrection kPressing = {-2.2176, 7.6236, 3.3193, 0.50892, -1.7921, 5.9736};
constexpr PadCorrection kTilting = {0.97847, 0.17415, 1.72945, 0.21572, 17.3749, -34.7682};

/// c = nu² (r0 + r1 nu + r2 nu²), and the rim's width H/w.
struct RimCorrection {
  double r0, r1, r2, w;
};

constexpr RimCorrection kStuckRim = {14.7193, -24.3177, 5.71765, 10.4987};
constexpr RimCorrection kFrictionlessRim = {-29.0417, 158.772, -233.964, 2.15274};

double larger(double x, double least) noexcept { return x > least ? x : least; }

template <class T>
struct UniformAndLayer {
  T uniform, layer;
};

template <class T>
UniformAndLayer<T> corrected(const PadCorrection& fit, const T& nu, const T& s) noexcept {
  const T part = s * (1 / fit.s1);
  const T g2 = larger(fit.g2_at_0 + fit.g2_by_nu * nu, 0);
  return {nu * nu * (fit.c0 + fit.c1 * nu) * s / (1 + part * part),
          s * s / (s * s + fit.g1 * s + g2)};
}

}  // namespace

template <class T>
PadLaw<T> pad_law(const PadShape& shape, const PadLayer<T>& layer, bool is_midplane) noexcept {
  const T nu = layer.poisson_ratio;
  const T s = std::sqrt(shape.outline().area_m2() / kPi) / layer.thickness_m;
  const auto pressing = corrected(kPressing, nu, s), tilting = corrected(kTilting, nu, s);
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
  law.rim = nu * nu * (rim.r0 + rim.r1 * nu + rim.r2 * nu * nu);
  law.rim_per_m2 = per_thickness * per_thickness;
  return law;
}

double lift_off_factor(double half_extent_m, const ElasticLayer& layer,
                       bool is_frictionless) noexcept {
  if (is_frictionless) return 1;
  return 1 + (0.1 + 0.4 * layer.poisson_ratio) / (1 + 0.2 * half_extent_m / layer.thickness_m);
}

template PadLaw<double> pad_law(const PadShape&, const PadLayer<double>&, bool) noexcept;
template PadLaw<PadDual> pad_law(const PadShape&, const PadLayer<PadDual>&, bool) noexcept;

}  // namespace softfinger::pads
