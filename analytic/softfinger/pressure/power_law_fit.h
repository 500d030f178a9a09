#pragma once

#include <vector>

#include "softfinger/input/contact_problem.h"

namespace softfinger {

/// One measured contact of a fingertip.
struct LoadAndRadius {
  double load_N = 0;    ///< > 0
  double radius_m = 0;  ///< of the round contact, or sqrt(ab) of an elliptic one; > 0
};

/// The law that fits the data best, and how well.
struct PowerLawFit {
  PowerLaw law;
  double residual_rms =
      0;  ///< root mean square of ln(radius/law): the relative scatter of the radii
  /// Standard deviations, from the scatter about the law: of ln(c), a relative one, at the data's
  /// geometric mean load (where it does not depend on gamma's), and of gamma. Zero for two points,
  /// which leave no scatter.
  double log_radius_std = 0, exponent_std = 0;
  double least_load_N = 0, largest_load_N = 0;  ///< outside, the law extrapolates
};

/// Least squares of ln a = ln c + gamma ln P (Xydias & Kao 1999, a = c P^gamma).
///
/// Radii say nothing about the pressure's exponent k: it is passed on.
/// @param data  at least two points with different loads; n points
/// @param pressure_exponent  k >= 1 for the law's pressure; 2 is Hertz-like
/// @throws InputError when a number is out of range, all loads are equal, or the fitted gamma does
/// not lie between 0 and 1. Cost: about 20 ns per point.
PowerLawFit fit_power_law(const std::vector<LoadAndRadius>& data, double pressure_exponent = 2);

}  // namespace softfinger
