#pragma once

#include <Eigen/Core>

#include "softfinger/friction/limit_surface.h"
#include "softfinger/friction/six_patch_surface.h"

namespace softfinger {

/// A convex set of friction wrenches without units, (f_x, f_y, tau/e_n)/(mu P): symmetric about the
/// origin, with largest force 1 and largest torque 1, known by its support function h. It depends
/// on the shape of the contact (exponent and aspect), not on load, size or friction coefficient.
class FrictionShape {
 public:
  virtual ~FrictionShape() = default;

  /// Gradient of the support function h at `direction` (of any length but zero): the point of the
  /// boundary that has this outward normal. Unless `hessian` is null, it takes the second
  /// derivatives of h.
  virtual Eigen::Vector3d boundary(const Eigen::Vector3d& direction,
                                   Eigen::Matrix3d* hessian) const noexcept = 0;
};

/// The shape of LimitSurface or SixPatchSurface. x is the contact ellipse's long axis: so must be
/// the first tangent of the contact.
template <class Surface>
class SurfaceShape final : public FrictionShape {
 public:
  /// @param aspect    b/a of the contact ellipse, (0, 1]
  /// @param exponent  n of the pressure, as in LimitSurface
  SurfaceShape(double aspect, double exponent) noexcept : surface_(1, aspect, exponent, 1) {}
  Eigen::Vector3d boundary(const Eigen::Vector3d& direction,
                           Eigen::Matrix3d* hessian) const noexcept override {
    return surface_.scaled_wrench(direction, hessian);
  }
  const Surface& surface() const noexcept { return surface_; }

 private:
  Surface surface_;
};

using LimitSurfaceShape = SurfaceShape<LimitSurface>;  ///< exact; microseconds per point
using SixPatchShape = SurfaceShape<SixPatchSurface>;   ///< within 1.3 % of it; 60 ns per point

/// The part of a friction wrench beyond the limit, see `friction_excess`.
struct FrictionExcess {
  Eigen::Vector3d excess = Eigen::Vector3d::Zero();    ///< nu, an outward normal; zero inside
  Eigen::Vector3d boundary = Eigen::Vector3d::Zero();  ///< grad h(nu)
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();   ///< of h at nu
};

/// The nu of  nu + A radius grad h(nu) = target,  A = diag(metric) > 0; zero where target lies in
/// A radius K, K being `shape` (null: the unit ball). So A^-1 (target - nu) is the point of radius
/// K nearest to A^-1 target when distances are measured by A: with A = 1, the projection.
/// Relative error 1e-15 for the ball, 1e-12 for shapes. No allocation, bounded loops.
FrictionExcess friction_excess(const FrictionShape* shape, const Eigen::Vector3d& target,
                               double radius, const Eigen::Vector3d& metric) noexcept;

/// Factor by which a wrench exceeds `shape` (null: the unit ball).
double friction_gauge(const FrictionShape* shape, const Eigen::Vector3d& wrench) noexcept;

}  // namespace softfinger
