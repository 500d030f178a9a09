#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "softfinger/layer/bonded_layer_spline.h"
#include "softfinger/layer/layer_limits.h"
#include "softfinger/math/always_inline.h"
#include "softfinger/math/dual.h"
#include "softfinger/math/piecewise_polynomial.h"
#include "softfinger/math/plain_functions.h"

/// The bonded layer without units, in plain arithmetic on any kind of number: double, Dual for
/// derivatives, a pack of contacts (plain::Pack).
namespace softfinger {

/// Pieces of the tables below: to ln(R'/R'') = 10, where ln(a/b) is smaller.
constexpr int kShapePieces = 40, kShapeDegree = 8;
/// Table of `LimitShapes` over L = ln(R'/R''). Its aspects are divided by L, so that they vanish
/// with it to the last digit.
using ShapeTable = PiecewisePolynomial<6, kShapePieces, kShapeDegree>;
/// Table of `log_ring_arm` divided by the square of ln(a/b), with which it vanishes.
using RingTable = PiecewisePolynomial<1, kShapePieces, kShapeDegree>;
const ShapeTable& shape_table() noexcept;
const RingTable& ring_table() noexcept;
/// Evaluations without a table, for arguments beyond its end.
LimitShapes limit_slopes_beyond_table(double L) noexcept;
double log_ring_arm_beyond_table(double log_aspect) noexcept;

/// `limit_shapes` at R'/R'' = exp(L) >= 1, by piecewise polynomials to 1e-13; to a ratio of 22,000.
/// Beyond, the exact ones, of which derivatives are differences.
inline LimitShapes tabulated_limit_shapes(double L) noexcept {
  if (L > ShapeTable::kEnd) return limit_shapes(std::exp(L));
  const ShapeTable::Values v = shape_table().value(L);
  return {L, v[0] * L, v[1] * L, v[2], v[3], v[4], v[5]};
}

/// ln of the mean distance of an ellipse's rings from the centre over sqrt(ab),
/// (2/pi) sqrt(a/b) E(m), m = 1 - b²/a², of ln(a/b) >= 0, likewise.
inline double log_ring_arm(double log_aspect) noexcept {
  return log_aspect > RingTable::kEnd ? log_ring_arm_beyond_table(log_aspect)
                                      : log_aspect * log_aspect * ring_table().value(log_aspect)[0];
}
/// Derivative of `log_ring_arm`.
inline double log_ring_arm_slope(double log_aspect) noexcept {
  // E(m) is 1 to 1e-8 beyond.
  if (log_aspect > RingTable::kEnd) return 0.5;
  RingTable::Values slope;
  const double value = ring_table().value(log_aspect, &slope)[0];
  return log_aspect * (2 * value + log_aspect * slope[0]);
}

/// The table's corrections to `layer_blend` (kAspect over ln(R'/R'')).
inline LayerQuantities table_correction(const TableCoordinates& at) noexcept {
  return bonded_layer_spline<false>(at, nullptr);
}

// Overload that carries derivatives.
template <int N>
LimitShapesOf<Dual<N>> tabulated_limit_shapes(const Dual<N>& log_radii_ratio) noexcept {
  const double L = log_radii_ratio.value;
  if (L > ShapeTable::kEnd) {
    const LimitShapes value = limit_shapes(std::exp(L)), slope = limit_slopes_beyond_table(L);
    const auto chain = [&](double LimitShapes::*number) {
      return Dual<N>::chain(log_radii_ratio, value.*number, slope.*number);
    };
    return {log_radii_ratio,
            chain(&LimitShapes::log_hertz_aspect),
            chain(&LimitShapes::log_incompressible_aspect),
            chain(&LimitShapes::log_hertz_depth),
            chain(&LimitShapes::log_incompressible_depth),
            chain(&LimitShapes::log_hertz_size_at_unit_load),
            chain(&LimitShapes::log_incompressible_size_at_unit_load)};
  }
  ShapeTable::Values slope;
  const ShapeTable::Values value = shape_table().value(L, &slope);
  const auto aspect = [&](std::size_t i) {
    return Dual<N>::chain(log_radii_ratio, value[i] * L, value[i] + L * slope[i]);
  };
  const auto chain = [&](std::size_t i) {
    return Dual<N>::chain(log_radii_ratio, value[i], slope[i]);
  };
  return {log_radii_ratio, aspect(0), aspect(1), chain(2), chain(3), chain(4), chain(5)};
}

template <int N>
Dual<N> log_ring_arm(const Dual<N>& log_aspect) noexcept {
  return Dual<N>::chain(log_aspect, log_ring_arm(log_aspect.value),
                        log_ring_arm_slope(log_aspect.value));
}

template <int N>
LayerQuantitiesOf<Dual<N>> table_correction(const TableCoordinatesOf<Dual<N>>& at) noexcept {
  std::array<LayerQuantities, 3> slopes;
  const LayerQuantities value = bonded_layer_spline<true>(
      TableCoordinates{at.log_size.value, at.compressibility.value, at.elongation.value}, &slopes);
  LayerQuantitiesOf<Dual<N>> result;
  for (std::size_t q = 0; q < kLayerQuantities; ++q) {
    result[q].value = value[q];
    for (std::size_t i = 0; i < N; ++i)
      result[q].slope[i] = slopes[0][q] * at.log_size.slope[i] +
                           slopes[1][q] * at.compressibility.slope[i] +
                           slopes[2][q] * at.elongation.slope[i];
  }
  return result;
}

namespace detail {

template <class Real>
SOFTFINGER_ALWAYS_INLINE inline LayerQuantitiesOf<Real> bonded_layer_logarithms(
    const Real& log_load, const Real& poisson_ratio, const Real& log_radii_ratio) noexcept {
  using plain::exp;
  using plain::larger;
  using plain::smaller;
  const Real compressibility = 1. - 2. * poisson_ratio;
  LayerQuantitiesOf<Real> result =
      layer_blend<Real>(tabulated_limit_shapes(log_radii_ratio), log_load, compressibility);
  // Beyond the table the corrections fade in proportion to the size of the contact (small ones) or
  // its inverse (large ones), as the exact deviations from the limits do.
  const Real inside = smaller(larger(result[kSize], kTableLogSizeMin), kTableLogSizeMax);
  const Real outside = result[kSize] - inside;
  const Real fade = exp(outside - 2. * larger(outside, 0));
  const LayerQuantitiesOf<Real> correction =
      table_correction(table_coordinates<Real>(inside, compressibility, log_radii_ratio));
  for (std::size_t q = 0; q < kLayerQuantities; ++q)
    result[q] += q == kAspect ? fade * log_radii_ratio * correction[q] : fade * correction[q];
  return result;
}

}  // namespace detail

/// @param log_load  ln(P R/(E* h³)), R = sqrt(R' R'')
/// @param log_radii_ratio  L = ln(R'/R'') >= 0
template <class Real>
SOFTFINGER_ALWAYS_INLINE inline LayerQuantitiesOf<Real> bonded_layer_logarithms(
    const Real& log_load, const Real& poisson_ratio, const Real& log_radii_ratio) noexcept {
  return detail::bonded_layer_logarithms(log_load, poisson_ratio, log_radii_ratio);
}

/// Overload that carries derivatives: differentiates with respect to these three numbers first,
/// then applies the chain rule, so that the cost hardly depends on N.
template <int N>
SOFTFINGER_ALWAYS_INLINE inline LayerQuantitiesOf<Dual<N>> bonded_layer_logarithms(
    const Dual<N>& log_load, const Dual<N>& poisson_ratio,
    const Dual<N>& log_radii_ratio) noexcept {
  const LayerQuantitiesOf<Dual<3>> by_three = detail::bonded_layer_logarithms(
      Dual<3>::variable(log_load.value, 0), Dual<3>::variable(poisson_ratio.value, 1),
      Dual<3>::variable(log_radii_ratio.value, 2));
  LayerQuantitiesOf<Dual<N>> result;
  for (std::size_t q = 0; q < kLayerQuantities; ++q) {
    const auto& slope = by_three[q].slope;
    result[q].value = by_three[q].value;
    for (int i = 0; i < N; ++i)
      result[q].slope[i] = slope[0] * log_load.slope[i] + slope[1] * poisson_ratio.slope[i] +
                           slope[2] * log_radii_ratio.slope[i];
  }
  return result;
}

}  // namespace softfinger
