#include "softfinger/friction/shear_limit.h"

#include <algorithm>
#include <cmath>

#include "softfinger/friction/max_torque.h"
#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

/// The continued fraction of the incomplete Beta function (DLMF 8.17.22) by Lentz' method, for x
/// below (p+1)/(p+q+2), where it converges within O(sqrt(max(p, q))) terms.
double beta_fraction(double x, double p, double q) noexcept {
  constexpr int kMostTerms = 2000;
  constexpr double kTiny = 1e-300;
  double d = 1 - (p + q) / (p + 1) * x;
  d = 1 / (std::abs(d) > kTiny ? d : kTiny);
  double c = 1, fraction = d;
  const auto advance = [&](double coefficient) {
    d = 1 + coefficient * d;
    d = 1 / (std::abs(d) > kTiny ? d : kTiny);
    c = 1 + coefficient / c;
    if (!(std::abs(c) > kTiny)) c = kTiny;
    fraction *= d * c;
  };
  for (int m = 1; m <= kMostTerms; ++m) {
    advance(m * (q - m) * x / ((p + 2 * m - 1) * (p + 2 * m)));
    advance(-(p + m) * (p + q + m) * x / ((p + 2 * m) * (p + 2 * m + 1)));
    if (std::abs(d * c - 1) < 1e-16) break;
  }
  return fraction;
}

/// I_w(n+1, 3/2): the share of a Coulomb contact's torque that the pressure beyond the relative
/// radius sqrt(1 - w) has. (n+1) B(n+1, 3/2) is the arm of the unit circle.
double torque_share(double w, double n) noexcept {
  if (w <= 0) return 0;
  if (w >= 1) return 1;
  const double power =
      std::pow(w, n + 1) * (1 - w) * std::sqrt(1 - w) / torque_arm_exact_m(1, 1, n);
  if (w < (n + 2) / (n + 4.5)) return power * beta_fraction(w, n + 1, 1.5);
  return 1 - power * (n + 1) / 1.5 * beta_fraction(1 - w, 1.5, n + 1);
}

/// Force and torque of a part of the law, over those of its stress on the whole ellipse.
struct Shares {
  double force = 0, torque = 0;
};

/// Shares of the stress mu p and of the uniform stress tau_0.
struct Parts {
  Shares friction, strength;
};

Parts parts_of(const ShearLaw& law, const PressedEllipse& contact) noexcept {
  switch (law.kind) {
    case ShearLaw::Kind::coulomb:
      return {{1, 1}, {}};
    case ShearLaw::Kind::shear_strength:
      return {{}, {1, 1}};
    case ShearLaw::Kind::adhesive_shear:
      return {{1, 1}, {1, 1}};
    case ShearLaw::Kind::limited:
      break;
  }
  const double n = contact.exponent, w = internal::depth_of_strength(law, contact);
  const double c2 = 1 - w, c3 = c2 * std::sqrt(c2);
  const double rim_force = std::pow(w, n + 1), rim_torque = torque_share(w, n);
  if (n < 0) return {{1 - rim_force, 1 - rim_torque}, {w, 1 - c3}};
  return {{rim_force, rim_torque}, {c2, c3}};
}

}  // namespace

double internal::depth_of_strength(const ShearLaw& law, const PressedEllipse& contact) noexcept {
  const double n = contact.exponent;
  const double friction_N = law.friction_coefficient * contact.load_N;
  const double strength_N = kPi * contact.a_m * contact.b_m * law.shear_strength_Pa;
  // tau_0 over mu p_0
  const double ratio = strength_N / ((n + 1) * friction_N);
  if (n == 0) return ratio < 1 ? 0 : 1;
  if (!(friction_N > 0)) return n < 0 ? 0 : 1;
  return n < 0 ? std::pow(std::max(ratio, 1.0), 1 / n) : std::pow(std::min(ratio, 1.0), 1 / n);
}

double max_force_N(const ShearLaw& law, const PressedEllipse& contact) noexcept {
  const Parts parts = parts_of(law, contact);
  return parts.friction.force * law.friction_coefficient * contact.load_N +
         parts.strength.force * kPi * contact.a_m * contact.b_m * law.shear_strength_Pa;
}

double max_torque_Nm(const ShearLaw& law, const PressedEllipse& contact) noexcept {
  if (!(contact.b_m > 0)) return 0;
  const auto arm_m = [&](double exponent) {
    return torque_arm_exact_m(contact.a_m, contact.b_m, exponent);
  };
  const Parts parts = parts_of(law, contact);
  double torque_Nm = 0;
  if (parts.friction.torque > 0)
    torque_Nm +=
        parts.friction.torque * law.friction_coefficient * contact.load_N * arm_m(contact.exponent);
  if (parts.strength.torque > 0)
    torque_Nm +=
        parts.strength.torque * kPi * contact.a_m * contact.b_m * law.shear_strength_Pa * arm_m(0);
  return torque_Nm;
}

FrictionEllipsoid friction_ellipsoid(const ShearLaw& law, const PressedEllipse& contact) noexcept {
  const double force_N = max_force_N(law, contact);
  return {force_N, force_N > 0 ? max_torque_Nm(law, contact) / force_N : 0};
}

}  // namespace softfinger
