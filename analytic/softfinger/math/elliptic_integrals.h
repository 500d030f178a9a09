#pragma once

namespace softfinger {

/// Complete elliptic integrals of parameter m = 1 - q, given by the complementary parameter
/// q = b²/a² of an ellipse with semi-axes a >= b.
///
/// Everything that contact mechanics needs is a sum of products of two positive integrals,
///   B = int_0^{pi/2} cos²t / sqrt(1 - m sin²t) dt,   D = int_0^{pi/2} sin²t / sqrt(1 - m sin²t)
///   dt,
/// so that nothing cancels, neither near a circle (where K - E and E - q K vanish like m) nor for
/// extreme elongation (where m rounds to 1).
struct EllipticIntegrals {
  double q = 1;
  double B = 0;  ///< (E - q K) / m, from pi/4 (circle) to 1
  double D = 0;  ///< (K - E) / m, from pi/4 (circle) to ln(4/sqrt q) - 1

  double K() const noexcept { return B + D; }      ///< first kind
  double E() const noexcept { return B + q * D; }  ///< second kind
  double K_minus_E() const noexcept { return (1 - q) * D; }
  double E_minus_qK() const noexcept { return (1 - q) * B; }
};

/// Arithmetic-geometric mean (Bulirsch 1969, "cel" for p = 1, whose coefficients stay positive).
///
/// @param q  complementary parameter, 0 <= q <= 1. Below 1e-300 the value at 1e-300 is taken: K and
///           D grow like -ln(q)/2 without limit, B and E are 1 to the last digit long before.
/// Relative error of B, D, K, E below 1e-14, four to six square roots, more for q < 1e-17 (ten at
/// the end of the range). No allocation, bounded iterations.
EllipticIntegrals elliptic_integrals(double q) noexcept;

}  // namespace softfinger
