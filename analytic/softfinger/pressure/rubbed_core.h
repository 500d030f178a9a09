#pragma once

#include <cmath>
#include <cstddef>
#include <iterator>

#include "softfinger/input/constants.h"
#include "softfinger/layer/contact_numbers.h"
#include "softfinger/math/always_inline.h"
#include "softfinger/math/dual.h"
#include "softfinger/math/plain_functions.h"
#include "softfinger/pressure/arm_exponent.h"

/// The effect of friction while pressing (rubbed_prediction.h), on any kind of number.
namespace softfinger {

/// Constants of one ratio, named as in the header.
struct RatioConstants {
  double c0, n1, s0, n3, p, c2, n2, c, q, k, b, n, j, g1, g2, g3;
  double per_strain;
};
inline constexpr RatioConstants kIndentationRatio{0.03475, 1.182,  1.552, 1.112, 2.367, 0.4164,
                                                  0.6843,  0.2799, 11.03, 2.647, 3.522, 0.9423,
                                                  4.019,   0.5109, 5.278, 2.119, 1.45};
inline constexpr RatioConstants kSizeRatio{0.06093, 1.224,  2.075, 1.049,  1.731, 0.4782,
                                           0.7129,  0.1343, 19.9,  3.063,  4.023, 0.425,
                                           3.864,   0.3717, 5.359, 0.9596, 2.2};
inline constexpr RatioConstants kArmRatio{0.09249, 1.281,  1.511, 0.8185, 2.184, 0.3304,
                                          0.7471,  0.1759, 23.26, 3.291,  3.457, 0.3372,
                                          4.269,   0.2465, 5.504, 0,      2.2};

/// erf of x >= 0, within 3e-15: 1 - exp(-x²) p(t)/(1 + 2 x), t = (x - 3)/(x + 3), the form of
/// Shepherd and Laframboise (1981), its polynomial p by least squares. One where x is infinite.
template <class Real>
Real saturation(const Real& x) noexcept {
  using plain::exp;
  using plain::smaller;
  constexpr double kPolynomial[] = {
      1.253008058281367,     -0.1356211059601163,    -0.04756229384481218,   0.1296451559089637,
      -0.1192736849807956,   0.06830799085417254,    -0.02377044275585916,   0.002529710015204308,
      0.001888863480816805,  -0.000780585497870113,  -0.0001063157225570556, 0.0001255151245947325,
      6.952699950562147e-06, -1.930103769172073e-05, -2.120549404461069e-06, 2.204229773771441e-06,
      5.670283245065542e-07};
  const Real within = smaller(x, 10.);
  const Real t = (within - 3.) / (within + 3.);
  Real sum = kPolynomial[std::size(kPolynomial) - 1];
  for (std::size_t i = std::size(kPolynomial) - 1; i-- > 0;) sum = sum * t + kPolynomial[i];
  return 1. - exp(-1. * within * within) * sum / (1. + 2. * within);
}

/// Overload that carries derivatives.
template <int N>
Dual<N> saturation(const Dual<N>& x) noexcept {
  const double value = saturation(x.value);
  if (!(x.value < 10)) return value;
  return Dual<N>::chain(x, value, 2 / std::sqrt(kPi) * plain::exp(-x.value * x.value));
}

template <class Real>
struct RatiosOf {
  Real size, indentation, torque_arm;
};

/// Powers of larger and smaller numbers do not fit into a double; the ratios no longer change
/// there.
template <class Real>
Real log_of_clamped(const Real& x) noexcept {
  using plain::larger;
  using plain::log;
  using plain::smaller;
  return log(smaller(larger(x, 1e-30), 1e30));
}

template <class Real>
SOFTFINGER_ALWAYS_INLINE inline RatiosOf<Real> ratios_of(const Real& nu, const Real& size,
                                                         const Real& mu,
                                                         const Real& strain) noexcept {
  using plain::exp;
  using plain::larger;
  const Real t = 1. - 2. * nu;
  const Real log_s = log_of_clamped(size), log_t = log_of_clamped(t);
  const auto ratio = [&](const RatioConstants& of) {
    const Real log_thinner = log_of_clamped(Real(size * (1. + of.per_strain * strain)));
    const Real thinner = exp(log_thinner);
    const Real inward =
        of.c0 * exp(of.n1 * log_t) / (1. + exp(of.p * (log_s - std::log(of.s0) - of.n3 * log_t)));
    const Real of_inward = of.c2 * exp(of.n2 * log_t);
    const Real flow = of.c / (of.q * exp(-of.k * log_thinner) + 1.) /
                      (1. + of.b * t / (1. - nu) * exp(of.n * log_thinner)) *
                      larger(Real(1. - of.j * t), 0.);
    const Real of_flow = of.g1 * exp(-of.g2 * t) * thinner / (thinner + of.g3);
    // Half of the root of pi: the error function then begins with the slope 1.
    constexpr double kUnitSlope = 0.886;
    return exp(-1. * (inward * saturation(Real(kUnitSlope * mu / of_inward)) +
                      flow * saturation(Real(kUnitSlope * mu / of_flow))));
  };
  return {ratio(kSizeRatio), ratio(kIndentationRatio), ratio(kArmRatio)};
}

/// Numbers of frictionless pressing as they are with friction.
template <class Real>
SOFTFINGER_ALWAYS_INLINE inline ContactNumbersOf<Real> with_friction(
    const ContactNumbersOf<Real>& frictionless, const Real& nu, const Real& thickness_m,
    const Real& mu, bool has_finite_strain) noexcept {
  using plain::exp;
  using plain::log;
  using plain::sqrt;
  const Real size_m = sqrt(frictionless.a_m) * sqrt(frictionless.b_m);
  const Real strain = has_finite_strain ? frictionless.indentation_m / thickness_m : Real(0.);
  const RatiosOf<Real> ratios = ratios_of<Real>(nu, size_m / thickness_m, mu, strain);
  // The arm of a circle of radius one, which tells the exponent.
  const Real aspect = frictionless.a_m / frictionless.b_m;
  const Real arm =
      frictionless.torque_arm_exact_m / (size_m * exp(log_ring_arm(Real(log(aspect)))));
  const Real flatter =
      exponent_plus_one<Real>(arm * ratios.torque_arm / ratios.size) / exponent_plus_one<Real>(arm);
  return {frictionless.a_m * ratios.size,
          frictionless.b_m * ratios.size,
          frictionless.indentation_m * ratios.indentation,
          frictionless.peak_pressure_Pa * flatter / (ratios.size * ratios.size),
          frictionless.torque_arm_exact_m * ratios.torque_arm,
          frictionless.torque_arm_paper_m * ratios.torque_arm};
}

}  // namespace softfinger
