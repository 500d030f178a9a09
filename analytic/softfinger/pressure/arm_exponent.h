#pragma once

#include "softfinger/input/constants.h"
#include "softfinger/math/plain_functions.h"

namespace softfinger {

/// n + 1 of a pressure (1 - r²)^n on a circle of radius one with this torque arm,
/// A = (n+1) B(3/2, n+1). With x = pi/(4 A²), which is (Gamma(n + 5/2)/Gamma(n + 2))²,
///   n + 7/4 = x - N(1/x²)/(32 x),
/// the asymptotic series, its later terms in N, a ratio of polynomials. Off by less than 2e-8 for n
/// above -0.99, which is also the smallest that is given; smooth. No gamma function.
/// @param circle_arm  A, between 0 and 1
template <class Real>
Real exponent_plus_one(const Real& circle_arm) noexcept {
  using plain::larger;
  const Real x = 0.25 * kPi / (circle_arm * circle_arm);
  const Real u = 1. / (x * x);
  const Real numerator = 1. + u * (2.65002658 + u * (1.28332163 + u * 0.06638204));
  const Real denominator = 1. + u * (2.75939488 + u * (1.5262606 + u * 0.13551127));
  return larger(Real(x - 0.75 - numerator / denominator / (32. * x)), 0.01);
}

}  // namespace softfinger
