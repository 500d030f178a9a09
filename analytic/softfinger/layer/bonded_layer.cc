#include "softfinger/layer/bonded_layer.h"

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/layer/bonded_layer_table.h"
#include "softfinger/math/elliptic_integrals.h"

namespace softfinger {
namespace {

using Table = BondedLayerTable;

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

struct Correction {
  LayerQuantities value{};
  LayerQuantities slope{};  ///< with respect to the blend's log_size
};

template <bool kWithSlope>
Correction correction(double log_size, double compressibility, double log_radii_ratio) noexcept {
  const double inside = std::max(kTableLogSizeMin, std::min(log_size, kTableLogSizeMax));
  const TableCoordinates at = table_coordinates(inside, compressibility, log_radii_ratio);
  const SplineWeights size(at.log_size, kTableLogSizeMin, kTableLogSizeMax, Table::kSizeKnots);
  const SplineWeights soft(at.compressibility, 0, 1, Table::kCompressibilityKnots);
  const SplineWeights ratio(std::min(at.elongation, Table::kElongationMax), 0,
                            Table::kElongationMax, Table::kElongationKnots);
  double sum[kLayerQuantities] = {}, size_sum[kLayerQuantities] = {},
         soft_sum[kLayerQuantities] = {};
  for (int i = 0; i < 4; ++i) {
    double row[4 * kLayerQuantities] = {};
    const std::int16_t* plane =
        Table::coefficients +
        ((soft.first + i) * Table::kElongations + ratio.first) * Table::kSizes * kLayerQuantities +
        size.first * kLayerQuantities;
    for (int j = 0; j < 4; ++j) {
      const std::int16_t* line = plane + j * Table::kSizes * kLayerQuantities;
      for (int k = 0; k < 4 * kLayerQuantities; ++k) row[k] += ratio.weight[j] * line[k];
    }
    for (int k = 0; k < 4; ++k)
      for (int q = 0; q < kLayerQuantities; ++q) {
        const double value = row[k * kLayerQuantities + q];
        sum[q] += soft.weight[i] * size.weight[k] * value;
        if (kWithSlope) {
          size_sum[q] += soft.weight[i] * size.slope[k] * value;
          soft_sum[q] += soft.slope[i] * size.weight[k] * value;
        }
      }
  }
  Correction result;
  // Beyond the table the corrections fade in proportion to the size of the contact (small ones) or
  // its inverse (large ones), as the exact deviations from the limits do.
  const double outside = log_size - inside;
  const double fade = outside == 0 ? 1 : std::exp(-std::abs(outside));
  for (std::size_t q = 0; q < kLayerQuantities; ++q) {
    const double scale = Table::unit[q] * fade * (q == kAspect ? log_radii_ratio : 1);
    result.value[q] = scale * sum[q];
    if (kWithSlope)
      result.slope[q] = outside == 0
                            ? scale * (size_sum[q] + at.compressibility_slope * soft_sum[q])
                            : (outside > 0 ? -1 : 1) * result.value[q];
  }
  return result;
}

/// The logarithms of LayerQuantities and their derivatives with respect to ln P.
struct Evaluation {
  LayerQuantities value{};
  LayerQuantities slope{};
};

template <bool kWithSlope>
Evaluation evaluate(const RelativeRadii& radii, const ElasticLayer& layer,
                    double normal_force_N) noexcept {
  const double h = layer.thickness_m;
  const double mean_radius = std::sqrt(radii.major_m) * std::sqrt(radii.minor_m);
  const double log_load =
      std::log(normal_force_N / layer.plane_strain_modulus_Pa() / h / h * (mean_radius / h));
  const double compressibility = 1 - 2 * layer.poisson_ratio;
  const LimitShapes shapes = limit_shapes(radii.major_m / radii.minor_m);
  const LayerBlend blend = layer_blend(shapes, log_load, compressibility);
  const Correction correct =
      correction<kWithSlope>(blend.value[kSize], compressibility, shapes.log_radii_ratio);
  Evaluation result;
  for (std::size_t q = 0; q < kLayerQuantities; ++q) {
    result.value[q] = blend.value[q] + correct.value[q];
    if (kWithSlope) result.slope[q] = blend.slope[q] + correct.slope[q] * blend.slope[kSize];
  }
  return result;
}

/// The ellipse and its complete elliptic integral E(m), m = 1 - b²/a².
BondedLayerContact contact_of(const Evaluation& evaluation, const RelativeRadii& radii,
                              const ElasticLayer& layer, double normal_force_N,
                              EllipticIntegrals* integrals) noexcept {
  const LayerQuantities& value = evaluation.value;
  const double aspect_root = std::exp(0.5 * value[kAspect]);
  const double size_m = layer.thickness_m * std::exp(value[kSize]);
  BondedLayerContact contact;
  contact.a_m = size_m * aspect_root;
  contact.b_m = size_m / aspect_root;
  const double area = contact.a_m * contact.b_m;
  contact.indentation_m = contact.a_m / std::sqrt(radii.major_m) *
                          (contact.b_m / std::sqrt(radii.minor_m)) * std::exp(value[kDepth]);
  contact.peak_pressure_Pa = normal_force_N / (kPi * area) * std::exp(value[kPeak]);
  const double arm_factor = std::exp(value[kArm]);
  const double aspect2 = aspect_root * aspect_root;
  *integrals = elliptic_integrals(1 / (aspect2 * aspect2));
  contact.torque_arm_exact_m = contact.a_m * integrals->E() * (2 / kPi) * arm_factor;
  contact.torque_arm_paper_m = size_m * arm_factor;
  return contact;
}

}  // namespace

BondedLayerContact bonded_layer_contact(const RelativeRadii& radii, const ElasticLayer& layer,
                                        double normal_force_N) noexcept {
  EllipticIntegrals integrals;
  return contact_of(evaluate<false>(radii, layer, normal_force_N), radii, layer, normal_force_N,
                    &integrals);
}

BondedLayerSensitivity bonded_layer_sensitivity(const RelativeRadii& radii,
                                                const ElasticLayer& layer,
                                                double normal_force_N) noexcept {
  const Evaluation evaluation = evaluate<true>(radii, layer, normal_force_N);
  EllipticIntegrals integrals;
  const BondedLayerContact contact =
      contact_of(evaluation, radii, layer, normal_force_N, &integrals);
  const LayerQuantities& slope = evaluation.slope;
  // d ln E(m) / d ln(a/b) = -q (K - E)/(m E) = -q D/E
  const double log_arm = slope[kSize] + 0.5 * slope[kAspect] + slope[kArm] -
                         slope[kAspect] * integrals.q * integrals.D / integrals.E();
  BondedLayerSensitivity result;
  result.area_m2_per_N = kPi * contact.a_m * contact.b_m * 2 * slope[kSize] / normal_force_N;
  result.indentation_m_per_N =
      contact.indentation_m * (2 * slope[kSize] + slope[kDepth]) / normal_force_N;
  result.torque_arm_m_per_N = contact.torque_arm_exact_m * log_arm / normal_force_N;
  return result;
}

}  // namespace softfinger
