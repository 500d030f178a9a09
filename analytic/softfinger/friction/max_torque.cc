#include "softfinger/friction/max_torque.h"

#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/math/elliptic_integrals.h"

namespace softfinger {
namespace {

/// Gamma(z) / Gamma(z + 1/2). Beyond z = 100 by its asymptotic series (the gamma functions
/// themselves would overflow at 171), truncated where the next term is below 1e-16.
double gamma_ratio(double z) {
  if (z < 100) return std::tgamma(z) / std::tgamma(z + 0.5);
  const double w = 1 / z;
  const double series =
      1 + w * (-1.0 / 8 + w * (1.0 / 128 +
                               w * (5.0 / 1024 + w * (-21.0 / 32768 + w * (-399.0 / 262144 +
                                                                           w * 869.0 / 4194304)))));
  return 1 / (std::sqrt(z) * series);
}

/// (n+1) B(3/2, n+1) = Gamma(3/2) Gamma(n+2) / Gamma(n+5/2): the arm of a circle of radius one. The
/// exponents of the named models are written out: they are asked for in inner loops.
double unit_circle_arm(double exponent) {
  if (exponent == 0.5) return 3 * kPi / 16;
  if (exponent == 1.0) return 8.0 / 15;
  if (exponent == 2.0) return 16.0 / 35;
  if (exponent == 0.0) return 2.0 / 3;
  return 0.5 * std::sqrt(kPi) * gamma_ratio(exponent + 2);
}

}  // namespace

double torque_arm_exact_m(double a_m, double b_m, double exponent) noexcept {
  const double aspect = b_m / a_m;
  return a_m * elliptic_integrals(aspect * aspect).E() * (2 / kPi) * unit_circle_arm(exponent);
}

double torque_arm_paper_m(double a_m, double b_m, double exponent) noexcept {
  // The roots apart: the product may underflow.
  return unit_circle_arm(exponent) * (std::sqrt(a_m) * std::sqrt(b_m));
}

}  // namespace softfinger
