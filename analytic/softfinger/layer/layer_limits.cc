#include "softfinger/layer/layer_limits.h"

#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/math/hertz_ellipse.h"

namespace softfinger {
namespace {

constexpr double kLog2 = 0.69314718055994530942;

/// The crossover's scale: at compressibility 1/K the coordinate leaves its linear range.
double crossover(double log_size) noexcept { return 2 + 0.5 * std::exp(2 * log_size); }

constexpr double kElongationScale = 1;  // even in ln(R'/R''), linear for long ellipses

}  // namespace

LimitShapes limit_shapes(double radii_ratio) noexcept {
  LimitShapes shapes;
  const double L = std::log(radii_ratio);
  shapes.log_radii_ratio = L;

  // Hertz with R = E* = 1: a³ = 3 P R' D/pi, d = 3 P K/(2 pi a), so d/(ab) = K/(2 R' D q^(1/2)).
  const EllipticIntegrals integrals = hertz_ellipse(radii_ratio);
  const double log_q = std::log(integrals.q);
  shapes.log_aspect[0] = -0.5 * log_q;
  shapes.log_depth[0] = std::log(integrals.K() / (2 * integrals.D)) - 0.5 * (L + log_q);
  shapes.log_hertz_size_at_unit_load =
      (std::log(3 * integrals.D / kPi) + 0.5 * L) / 3 + 0.25 * log_q;

  // Winkler: ab = 2 d.
  shapes.log_aspect[1] = 0.5 * L;
  shapes.log_depth[1] = -kLog2;

  // p = p0 (1 - r²)², (4/3) lap p = gap - d: with A = 1/a², B = 1/b², t = B/A:
  // R'/R'' = t (3t + 1)/(t + 3), d = (16/3) p0 (A + B), 1/2 = (16/3) p0 sqrt(AB (3A+B) (3B+A)).
  // In k = sqrt(R'/R'') so that nothing overflows: t/k = [(k - 1/k) + sqrt((k - 1/k)² + 36)]/6.
  const double k = std::sqrt(radii_ratio), c = k - 1 / k;
  const double t = k * (c + std::sqrt(c * c + 36)) / 6;
  const double e = std::sqrt(t);
  shapes.log_aspect[2] = 0.5 * std::log(t);
  // (3A + B)(3B + A) ab ab = (3/e + e)(3e + 1/e)
  const double product = (3 / e + e) * (3 * e + 1 / e);
  shapes.log_depth[2] = std::log((e + 1 / e) / (2 * std::sqrt(product)));
  shapes.log_incompressible_size_at_unit_load =
      std::log(32 / kPi * std::sqrt(product)) / 6;  // P = (pi/32) s⁶/sqrt(product)
  return shapes;
}

LayerBlend layer_blend(const LimitShapes& shapes, double log_load,
                       double compressibility) noexcept {
  constexpr double k = kThickThinExponent, n = kThinExponent;
  constexpr double kHertz = 1.0 / 3, kWinkler = 1.0 / 4, kIncompressible = 1.0 / 6;
  const double log_hertz = shapes.log_hertz_size_at_unit_load + kHertz * log_load;
  const double log_incompressible =
      shapes.log_incompressible_size_at_unit_load + kIncompressible * log_load;
  // s⁴ = 4 P/(pi M/E*), M/E* = (1 - nu)²/(1 - 2 nu); zero at nu = 1/2
  const double one_minus_nu = 0.5 * (1 + compressibility);
  const double log_winkler =
      0.25 * (log_load + std::log(4 / kPi * compressibility / (one_minus_nu * one_minus_nu)));

  // Weights of the limits in a blended size are its derivatives with respect to theirs.
  const double winkler_in_thin = 1 / (1 + std::exp(n * (log_incompressible - log_winkler)));
  const double incompressible_in_thin = 1 / (1 + std::exp(n * (log_winkler - log_incompressible)));
  const double log_thin = winkler_in_thin > 0.5
                              ? log_winkler - std::log1p(-incompressible_in_thin) / n
                              : log_incompressible - std::log1p(-winkler_in_thin) / n;
  const double thick = 1 / (1 + std::exp(k * (log_hertz - log_thin)));
  const double thin = 1 / (1 + std::exp(k * (log_thin - log_hertz)));
  const double log_size =
      thick > 0.5 ? log_hertz + std::log1p(-thin) / k : log_thin + std::log1p(-thick) / k;

  const double w[3] = {thick, thin * winkler_in_thin, thin * incompressible_in_thin};
  const double size_slope = kHertz * w[0] + kWinkler * w[1] + kIncompressible * w[2];
  const double thin_slope = kWinkler * winkler_in_thin + kIncompressible * incompressible_in_thin;
  const double thick_change = -k * thick * thin * (kHertz - thin_slope);
  const double winkler_change =
      n * winkler_in_thin * incompressible_in_thin * (kWinkler - kIncompressible);
  const double dw[3] = {thick_change, -thick_change * winkler_in_thin + thin * winkler_change,
                        -thick_change * incompressible_in_thin - thin * winkler_change};

  // ln of 3 pi/16, 8/15, 16/35 and of 3/2, 2, 3
  constexpr std::array<double, 3> kLogArm{-0.5292465477222714, -0.6286086594223742,
                                          -0.7827593392496325};
  constexpr std::array<double, 3> kLogPeak{0.40546510810816438, 0.69314718055994531,
                                           1.09861228866810969};
  LayerBlend blend;
  blend.value[kSize] = log_size;
  blend.slope[kSize] = size_slope;
  const auto mix = [&](LayerQuantity quantity, const std::array<double, 3>& limits) {
    blend.value[quantity] = w[0] * limits[0] + w[1] * limits[1] + w[2] * limits[2];
    blend.slope[quantity] = dw[0] * limits[0] + dw[1] * limits[1] + dw[2] * limits[2];
  };
  mix(kAspect, shapes.log_aspect);
  mix(kDepth, shapes.log_depth);
  mix(kArm, kLogArm);
  mix(kPeak, kLogPeak);
  return blend;
}

TableCoordinates table_coordinates(double log_size, double compressibility,
                                   double log_radii_ratio) noexcept {
  const double K = crossover(log_size), dK = 2 * (K - 2);
  const double numerator = std::log1p(compressibility * K), denominator = std::log1p(K);
  const double coordinate = numerator / denominator;
  const double slope =
      (compressibility / (1 + compressibility * K) - coordinate / (1 + K)) * dK / denominator;
  // sqrt(L² + 1) - 1 without its cancellation
  const double L2 = log_radii_ratio * log_radii_ratio;
  constexpr double kScale2 = kElongationScale * kElongationScale;
  return {log_size, coordinate, L2 / (std::sqrt(L2 + kScale2) + kElongationScale), slope};
}

double compressibility_at(double log_size, double coordinate) noexcept {
  const double K = crossover(log_size);
  return std::expm1(coordinate * std::log1p(K)) / K;
}

double log_radii_ratio_at(double elongation) noexcept {
  return std::sqrt(elongation * (elongation + 2 * kElongationScale));
}

}  // namespace softfinger
