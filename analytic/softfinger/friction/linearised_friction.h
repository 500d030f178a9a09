#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/friction/limit_surface.h"

namespace softfinger {

/// Linearised friction (Ciocarlie et al. 2007, eq. 2): f_w = D beta, beta >= 0, sum(beta) <= mu P,
/// where the u columns of D are points of the limit surface of a contact with mu P = 1.
///
/// The columns are spread over the surface in the scaled space (f_x, f_y, tau/e_n), where the
/// friction ellipsoid is the unit sphere: in newtons and newton-metres together, most of them would
/// crowd where the arm e_n is short. The first one is pure torque. For even u the set is symmetric
/// about the origin (column u/2 + i is the negative of column i), unless it is asked not to be: for
/// few columns symmetry costs accuracy.
///
/// The polytope lies inside the surface, and the surface times `inner_bound()` lies inside the
/// polytope; the polytope times `outer_scale()` contains the surface. Both are exact: they are read
/// off the facets of the convex hull. For the ellipsoid, measured (see the test):
///   u                 6      8      10     12     16     20     26     32     48     64     100
///   inner, symmetric  .577   .654   .692   .794   .811   .861   .894   .922   .946   .958   .973
///   inner, free       .577   .666   .738   .794   .837   .864   .898   .917   .945   .959   .973
/// (truncated), about 1 - 2.65/u; no set of many points can do better than 1 - 2.42/u. The bound
/// does not depend on e_n, so one object serves all contacts with the ellipsoid; it takes 5 to 100
/// ms to build, and is no part of an inner loop. `columns` is: it costs 1 ns per column.
class LinearisedFriction {
 public:
  static constexpr int kSmallestCount = 6, kLargestCount = 1000;

  /// Linearises the friction ellipsoid. `count` is clamped to [6, 1000]; `symmetric` has no effect
  /// for odd counts. @throws std::bad_alloc
  explicit LinearisedFriction(int count, bool symmetric = true);

  /// Linearises an exact limit surface; only its shape is used, not its mu P. The columns lie on
  /// it, and the bounds refer to it. Holds for contacts of the same exponent and aspect; `columns`
  /// wants their exact e_n.
  LinearisedFriction(const LimitSurface& surface, int count, bool symmetric = true);

  /// The smallest symmetric set (even u) of the ellipsoid with inner_bound() >= 1 - tolerance, or
  /// of kLargestCount columns when none reaches it (tolerance below 0.3 %). Builds a few sets.
  static LinearisedFriction with_tolerance(double tolerance);

  int count() const noexcept { return int(vertices_.size()); }
  bool symmetric() const noexcept { return symmetric_; }
  double inner_bound() const noexcept { return inner_bound_; }
  double outer_scale() const noexcept { return 1 / inner_bound_; }

  /// The vertices in the scaled space (f_x, f_y, tau/e_n) / (mu P).
  const std::vector<Eigen::Vector3d>& vertices() const noexcept { return vertices_; }

  /// D: force x and y without unit, torque in m, for a contact with arm `eccentricity_m`. `columns`
  /// must be 3 x count().
  void columns(double eccentricity_m, Eigen::Ref<Eigen::Matrix3Xd> columns) const noexcept;
  Eigen::Matrix3Xd columns(double eccentricity_m) const;

 private:
  LinearisedFriction() = default;

  std::vector<Eigen::Vector3d> vertices_;
  bool symmetric_ = false;
  double inner_bound_ = 0;
};

/// The ellipsoid's vertex on demand: its point where the given twist is the outward normal, mu P
/// (v, e_n² omega) / sqrt(v² + e_n² omega²), so that the linearisation is exact for that slip. Zero
/// for no twist. Sign as in LimitSurface, whose `wrench_for_twist` is the same for the exact
/// surface. No allocation, 10 ns.
LimitWrench vertex_for_twist(const FrictionEllipsoid& ellipsoid, const Twist& twist) noexcept;

}  // namespace softfinger
