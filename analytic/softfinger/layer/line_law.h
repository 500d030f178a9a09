#pragma once

#include "softfinger/layer/bonded_layer_spline.h"
#include "softfinger/math/dual.h"
#include "softfinger/math/plain_functions.h"

/// Internal to `line_layer`: a rigid cylinder on a bonded layer in plane strain (line_contact.h) in
/// closed form, on numbers and on numbers with derivatives. Everything depends on the load and on
/// nu alone, without units.
namespace softfinger {

/// kWidth:  ln(b/h)
/// kApproach: ln(d R/b²): grows like the logarithm of h/b (Hertz), 1/2 (Winkler), 1/6 (thin
///            incompressible)
/// kCrest:  ln(p(0) b/P'): 2/pi, 3/4, 15/16
/// kSpread: ln(int x² p dx/(P' b²)): 1/4, 1/5, 1/7
enum LineQuantity { kWidth, kApproach, kCrest, kSpread, kLineQuantities };
template <class Real>
using LineQuantities = std::array<Real, kLineQuantities>;

/// b/h that the table below covers.
constexpr double kNarrowestLine = 0.02, kWidestLine = 50;

/// Tensor cubic B-spline of the corrections to `line_blend`, over ln(b/h) of the blend and the
/// measure of compressibility that `table_coordinates` has. Equidistant knots, one coefficient more
/// than knots on either side: [compressibility][width][quantity].
struct LineTable {
  static constexpr int kWidthKnots = 29, kSoftKnots = 12;
  static constexpr int kWidths = kWidthKnots + 2, kSofts = kSoftKnots + 2;
  static constexpr double kLogWidthMin = -3.95, kLogWidthMax = 3.95;
  static const double coefficients[kSofts * kWidths * kLineQuantities];
};

/// Smooth blend of the exact limits: Hertz's line, b² = 4 P' R/(pi E*); the thin compressible
/// layer, P' = 2 M b³/(3 R h), M = E (1 - nu)/((1 + nu) (1 - 2 nu)); and the thin incompressible
/// one, p = E* (b² - x²)²/(32 h³ R), P' = E* b⁵/(30 h³ R) (K. L. Johnson, Contact Mechanics,
/// sections 4.2 and 5.8).
/// @param log_load  ln(P' R/(E* h²))
/// @param compressibility  1 - 2 nu in [0, 1]
template <class Real>
LineQuantities<Real> line_blend(const Real& log_load, const Real& compressibility) noexcept {
  using plain::exp;
  using plain::log;
  constexpr double kLogFourOverPi = 0.24156447527049046, kLog30 = 3.4011973816621555;
  const Real log_hertz = 0.5 * (log_load + kLogFourOverPi);
  const Real log_incompressible = 0.2 * (log_load + kLog30);
  // b³ of the compressible layer over that of the incompressible one, zero at nu = 1/2.
  const Real one_minus_nu = 0.5 * (1. + compressibility);
  const Real softness = 1.5 * compressibility / (one_minus_nu * one_minus_nu) *
                        exp(log_load - 3. * log_incompressible);
  const Real of_incompressible = 1. / (1. + softness), of_compressible = 1. - of_incompressible;
  const Real log_thin = log_incompressible + log(1. + softness) * (1. / 3);
  const Real thick_to_thin = exp(kThickThinExponent * (log_hertz - log_thin));
  const Real thick = 1. / (1. + thick_to_thin), thin = 1. - thick;
  constexpr double kLogHertzCrest = -0.45158270528945486, kLogWinklerCrest = -0.2876820724517809,
                   kLogIncompressibleCrest = -0.06453852113757118;
  constexpr double kLogQuarter = -1.3862943611198906, kLogFifth = -1.6094379124341003,
                   kLogSeventh = -1.9459101090932196;
  constexpr double kLogHalf = -0.6931471805599453, kLogSixth = -1.791759469228055;
  const auto mix = [&](const Real& of_thick, double compressible, double incompressible) {
    return thick * of_thick +
           thin * (of_compressible * compressible + of_incompressible * incompressible);
  };
  LineQuantities<Real> blend;
  blend[kWidth] = log_hertz - log(1. + thick_to_thin) * (1 / kThickThinExponent);
  // The approach of a narrow line grows like ln(4 h/b)/2.
  const Real hertz_approach = log(0.5 * log(1. + 4. * exp(-blend[kWidth])));
  blend[kApproach] = mix(hertz_approach, kLogHalf, kLogSixth);
  blend[kCrest] = mix(Real{} + kLogHertzCrest, kLogWinklerCrest, kLogIncompressibleCrest);
  blend[kSpread] = mix(Real{} + kLogQuarter, kLogFifth, kLogSeventh);
  return blend;
}

/// The table's corrections there, and their slopes by both coordinates.
inline LineQuantities<double> line_correction(double log_width, double softness,
                                              LineQuantities<double>* by_width,
                                              LineQuantities<double>* by_softness) noexcept {
  const SplineWeights wide(log_width, LineTable::kLogWidthMin, LineTable::kLogWidthMax,
                           LineTable::kWidthKnots);
  const SplineWeights soft(softness, 0, 1, LineTable::kSoftKnots);
  LineQuantities<double> sum{};
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const double* at = LineTable::coefficients +
                         ((soft.first + i) * LineTable::kWidths + wide.first + j) * kLineQuantities;
      for (std::size_t q = 0; q < kLineQuantities; ++q) {
        sum[q] += soft.weight[i] * wide.weight[j] * at[q];
        (*by_width)[q] += soft.weight[i] * wide.slope[j] * at[q];
        (*by_softness)[q] += soft.slope[i] * wide.weight[j] * at[q];
      }
    }
  return sum;
}
template <int N>
LineQuantities<Dual<N>> line_correction(const Dual<N>& log_width,
                                        const Dual<N>& softness) noexcept {
  LineQuantities<double> by_width{}, by_softness{};
  const LineQuantities<double> value =
      line_correction(log_width.value, softness.value, &by_width, &by_softness);
  LineQuantities<Dual<N>> result;
  for (std::size_t q = 0; q < kLineQuantities; ++q) {
    result[q].value = value[q];
    for (std::size_t i = 0; i < N; ++i)
      result[q].slope[i] = by_width[q] * log_width.slope[i] + by_softness[q] * softness.slope[i];
  }
  return result;
}

/// The contact at a load. Within 0.1 % of the exact solution (line_contact.h) in b, d, peak and
/// spread for b/h from 0.02 to 50 and any nu; beyond, the corrections stay those of the end.
template <int N>
LineQuantities<Dual<N>> line_logarithms(const Dual<N>& log_load,
                                        const Dual<N>& compressibility) noexcept {
  LineQuantities<Dual<N>> result = line_blend(log_load, compressibility);
  const Dual<N> inside =
      smaller(larger(result[kWidth], LineTable::kLogWidthMin), LineTable::kLogWidthMax);
  const TableCoordinatesOf<Dual<N>> at =
      table_coordinates<Dual<N>>(inside, compressibility, Dual<N>());
  const LineQuantities<Dual<N>> correction = line_correction(inside, at.compressibility);
  for (std::size_t q = 0; q < kLineQuantities; ++q) result[q] += correction[q];
  return result;
}

}  // namespace softfinger
