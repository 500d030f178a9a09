#pragma once

#include <limits>

namespace softfinger {

/// The largest moments about the long and the short axis of a contact ellipse, each alone. Both
/// together: (M_x/x)² + (M_y/y)² <= 1.
struct TiltLimit {
  double about_x_Nm = 0;  ///< about the long axis: the pressure moves along the short one
  double about_y_Nm = 0;  ///< about the short axis

  /// 1 at the limit; infinite where there is none to use.
  double utilisation(double moment_x_Nm, double moment_y_Nm) const noexcept;
};

/// Largest moment of a contact against tilting, M_x = int y p dA and M_y = -int x p dA about its
/// centre, over all pressures 0 <= p <= p_max on the ellipse that carry the load P. Pressure cannot
/// pull, so the centre of pressure stays in the ellipse; with no bound on p it can reach the edge:
/// M_y = P a. With the bound, the largest moment is that of p_max on one side of a chord and
/// nothing on the other (any other pressure can be moved outwards):
///   (beta - sin beta cos beta)/pi = 1/k,   k = pi a b p_max/P >= 1,
///   M_y = P a (2/3) sin³ beta/(beta - sin beta cos beta),   M_x likewise with b,
/// beta the half angle of the chord in the coordinates x/a, y/b. In these the ellipse is a circle,
/// so that the limit is an ellipse for all directions.
///
/// Together with (f_x, f_y, tau, P) these are all six wrench components that a planar contact can
/// transmit. A moment does not change the largest tangential force, mu P. The torque about the
/// normal is then about the centre of pressure. Curved bodies that tilt by phi roll: the contact
/// moves by phi times the relative radius without resistance, which changes the moment about its
/// former centre by P R phi.
///
/// @param a_m, b_m    semi-axes, a >= b > 0
/// @param load_N      P >= 0
/// @param peak_ratio  k, at least 1 (smaller ones are taken for 1: no moment). n + 1 for the peak
///   of a pressure p ~ (1 - x²/a² - y²/b²)^n: 3/2 for Hertz, 2 for Winkler. Infinite: no bound.
/// Exact to 1e-13. No allocation.
TiltLimit tilt_limit(double a_m, double b_m, double load_N,
                     double peak_ratio = std::numeric_limits<double>::infinity()) noexcept;

}  // namespace softfinger
