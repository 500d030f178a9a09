#pragma once

#include <algorithm>
#include <array>

#include "softfinger/layer/bonded_layer_table.h"

namespace softfinger {

/// Weights of the four cubic B-splines that are not zero at a place, and their derivatives.
struct SplineWeights {
  int first = 0;
  double weight[4] = {};
  double slope[4] = {};

  /// `coordinate` in [lowest, highest] with `knots` equidistant knots.
  SplineWeights(double coordinate, double lowest, double highest, int knots) noexcept {
    const double inverse_spacing = (knots - 1) / (highest - lowest);
    const double t = (coordinate - lowest) * inverse_spacing;
    // Written so that a value that is not a number gives the first interval.
    first = t >= 0 ? int(std::min(t, double(knots - 2))) : 0;
    const double f = t - first, g = 1 - f;
    weight[0] = g * g * g * (1.0 / 6);
    weight[1] = 2.0 / 3 - f * f * (1 - 0.5 * f);
    weight[2] = 2.0 / 3 - g * g * (1 - 0.5 * g);
    weight[3] = f * f * f * (1.0 / 6);
    slope[0] = -0.5 * g * g * inverse_spacing;
    slope[1] = -f * (2 - 1.5 * f) * inverse_spacing;
    slope[2] = g * (2 - 1.5 * g) * inverse_spacing;
    slope[3] = 0.5 * f * f * inverse_spacing;
  }
};

/// The coefficients of the four sizes at one compressibility and elongation: one after the other.
constexpr int kRow = 4 * kLayerQuantities;

/// The table's corrections to `layer_blend`, and their derivatives with respect to the coordinates.
template <bool kWithSlopes>
inline LayerQuantities bonded_layer_spline(const TableCoordinates& at,
                                           std::array<LayerQuantities, 3>* slopes) noexcept {
  const SplineWeights size(at.log_size, kTableLogSizeMin, kTableLogSizeMax,
                           BondedLayerTable::kSizeKnots);
  const SplineWeights soft(at.compressibility, 0, 1, BondedLayerTable::kCompressibilityKnots);
  // Longer ellipses get the corrections of the longest in the table.
  const bool longest = at.elongation > BondedLayerTable::kElongationMax;
  const SplineWeights ratio(longest ? BondedLayerTable::kElongationMax : at.elongation, 0,
                            BondedLayerTable::kElongationMax, BondedLayerTable::kElongationKnots);
  constexpr int kLine = BondedLayerTable::kSizes * kLayerQuantities;
  const float* row = BondedLayerTable::coefficients +
                     (soft.first * BondedLayerTable::kElongations + ratio.first) * kLine +
                     size.first * kLayerQuantities;
  // Sums over compressibilities and elongations. A few coefficients at a time, because the sums of
  // all would not stay in registers.
  constexpr int kPart = 4;
  static_assert(kRow % kPart == 0);
  double sums[kRow], soft_sums[kRow], ratio_sums[kRow];
  for (int first = 0; first < kRow; first += kPart) {
    double sum[kPart] = {}, soft_sum[kPart] = {}, ratio_sum[kPart] = {};
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j) {
        const float* part = row + (i * BondedLayerTable::kElongations + j) * kLine + first;
        const double weight = soft.weight[i] * ratio.weight[j];
        const double soft_slope = soft.slope[i] * ratio.weight[j];
        const double ratio_slope = soft.weight[i] * ratio.slope[j];
        for (int k = 0; k < kPart; ++k) {
          const double coefficient = part[k];
          sum[k] += weight * coefficient;
          if (!kWithSlopes) continue;
          soft_sum[k] += soft_slope * coefficient;
          ratio_sum[k] += ratio_slope * coefficient;
        }
      }
    for (int k = 0; k < kPart; ++k) {
      sums[first + k] = sum[k];
      if (!kWithSlopes) continue;
      soft_sums[first + k] = soft_sum[k];
      ratio_sums[first + k] = ratio_sum[k];
    }
  }
  // Then over sizes.
  const auto over_sizes = [](const double(&weights)[4], const double* of) {
    LayerQuantities sum;
    for (std::size_t q = 0; q < kLayerQuantities; ++q)
      sum[q] = (weights[0] * of[q] + weights[1] * of[q + kLayerQuantities] +
                (weights[2] * of[q + 2 * kLayerQuantities] +
                 weights[3] * of[q + 3 * kLayerQuantities])) *
               BondedLayerTable::unit[q];
    return sum;
  };
  if (kWithSlopes) {
    (*slopes)[0] = over_sizes(size.slope, sums);
    (*slopes)[1] = over_sizes(size.weight, soft_sums);
    (*slopes)[2] = longest ? LayerQuantities{} : over_sizes(size.weight, ratio_sums);
  }
  return over_sizes(size.weight, sums);
}

}  // namespace softfinger
