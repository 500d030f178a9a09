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

/// Sums of four lines of the table: those of the four elongations, weighted.
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
  LayerQuantities sum{}, by_size{}, by_soft{}, by_ratio{};
  for (int i = 0; i < 4; ++i) {
    double row[kRow] = {}, ratio_row[kRow] = {};
    const std::int16_t* plane = BondedLayerTable::coefficients +
                                ((soft.first + i) * BondedLayerTable::kElongations + ratio.first) *
                                    BondedLayerTable::kSizes * kLayerQuantities +
                                size.first * kLayerQuantities;
    for (int j = 0; j < 4; ++j) {
      const std::int16_t* line = plane + j * BondedLayerTable::kSizes * kLayerQuantities;
      for (int k = 0; k < kRow; ++k) {
        row[k] += ratio.weight[j] * line[k];
        if (kWithSlopes) ratio_row[k] += ratio.slope[j] * line[k];
      }
    }
    for (int k = 0; k < 4; ++k)
      for (std::size_t q = 0; q < kLayerQuantities; ++q) {
        const double value = row[k * kLayerQuantities + int(q)];
        sum[q] += soft.weight[i] * size.weight[k] * value;
        if (!kWithSlopes) continue;
        by_size[q] += soft.weight[i] * size.slope[k] * value;
        by_soft[q] += soft.slope[i] * size.weight[k] * value;
        by_ratio[q] += soft.weight[i] * size.weight[k] * ratio_row[k * kLayerQuantities + int(q)];
      }
  }
  for (std::size_t q = 0; q < kLayerQuantities; ++q) {
    sum[q] *= BondedLayerTable::unit[q];
    if (!kWithSlopes) continue;
    (*slopes)[0][q] = by_size[q] * BondedLayerTable::unit[q];
    (*slopes)[1][q] = by_soft[q] * BondedLayerTable::unit[q];
    (*slopes)[2][q] = longest ? 0 : by_ratio[q] * BondedLayerTable::unit[q];
  }
  return sum;
}

}  // namespace softfinger
