#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "softfinger/friction/friction_ellipsoid.h"

namespace softfinger {

/// Sliding velocity of the slider against its base, at the centre of the contact ellipse: rigid
/// motion in the contact plane, x along the long axis. Only its direction matters to dry friction.
struct Twist {
  double velocity_x_m_per_s = 0, velocity_y_m_per_s = 0;
  double angular_velocity_rad_per_s = 0;  ///< counter-clockwise about the normal z
};

/// Exact force-torque limit surface of a contact whose pressure is
///   p = (n+1) P / (pi a b) (1 - x²/a² - y²/b²)^n
/// and in which every point slides with Coulomb friction against its own velocity (Howe and
/// Cutkosky 1996). The surface bounds a convex set of wrenches (f_x, f_y, tau about the centre).
///
/// Sign: all wrenches here are + int mu p v/|v| dA, the load that keeps the slider moving with the
/// given twist. The frictional wrench on the slider is the negative of it. So wrench . twist is the
/// dissipated power, never negative, and the surface is symmetric about the origin: for *whether* a
/// wrench can be carried the sign does not matter.
///
/// Method. With the centre of rotation at (a C_x, b C_y), the ellipse scaled to a unit circle, and
/// chords through that point in directions (cos t, sin t), polar coordinates about the point make
/// the integral along each chord a complete Beta function. In terms of q = C_y cos t - C_x sin t,
/// the chord's distance from the centre, and r = sqrt(a² cos²t + b² sin²t),
///   f   = -K mu P int (1 - q²)^(n+1/2) (C_x cos t + C_y sin t) (-b sin t, a cos t)/r dt,
///   tau =  K mu P a² b²/(2n+3) int (1 - q²)^(n+3/2) / r³ dt,     K = (n+1) B(1/2, n+1) / pi,
/// over half a turn (the chords that meet the ellipse); the second one by parts, so that nothing
/// cancels however far away the centre of rotation is. Circles: the hypergeometric series to which
/// these integrals reduce, for centres closer than 0.75 a or farther than a/0.75. Otherwise the
/// trapezoidal rule: for a centre well inside, t = am(u), which is periodic; else t from
/// q = min(c, 1) tanh w, and sinh(w - x) = sin(y) sinh(v) with x + iy the zero of r. Both maps are
/// conformal onto the domain in which the integrand is analytic, so the rule converges
/// exponentially for every aspect, every n and a centre anywhere, the edge included.
///
/// Range: a >= b > 0 finite, any a/b, -1 < n <= 1000, mu P >= 0. Beyond a/b = 3e6 the shape is
/// that at 3e6, which equals a line's to 2e-12. Anything else is taken for a hard point contact: no
/// torque, and no force without a finite mu P >= 0.
///
/// Relative error of a wrench, as a vector in the scaled space (f, tau/e_n): below 1e-12 for a/b up
/// to 2500. Beyond that it is two roundings magnified by a/b, 4e-16 a/b, and at most 2e-9 (see the
/// tests).
///
/// Only `sample` and `sample_section` allocate and throw. Every loop is bounded. Cost, measured by
/// friction_bench over all slips: constructing 0.5 microseconds; a wrench 0.4 (circle), 2 (a/b = 2
/// to 10), 4 (a/b = 1e4), half as much again for n other than 0, 1/2, 1, 2; utilisation 10 to 45,
/// projection twice that. SixPatchSurface: 60 ns and 1 microsecond, within 1.3 % to a/b = 10.
class LimitSurface {
 public:
  /// @param a_m, b_m     semi-axes, a along x
  /// @param exponent     n: 1/2 is Hertz, 1 Winkler, 2 the thin incompressible layer, 0 uniform
  /// @param max_force_N  mu P
  LimitSurface(double a_m, double b_m, double exponent, double max_force_N) noexcept;

  double a_m() const noexcept { return a_m_; }
  double b_m() const noexcept { return b_m_; }
  double exponent() const noexcept { return exponent_; }
  double max_force_N() const noexcept { return max_force_N_; }
  /// e_n, the exact largest torque over mu P; 0 for a hard point contact.
  double eccentricity_m() const noexcept { return eccentricity_m_; }
  double max_torque_Nm() const noexcept { return max_force_N_ * eccentricity_m_; }

  /// Friction ellipsoid with the exact eccentricity: touches this surface at pure force and torque.
  FrictionEllipsoid ellipsoid() const noexcept { return {max_force_N_, eccentricity_m_}; }
  /// Friction ellipsoid with the e_n of Ciocarlie et al. (2007), that of a circle of radius
  /// sqrt(ab).
  FrictionEllipsoid paper_ellipsoid() const noexcept;

  /// Load that keeps the slider moving with this twist; its point of the surface, where the twist
  /// is the outward normal (maximum dissipation). Any magnitude but zero, for which it is zero.
  LimitWrench wrench_for_twist(const Twist& twist) const noexcept;

  /// Load at which the slider turns counter-clockwise about a point of the contact plane. Infinite
  /// coordinates are allowed: (inf, y) is the translation along -y, (x, inf) the one along +x.
  LimitWrench wrench_for_center_of_rotation(double x_m, double y_m) const noexcept;

  /// Support function in watts: the largest wrench . twist of all wrenches that can be carried.
  double support(const Twist& twist) const noexcept;

  /// The factor by which a wrench exceeds what can be carried: wrench / utilisation lies on the
  /// surface; below 1 the contact sticks. Infinite for a wrench that a vanishing limit cannot
  /// carry, 0 for no wrench at all. Relative error as above.
  double utilisation(const LimitWrench& wrench) const noexcept;

  /// Whether utilisation <= 1. Most wrenches are decided without computing it.
  bool contains(const LimitWrench& wrench) const noexcept;

  /// Nearest wrench that can be carried, in the scaled space (f, tau/e_n); the wrench itself when
  /// it can be carried. For a hard point contact the torque is dropped.
  LimitWrench project(const LimitWrench& wrench) const noexcept;

  /// `count` points of the surface, in directions spread evenly over the sphere of the scaled space
  /// (Fibonacci spiral; the first half mirrored through the origin, then, for odd `count`, pure
  /// torque). Empty for `count` <= 0.
  std::vector<LimitWrench> sample(int count) const;

  /// `count` points of the section by the plane of the tangential force direction `direction_rad`,
  /// at equal angles in the scaled space, starting at pure force, once round: the counterpart of
  /// softfinger::sample_section for the ellipsoid.
  std::vector<LimitWrench> sample_section(double direction_rad, int count) const;

  /// Wrench in the scaled space (f/(mu P), tau/(mu P e_n)) for a twist in (v, e_n omega) and, if
  /// `hessian` is given, its derivative with respect to that twist. Without units: mu P and the
  /// size of the ellipse do not matter.
  Eigen::Vector3d scaled_wrench(const Eigen::Vector3d& twist,
                                Eigen::Matrix3d* hessian) const noexcept;

 private:
  struct Motion;
  struct Integrals;
  bool carries_torque() const noexcept { return eccentricity_m_ > 0; }
  auto evaluator() const noexcept;
  double power(double base) const noexcept;
  bool circle_series(const Motion& motion, Integrals& integrals) const noexcept;
  bool integrate_over_turn(const Motion& motion, Integrals& integrals, bool hessian) const noexcept;
  void integrate_over_line(const Motion& motion, Integrals& integrals, bool hessian) const noexcept;

  // Nodes u = K j / 2^level of a quarter period of am(u), by level, as sn and cn.
  static constexpr int kLevels = 5;
  static constexpr int kNodes = (1 << kLevels) + 1;

  double a_m_ = 0, b_m_ = 0, exponent_ = 0.5, max_force_N_ = 0;
  double eccentricity_m_ = 0;
  double aspect_ = 1;          // b/a
  double arm_over_a_ = 0;      // e_n / a
  double prefactor_ = 0;       // K
  double quarter_period_ = 0;  // complete elliptic integral K of modulus sqrt(1 - b²/a²)
  double line_step_ = 0.2;     // step of the trapezoidal rule in v
  int twice_power_ = -1;       // 2 n + 1 if that is a small whole number, else -1
  std::array<double, kNodes> sn_{}, cn_{}, dn_{};
};

}  // namespace softfinger
