#pragma once

namespace softfinger {

/// Torque arm (int p r dA) / P in metres for p ~ (1 - x²/a² - y²/b²)^n: the largest frictional torque
/// about the normal is mu P times it. Exact: a E(m) (2 (n+1)/pi) B(3/2, n+1), m = 1 - b²/a².
/// Range: a >= b > 0, n > -1. Relative error below 1e-14.
double torque_arm_exact_m(double a_m, double b_m, double exponent) noexcept;

/// The seed's rule: the arm of a circle of radius sqrt(ab), (n+1) B(3/2, n+1) sqrt(ab); equations (9), (10) of
/// Ciocarlie et al. 2007 for n = 1 and n = 1/2. Exact only for a = b.
double torque_arm_paper_m(double a_m, double b_m, double exponent) noexcept;

}  // namespace softfinger
