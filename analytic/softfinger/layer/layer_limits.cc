#include "softfinger/layer/layer_limits.h"

#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/math/hertz_ellipse.h"

namespace softfinger {

LimitShapes limit_shapes(double radii_ratio) noexcept {
  LimitShapes shapes;
  const double L = std::log(radii_ratio);
  shapes.log_radii_ratio = L;

  // Hertz with R = E* = 1: a³ = 3 P R' D/pi, d = 3 P K/(2 pi a), so d/(ab) = K/(2 R' D q^(1/2)).
  const EllipticIntegrals integrals = hertz_ellipse(radii_ratio);
  const double log_q = std::log(integrals.q);
  shapes.log_hertz_aspect = -0.5 * log_q;
  shapes.log_hertz_depth = std::log(integrals.K() / (2 * integrals.D)) - 0.5 * (L + log_q);
  shapes.log_hertz_size_at_unit_load =
      (std::log(3 * integrals.D / kPi) + 0.5 * L) / 3 + 0.25 * log_q;

  // p = p0 (1 - r²)², (4/3) lap p = gap - d: with A = 1/a², B = 1/b², t = B/A:
  // R'/R'' = t (3t + 1)/(t + 3), d = (16/3) p0 (A + B), 1/2 = (16/3) p0 sqrt(AB (3A+B) (3B+A)).
  // In k = sqrt(R'/R'') so that nothing overflows: t/k = [(k - 1/k) + sqrt((k - 1/k)² + 36)]/6.
  const double k = std::sqrt(radii_ratio), c = k - 1 / k;
  const double t = k * (c + std::sqrt(c * c + 36)) / 6;
  const double e = std::sqrt(t);
  shapes.log_incompressible_aspect = 0.5 * std::log(t);
  // (3A + B)(3B + A) ab ab = (3/e + e)(3e + 1/e)
  const double product = (3 / e + e) * (3 * e + 1 / e);
  shapes.log_incompressible_depth = std::log((e + 1 / e) / (2 * std::sqrt(product)));
  shapes.log_incompressible_size_at_unit_load =
      std::log(32 / kPi * std::sqrt(product)) / 6;  // P = (pi/32) s⁶/sqrt(product)
  return shapes;
}

double compressibility_at(double log_size, double coordinate) noexcept {
  const double K = 2 + 0.5 * std::exp(2 * log_size);
  return std::expm1(coordinate * std::log1p(K)) / K;
}

double log_radii_ratio_at(double elongation) noexcept {
  return std::sqrt(elongation * (elongation + 2));
}

}  // namespace softfinger
