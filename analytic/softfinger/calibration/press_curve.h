#pragma once

#include <array>
#include <cstddef>
#include <vector>

/// Force over travel of a finger that is pressed, as a testing machine records it, before any
/// model: its exponent, its two branches, and what lies between them.
namespace softfinger {

struct PressCurve {
  std::vector<double> travel_m, force_N;  ///< of one length; forces > 0
};

/// travel = zero + coefficient P^(1/n), by least squares of the travel. A thick body without a core
/// has n = 3/2 (Hertz), columns have 2, a thin incompressible layer has 3; a shell or a spring
/// has 1.
struct CurveExponent {
  /// The best fit with one n.
  struct Law {
    double exponent = 0, zero_m = 0, coefficient = 0;  ///< the last in m/N^(1/n)
    double travel_m(double force_N) const noexcept;
  };
  bool is_known = false;
  double value = 0, low = 0, high = 0;  ///< n and its 95 % interval (profile likelihood)
  Law best, at_low, at_high;            ///< with the n of these
};

/// @param is_zero_known  the travel is counted from the first touch
/// Not known with fewer than five points, or with forces that span less than a factor of 1.3.
/// Searched for n from 1/3 to 10.
CurveExponent curve_exponent(const PressCurve& curve, bool is_zero_known);

/// Place of the first row of the unloading branch; the number of rows where there is none. The rows
/// are in the order of time. There is one where the travel never falls up to its largest value and
/// never rises after it, with at least three rows on either side.
std::size_t first_unloading_row(const std::vector<double>& travel_m);

/// Comparison of the two branches.
struct Loop {
  bool is_known = false;
  /// Travel of unloading less that of loading at equal force, at 10, 50 and 90 % of the largest.
  static constexpr std::array<double, 3> kForces{0.1, 0.5, 0.9};
  std::array<double, 3> shift_m{};
  /// The part of the shift that is the same at all forces and that only play in the machine can
  /// make: on the way back the drive moves before the plate does. Zero where rubber's lag, which
  /// has the other sign, is larger.
  double backlash_m = 0;
  /// Work that does not come back over the work of loading, once the backlash is taken out; 0 to 1.
  double hysteresis_share = 0;
};

/// @param unloading  in the order of time: falling
Loop loop_between(const PressCurve& loading, const PressCurve& unloading);

}  // namespace softfinger
