#pragma once

#include <vector>

namespace softfinger {

/// Force-torque limit f² + tau²/e_n² <= (mu P)² of a soft contact (Ciocarlie et al. 2007, eq. 1,
/// 6). An approximation of the exact limit surface, which lies inside it by up to 6 % (circle) to
/// 11 % (a/b = 10) and, for forces along the long axis of a long ellipse, outside it by up to 5 %:
/// it meets the exact one at pure force and at pure torque. See ellipsoid_deviation.h.
struct FrictionEllipsoid {
  double max_force_N = 0;     ///< mu P
  double eccentricity_m = 0;  ///< e_n = max torque / (mu P); 0 for a hard point contact

  double max_torque_Nm() const { return max_force_N * eccentricity_m; }

  /// sqrt(f²/(mu P)² + tau²/(e_n mu P)²): below 1 the contact sticks. Infinite for a wrench that a
  /// vanishing limit cannot carry, 0 for no wrench at all.
  double utilisation(double force_x_N, double force_y_N, double torque_Nm) const noexcept;
};

struct LimitWrench {
  double force_x_N = 0, force_y_N = 0, torque_Nm = 0;
};

/// `count` points of the ellipsoid's section by the plane of the tangential force direction
/// `direction_rad`, evenly spaced in the scaled space (f, tau/e_n), starting at pure force, once
/// round: a closed curve without a repeated point. Empty for `count` <= 0.
std::vector<LimitWrench> sample_section(const FrictionEllipsoid& ellipsoid, double direction_rad,
                                        int count);

}  // namespace softfinger
