#pragma once

#include <Eigen/Core>
#include <array>

#include "softfinger/friction/limit_surface.h"

namespace softfinger {

/// Closed, convex approximation of the exact limit surface, more accurate than the friction
/// ellipsoid with its 6 to 12 %. The contact is divided into six small ones, each with a friction
/// ellipsoid of its own: two on the long axis and four beside it (a hexagon for a circle). A sum of
/// convex sets is convex, and its support function is the sum of theirs,
///   h(v, omega) = mu P sum_i w_i sqrt((v_x - omega y_i)² + (v_y + omega x_i)² + (e_i omega)²).
/// Exact at pure force and, by a common factor on all lengths, at pure torque.
///
/// Positions, shares and eccentricities over e_n are quadratic in 1 - b/a and linear in 1/(n+2);
/// the 26 coefficients were fitted to the exact surface. Largest deviation from it in any
/// direction, measured (see the test; in brackets the friction ellipsoid with the exact e_n):
///   n = 0 to 4    a/b to 1.5: 1.1 % (6.6)   to 5: 1.0 % (11.6)   to 10: 1.3 % (11.9)   to 30: 1.6
///   % n = -1/2 to 50, any a/b: 2.1 % (13.5)
///
/// In a rigid-body simulator the six patches may also be used as they are: six contacts with fixed
/// shares of the load. No allocation, no exception, bounded loops. Cost: a wrench 60 ns, a
/// utilisation 1 microsecond.
class SixPatchSurface {
 public:
  struct Patch {
    double x_m = 0, y_m = 0;    ///< from the middle of the ellipse, x along the long axis
    double share = 0;           ///< of the load, and of mu P
    double eccentricity_m = 0;  ///< e_n of its own friction ellipsoid
  };

  /// Arguments and range as for LimitSurface; n > 50 is fitted as 50.
  SixPatchSurface(double a_m, double b_m, double exponent, double max_force_N) noexcept;

  const std::array<Patch, 6>& patches() const noexcept { return patches_; }
  double max_force_N() const noexcept { return max_force_N_; }
  double eccentricity_m() const noexcept { return eccentricity_m_; }  ///< the exact e_n
  double max_torque_Nm() const noexcept { return max_force_N_ * eccentricity_m_; }

  /// Functions with the meaning and sign that they have in LimitSurface.
  LimitWrench wrench_for_twist(const Twist& twist) const noexcept;
  double support(const Twist& twist) const noexcept;
  double utilisation(const LimitWrench& wrench) const noexcept;
  bool contains(const LimitWrench& wrench) const noexcept { return utilisation(wrench) <= 1; }
  LimitWrench project(const LimitWrench& wrench) const noexcept;

  Eigen::Vector3d scaled_wrench(const Eigen::Vector3d& twist,
                                Eigen::Matrix3d* hessian) const noexcept;

 private:
  std::array<Patch, 6> patches_{};
  double max_force_N_ = 0, eccentricity_m_ = 0;
};

}  // namespace softfinger
