#pragma once

#include <algorithm>
#include <array>

#include "softfinger/layer/layer_limits.h"
#include "softfinger/math/dual.h"
#include "softfinger/math/plain_functions.h"

/// The bonded layer without units, in plain arithmetic on any kind of number: double, Dual for
/// derivatives, a pack of contacts (plain::Pack).
namespace softfinger {

/// `limit_shapes` at R'/R'' = exp(L) >= 1, by piecewise polynomials to 1e-13; to a ratio of 22,000.
/// Beyond, the exact ones, of which derivatives are differences.
LimitShapes tabulated_limit_shapes(double L) noexcept;
/// Their derivatives with respect to L.
LimitShapes tabulated_limit_slopes(double L) noexcept;

/// ln of the mean distance of an ellipse's rings from the centre over sqrt(ab),
/// (2/pi) sqrt(a/b) E(m), m = 1 - b²/a², of ln(a/b) >= 0, likewise.
double log_ring_arm(double log_aspect) noexcept;
double log_ring_arm_slope(double log_aspect) noexcept;

/// The table's corrections to `layer_blend` (kAspect over ln(R'/R'')).
LayerQuantities table_correction(const TableCoordinates& at) noexcept;
/// The same, with the derivatives with respect to the three coordinates.
LayerQuantities table_correction(const TableCoordinates& at,
                                 std::array<LayerQuantities, 3>* slopes) noexcept;

// The same with derivatives.
template <int N>
LimitShapesOf<Dual<N>> tabulated_limit_shapes(const Dual<N>& log_radii_ratio) noexcept {
  const LimitShapes value = tabulated_limit_shapes(log_radii_ratio.value);
  const LimitShapes slope = tabulated_limit_slopes(log_radii_ratio.value);
  LimitShapesOf<Dual<N>> result;
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

template <int N>
Dual<N> log_ring_arm(const Dual<N>& log_aspect) noexcept {
  return Dual<N>::chain(log_aspect, log_ring_arm(log_aspect.value),
                        log_ring_arm_slope(log_aspect.value));
}

template <int N>
LayerQuantitiesOf<Dual<N>> table_correction(const TableCoordinatesOf<Dual<N>>& at) noexcept {
  std::array<LayerQuantities, 3> slopes;
  const LayerQuantities value = table_correction(
      TableCoordinates{at.log_size.value, at.compressibility.value, at.elongation.value}, &slopes);
  LayerQuantitiesOf<Dual<N>> result;
  for (std::size_t q = 0; q < kLayerQuantities; ++q)
    result[q] = Dual<N>::chain(at.log_size, value[q], slopes[0][q]) +
                Dual<N>::chain(at.compressibility, 0, slopes[1][q]) +
                Dual<N>::chain(at.elongation, 0, slopes[2][q]);
  return result;
}

namespace detail {

template <class Real>
LayerQuantitiesOf<Real> bonded_layer_logarithms(const Real& log_load, const Real& poisson_ratio,
                                                const Real& log_radii_ratio) noexcept {
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
LayerQuantitiesOf<Real> bonded_layer_logarithms(const Real& log_load, const Real& poisson_ratio,
                                                const Real& log_radii_ratio) noexcept {
  return detail::bonded_layer_logarithms(log_load, poisson_ratio, log_radii_ratio);
}

/// With derivatives: first by these three numbers only, however many they depend on themselves.
template <int N>
LayerQuantitiesOf<Dual<N>> bonded_layer_logarithms(const Dual<N>& log_load,
                                                   const Dual<N>& poisson_ratio,
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
