#pragma once

#include <array>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/math/dual.h"
#include "softfinger/math/plain_functions.h"

namespace softfinger {

/// Stiffness of a stuck contact (no point slides), its normal pressure unchanged. `Real` is double,
/// a pack of doubles, or a number that carries derivatives (Dual).
template <class Real>
struct StuckStiffnessOf {
  Real torsional_Nm_per_rad{};  ///< k_t: torque about the contact normal per rotation
  Real tangential_x_N_per_m{};  ///< k_x: force along the semi-axis a per displacement
  Real tangential_y_N_per_m{};  ///< k_y: along the semi-axis b
};
using StuckStiffness = StuckStiffnessOf<double>;

/// Polynomials in the coordinates of `StuckBlendOf`: by how much the stiffnesses exceed its sum.
struct StuckStiffnessTable {
  static constexpr int kSizes = 7, kElongations = 5, kPoissons = 3;  ///< powers 0, 1, ...
  /// The torsional stiffness; the mean of the two tangential ones; their half difference over e.
  static constexpr int kFunctions = 3;
  static constexpr int kShapes = kElongations * kFunctions;
  static constexpr int kCount = kPoissons * kSizes * kShapes;

  /// [power of v][power of T][power of e²][function]
  static const double coefficients[kCount];
};

/// A layer that is thick against the contact, exact:
///   k_t = (2 pi G a³/3) [E - 4 nu (1 - m) C] / [B D - nu E C],
///   k_x = 2 pi G a/(K - nu B),  k_y = 2 pi G a/(K - nu D),
/// with the complete elliptic integrals K, E of the parameter m = 1 - b²/a², B = (E - (1 - m) K)/m,
/// D = (K - E)/m, C = (D - B)/m. Circle: 16 G a³/3 and 8 G a/(2 - nu) (Mindlin 1949; the integrals
/// by the traction (1 - r²)^(-1/2) times a constant or a linear function).
///
/// @param a_m, b_m         semi-axes > 0; the formulas hold for b > a as well
/// @param shear_modulus_Pa G > 0
/// @param poisson_ratio    nu, 0 to 1/2
/// K and C by the arithmetic-geometric mean in five steps: exact to 1e-15 for a/b to 1000, to 1e-7
/// to 1e6.
template <class Real>
StuckStiffnessOf<Real> half_space_stuck_stiffness(const Real& a_m, const Real& b_m,
                                                  const Real& shear_modulus_Pa,
                                                  const Real& poisson_ratio) noexcept {
  using plain::sqrt;
  const Real ratio = b_m / a_m, q = ratio * ratio, m = 1. - q;
  // c_n of the mean, c_(n+1) = c_n²/(4 a_(n+1)). Of the sum over 2^n c_n² that gives E, the terms
  // n >= 1 over c_1² give C without the difference of integrals that vanishes at the circle.
  Real mean = 0.5 * (1. + ratio), geometric = sqrt(ratio);
  const Real first_c = 0.5 * (1. - ratio);
  Real c = Real{} + 1., sum = Real{} + 1.;
  double weight = 1;
  for (int step = 0; step < 4; ++step) {
    const Real product = mean * geometric;
    mean = 0.5 * (mean + geometric);
    geometric = sqrt(product);
    c = first_c * c * c / (4. * mean);
    weight *= 2;
    sum = sum + weight * (c * c);
  }
  const Real K = kPi / (mean + geometric);
  const Real C = 0.5 * K * sum / ((1. + ratio) * (1. + ratio));
  const Real B = 0.5 * (K - m * C), D = 0.5 * (K + m * C), E = B + q * D;
  const Real scale = 2 * kPi * (shear_modulus_Pa * a_m);
  return {scale * (1. / 3) * (a_m * a_m) * (E - 4. * poisson_ratio * (q * C)) /
              (B * D - poisson_ratio * (E * C)),
          scale / (K - poisson_ratio * B), scale / (K - poisson_ratio * D)};
}

/// A layer that is thin against the contact, exact: each point of the ellipse is sheared by itself,
///   k_x = k_y = pi a b G/h,  k_t = k_x (a² + b²)/4.
/// Arguments as above, thickness h > 0.
template <class Real>
StuckStiffnessOf<Real> thin_layer_stuck_stiffness(const Real& a_m, const Real& b_m,
                                                  const Real& thickness_m,
                                                  const Real& shear_modulus_Pa) noexcept {
  const Real shift = kPi * shear_modulus_Pa * (a_m * b_m) / thickness_m;
  return {0.25 * shift * (a_m * a_m + b_m * b_m), shift, shift};
}

/// The sum of the two limits, and where the table of corrections to it is read. With s = sqrt(ab)/h
/// and t = s/(s + 3/2), the thin limit of the torsional stiffness is taken times t²: the base is
/// felt to the third order of s in torsion, and to the first order in a shift.
template <class Real>
struct StuckBlendOf {
  StuckStiffnessOf<Real> sum;
  Real torsional_window{}, tangential_window{};  ///< t³ (1 - t) and t (1 - t): zero in both limits
  Real T{};                                      ///< 2 t - 1
  Real e{};                                      ///< (a - b)/(a + b + sqrt(ab))
  Real v{};                                      ///< 5 nu/(4 - 3 nu), 0 to 1
};

/// Arguments as above. The constants in t, e and v by trial: with them few powers suffice.
template <class Real>
StuckBlendOf<Real> stuck_blend(const Real& a_m, const Real& b_m, const Real& thickness_m,
                               const Real& shear_modulus_Pa, const Real& poisson_ratio) noexcept {
  using plain::sqrt;
  const StuckStiffnessOf<Real> thick =
      half_space_stuck_stiffness(a_m, b_m, shear_modulus_Pa, poisson_ratio);
  const StuckStiffnessOf<Real> thin =
      thin_layer_stuck_stiffness(a_m, b_m, thickness_m, shear_modulus_Pa);
  const Real size_m = a_m * sqrt(b_m / a_m), scale_m = 1.5 * thickness_m;
  const Real inverse = 1. / (size_m + scale_m), t = size_m * inverse, t2 = t * t;
  const Real window = t * (scale_m * inverse);
  return {{thick.torsional_Nm_per_rad + t2 * thin.torsional_Nm_per_rad,
           thick.tangential_x_N_per_m + thin.tangential_x_N_per_m,
           thick.tangential_y_N_per_m + thin.tangential_y_N_per_m},
          t2 * window,
          window,
          (size_m - scale_m) * inverse,
          (a_m - b_m) / (a_m + b_m + size_m),
          5. * poisson_ratio / (4. - 3. * poisson_ratio)};
}

/// The table's polynomials there.
template <class Real>
std::array<Real, StuckStiffnessTable::kFunctions> stuck_polynomials(
    const StuckBlendOf<Real>& blend) noexcept {
  using Table = StuckStiffnessTable;
  const Real v2 = blend.v * blend.v, e2 = blend.e * blend.e;
  Real by_shape[Table::kShapes] = {};
  for (int i = Table::kSizes - 1; i >= 0; --i) {
    const double* row = Table::coefficients + i * Table::kShapes;
    constexpr int kNext = Table::kSizes * Table::kShapes;  // the same of the next power of v
    for (int j = 0; j < Table::kShapes; ++j)
      by_shape[j] =
          by_shape[j] * blend.T + (row[j] + (blend.v * row[j + kNext] + v2 * row[j + 2 * kNext]));
  }
  std::array<Real, Table::kFunctions> sum{};
  for (int i = Table::kElongations - 1; i >= 0; --i)
    for (int j = 0; j < Table::kFunctions; ++j)
      sum[j] = sum[j] * e2 + by_shape[i * Table::kFunctions + j];
  return sum;
}

/// Overload that carries derivatives: the polynomials are differentiated with respect to T, v and
/// e² only, and the chain rule gives the rest.
template <int N>
std::array<Dual<N>, StuckStiffnessTable::kFunctions> stuck_polynomials(
    const StuckBlendOf<Dual<N>>& blend) noexcept {
  using Table = StuckStiffnessTable;
  const double T = blend.T.value, v = blend.v.value, v2 = v * v;
  const Dual<N> e2 = blend.e * blend.e;
  double value[Table::kShapes] = {}, by_T[Table::kShapes] = {}, by_v[Table::kShapes] = {};
  for (int i = Table::kSizes - 1; i >= 0; --i) {
    const double* row = Table::coefficients + i * Table::kShapes;
    constexpr int kNext = Table::kSizes * Table::kShapes;
    for (int j = 0; j < Table::kShapes; ++j) {
      by_T[j] = by_T[j] * T + value[j];
      value[j] = value[j] * T + (row[j] + (v * row[j + kNext] + v2 * row[j + 2 * kNext]));
      by_v[j] = by_v[j] * T + (row[j + kNext] + 2 * v * row[j + 2 * kNext]);
    }
  }
  std::array<Dual<N>, Table::kFunctions> sums;
  for (int f = 0; f < Table::kFunctions; ++f) {
    double sum = 0, of_T = 0, of_v = 0, of_e2 = 0;
    for (int i = Table::kElongations - 1; i >= 0; --i) {
      const int j = i * Table::kFunctions + f;
      of_e2 = of_e2 * e2.value + sum;
      sum = sum * e2.value + value[j];
      of_T = of_T * e2.value + by_T[j];
      of_v = of_v * e2.value + by_v[j];
    }
    sums[std::size_t(f)].value = sum;
    for (std::size_t n = 0; n < N; ++n)
      sums[std::size_t(f)].slope[n] =
          of_T * blend.T.slope[n] + of_v * blend.v.slope[n] + of_e2 * e2.slope[n];
  }
  return sums;
}

/// Stiffness of a stuck ellipse on a layer that is bonded to a rigid base, for any thickness: the
/// blend times 1 + window * polynomial (StuckStiffnessTable), laid through 2,160 spectral solutions
/// (stuck_contact.h). The tangential tractions are taken to leave the normal pressure unchanged.
///
/// @param a_m, b_m           semi-axes of the contact > 0; x is along a. Exchanging them exchanges
///                           k_x and k_y.
/// @param thickness_m        h > 0
/// @param youngs_modulus_Pa  E > 0
/// @param poisson_ratio      nu, 0 to 1/2
///
/// Within 0.1 % of the spectral solution for sqrt(ab)/h of 0.005 to 100 and a/b to 20. For smaller
/// and larger contacts it tends to the exact limits. Longer ones: 0.2 % at a/b = 60, 3 % at 100, 10
/// % at 1000 (a few points); always finite. Smooth in all arguments. Plain arithmetic and square
/// roots (found by argument-dependent lookup), no branch, no allocation; below 0.1
/// microseconds.
template <class Real>
StuckStiffnessOf<Real> stuck_stiffness(const Real& a_m, const Real& b_m, const Real& thickness_m,
                                       const Real& youngs_modulus_Pa,
                                       const Real& poisson_ratio) noexcept {
  const Real shear_modulus_Pa = 0.5 * youngs_modulus_Pa / (1. + poisson_ratio);
  const StuckBlendOf<Real> blend =
      stuck_blend(a_m, b_m, thickness_m, shear_modulus_Pa, poisson_ratio);
  const std::array<Real, StuckStiffnessTable::kFunctions> sum = stuck_polynomials(blend);
  const Real difference = blend.e * sum[2];
  return {blend.sum.torsional_Nm_per_rad * (1. + blend.torsional_window * sum[0]),
          blend.sum.tangential_x_N_per_m * (1. + blend.tangential_window * (sum[1] + difference)),
          blend.sum.tangential_y_N_per_m * (1. + blend.tangential_window * (sum[1] - difference))};
}

}  // namespace softfinger
