#pragma once

namespace softfinger {

/// Torque arm (int p r dA) / P in metres for p ~ (1 - x²/a² - y²/b²)^n: the largest frictional
/// torque about the normal is mu P times it. Exact: a E(m) (2 (n+1)/pi) B(3/2, n+1), with E the
/// complete elliptic integral of parameter m = 1 - b²/a² and B the Beta function.
///
/// @param a_m, b_m   semi-axes, a >= b > 0
/// @param exponent   n > -1: 1/2 is Hertz, 1 Winkler, 2 the thin incompressible layer
/// Relative error below 1e-14. Cost: about 50 ns; n other than 0, 1/2, 1, 2 adds two gamma
/// functions.
double torque_arm_exact_m(double a_m, double b_m, double exponent) noexcept;

/// The rule of Ciocarlie et al. (2007): the arm of a circle of radius sqrt(ab), (n+1) B(3/2, n+1)
/// sqrt(ab); equations (9), (10) there for n = 1 and n = 1/2. Exact only for a = b, otherwise too
/// small: by 8 % at a/b = 2, by half at a/b = 10, whatever n.
double torque_arm_paper_m(double a_m, double b_m, double exponent) noexcept;

}  // namespace softfinger
