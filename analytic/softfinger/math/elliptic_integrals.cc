#include "softfinger/math/elliptic_integrals.h"

#include <algorithm>
#include <cmath>

namespace softfinger {

EllipticIntegrals elliptic_integrals(double q) noexcept {
  constexpr double kHalfPi = 1.57079632679489661923;
  // The mean converges quadratically: once its two arguments differ by sqrt(epsilon), the step just
  // taken was exact to epsilon.
  constexpr double kConverged = 1e-8;
  // The exponent of the ratio of the arguments halves in each step: 13 suffice for q = 1e-300.
  constexpr int kMaxIterations = 16;

  double qc = std::sqrt(std::clamp(q, 1e-300, 1.0));
  double em = 1, p = 1, e = qc;
  // (A, C) are Bulirsch's (a, b): A cos² + C sin² in the numerator.
  double A_of_B = 1, C_of_B = 0;
  double A_of_D = 0, C_of_D = 1;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const double inverse_p = 1 / p;
    const double g = e * inverse_p;
    const double previous_B = A_of_B, previous_D = A_of_D;
    A_of_B += C_of_B * inverse_p;
    A_of_D += C_of_D * inverse_p;
    C_of_B = 2 * (C_of_B + previous_B * g);
    C_of_D = 2 * (C_of_D + previous_D * g);
    p += g;
    const double larger = em;
    em += qc;
    if (std::abs(larger - qc) <= kConverged * larger) break;
    qc = 2 * std::sqrt(e);
    e = qc * em;
  }
  const double scale = kHalfPi / (em * (em + p));
  return {q, scale * (C_of_B + A_of_B * em), scale * (C_of_D + A_of_D * em)};
}

}  // namespace softfinger
