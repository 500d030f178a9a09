#include "softfinger/math/hertz_ellipse.h"

#include <cmath>

namespace softfinger {

EllipticIntegrals hertz_ellipse(double radii_ratio) noexcept {
  // In logarithms the relation is close to a straight line (slope -3/4 at the circle, -1 for long
  // ellipses) and monotone, so that Newton's method converges from anywhere; from this start it
  // needs at most three steps.
  constexpr int kMaxIterations = 12;
  constexpr double kTolerance = 1e-7;  // quadratic: the step taken then leaves rounding errors only
  const double log_ratio = std::log(radii_ratio);
  // q D = 1/ratio with D = ln(4) - 1 - ln(q)/2 for long ellipses suggests q = 1/(ratio (1 + f L)),
  // L = ln(ratio), where f grows from 1/3 (slope at the circle) to 1/2 and a little; this f is
  // within 2 % of the solution q.
  const double u = log_ratio / 3.4;
  const double f = 1.0 / 3 + 0.2 * u / std::sqrt(1 + u * u);
  double q = 1 / (radii_ratio * (1 + f * log_ratio));
  for (int iteration = 0;; ++iteration) {
    const EllipticIntegrals integrals = elliptic_integrals(q);
    const double ratio = integrals.B / (q * integrals.D);
    const double residual = std::log(ratio / radii_ratio);
    const double m = 1 - q;
    // d ln(ratio) / d ln(q); its own cancellation near the circle is avoided by its limit there.
    const double slope =
        m < 1e-5 ? -0.75
                 : -1 + (integrals.B / integrals.D - q * integrals.D / integrals.B) / (2 * m);
    q *= std::exp(-residual / slope);
    if (q > 1) q = 1;
    if (std::abs(residual) <= kTolerance || iteration == kMaxIterations)
      return elliptic_integrals(q);
  }
}

}  // namespace softfinger
