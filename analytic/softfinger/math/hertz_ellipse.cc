#include "softfinger/math/hertz_ellipse.h"

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"

namespace softfinger {

EllipticIntegrals hertz_ellipse(double radii_ratio) noexcept {
  // In logarithms the relation is close to a straight line (slope -3/4 at the circle, -1 for long
  // ellipses) and monotone, so that Newton's method converges from anywhere; from this start it
  // needs one step, two for the longest ellipses.
  constexpr int kMaxIterations = 12;
  constexpr double kTolerance =
      1e-8;  // the last step changes the integrals linearly, to its square
  const double L = std::log(radii_ratio);
  // q D = 1/ratio with D = ln(4) - 1 - ln(q)/2 for long ellipses suggests q = 1/(ratio (1 + f L)),
  // where f grows from 1/3 (slope at the circle) to 1/2 and a little. Fitted: q within 2e-5 to
  // R'/R'' = 400, within 2e-4 to 5e8.
  const double f = (1.0 / 3 + L * (0.160773 + L * (0.0391611 + L * 0.00679241))) /
                   (1 + L * (0.315772 + L * (0.0653745 + L * 0.0131402)));
  double q = 1 / (radii_ratio * (1 + f * L));
  for (int iteration = 0;; ++iteration) {
    EllipticIntegrals integrals = elliptic_integrals(q);
    const double B = integrals.B, D = integrals.D;
    const double residual = std::log(B / (q * D * radii_ratio));
    const double m = 1 - q;
    // slope = d ln(ratio) / d ln(q) and D_slope = d D / d ln(q). Both are differences of nearly
    // equal numbers near the circle; there their values at the circle are used.
    const bool circle = m < 1e-5;
    const double slope = circle ? -0.75 : -1 + (B / D - q * D / B) / (2 * m);
    const double step = -residual / slope;
    if (std::abs(step) > kTolerance && iteration < kMaxIterations) {
      q = std::min(1.0, q * std::exp(step));
      continue;
    }
    const double D_slope = circle ? -3 * kPi / 32 : (q * D - B) / (2 * m);
    integrals.q = std::min(1.0, q * (1 + step));
    integrals.D += D_slope * step;
    integrals.B -= (0.5 * B + D_slope) * step;  // K = B + D loses B/2 per unit of ln(q)
    return integrals;
  }
}

}  // namespace softfinger
