#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/friction/limit_surface.h"
#include "softfinger/friction/shear_limit.h"

namespace softfinger {

/// Exact force-torque limit surface of a contact under any shear law: LimitSurface with mu p
/// replaced by the law's stress tau. Same sign, same questions, same scaled space (f/F, tau/T) with
/// F and T the largest force and torque.
///
/// Method. The wrench of a twist, int tau v/|v| dA, is linear in the stress.
/// - coulomb, shear_strength and adhesive_shear are sums of LimitSurfaces with the exponents n (mu
///   p) and 0 (tau_0), accurate as those: 1e-12.
/// - limited: min(mu p, tau_0) is a pile of uniform elliptic discs of relative radii s from 1 down
///   to c, where mu p = tau_0: int (-dtau/ds) disc(s) ds. A disc's wrench is singular in s where
///   its edge or, for complex s, its focus is at the centre of rotation. The integral is split at
///   both, and each piece is taken by the double-exponential rule. Relative error 1e-9, as a vector
///   in the scaled space; 1e-10 is the largest measured, for a/b to 300.
///
/// Range as for LimitSurface. Only `sample` and `sample_section` allocate and throw. Cost: that of
/// one or two LimitSurfaces; `limited` takes up to 120 wrenches of uniform discs for one of its
/// own, 12 (circle) to 100 microseconds (a/b = 10), a utilisation 0.4 to 0.7 ms.
///
/// Where that is too long, the LimitSurface of the exponent with the same arm stands for it within
/// 1.0 % (limited) and 0.7 % (adhesive_shear), n = 1/2 to 2, a/b to 10 (see the tests).
class ShearSurface {
 public:
  ShearSurface(const ShearLaw& law, const PressedEllipse& contact) noexcept;

  double max_force_N() const noexcept { return ellipsoid_.max_force_N; }
  /// The largest torque over the largest force.
  double eccentricity_m() const noexcept { return ellipsoid_.eccentricity_m; }
  double max_torque_Nm() const noexcept { return ellipsoid_.max_torque_Nm(); }
  /// Touches this surface at pure force and at pure torque.
  FrictionEllipsoid ellipsoid() const noexcept { return ellipsoid_; }

  LimitWrench wrench_for_twist(const Twist& twist) const noexcept;
  double support(const Twist& twist) const noexcept;
  double utilisation(const LimitWrench& wrench) const noexcept;
  bool contains(const LimitWrench& wrench) const noexcept;
  LimitWrench project(const LimitWrench& wrench) const noexcept;
  std::vector<LimitWrench> sample(int count) const;
  std::vector<LimitWrench> sample_section(double direction_rad, int count) const;

  /// Wrench and second derivatives as those of LimitSurface::scaled_wrench.
  Eigen::Vector3d scaled_wrench(const Eigen::Vector3d& twist,
                                Eigen::Matrix3d* hessian) const noexcept;

 private:
  auto evaluator() const noexcept;
  void add_discs(const Eigen::Vector3d& twist, Eigen::Vector3d& wrench,
                 Eigen::Matrix3d* hessian) const noexcept;

  FrictionEllipsoid ellipsoid_;
  double exponent_ = 0.5;
  LimitSurface friction_;  ///< of mu p; no force where the law has none of it
  LimitSurface uniform_;   ///< of tau_0; the discs' shape, too
  /// Discs that make up the stress of the law `limited`; zero where the strength limits nothing.
  double disc_force_ = 0;            ///< pi a b mu p_0
  double lowest_ = 0, highest_ = 0;  ///< of the discs' variable x, see the source
};

}  // namespace softfinger
