#include "softfinger/friction/linearised_friction.h"

#include <algorithm>
#include <cmath>

#include "softfinger/math/sphere_covering.h"

namespace softfinger {
namespace {

/// The largest factor by which a convex set fits into the hull of `vertices`, given its support
/// function: it has to fit through every facet.
template <class Support>
double fit_into_hull(const std::vector<Eigen::Vector3d>& vertices, Support support) {
  double factor = 1;
  bool any = false;
  for (const HullFacet& facet : convex_hull(vertices)) {
    factor = std::min(factor, facet.offset / support(facet.normal));
    any = true;
  }
  return any ? std::max(factor, 0.0) : 0;
}

}  // namespace

LinearisedFriction::LinearisedFriction(int count, bool symmetric) {
  count = std::clamp(count, kSmallestCount, kLargestCount);
  symmetric_ = symmetric && count % 2 == 0;
  vertices_ = sphere_covering(count, symmetric_);
  inner_bound_ = fit_into_hull(vertices_, [](const Eigen::Vector3d&) { return 1.0; });
}

LinearisedFriction::LinearisedFriction(const LimitSurface& surface, int count, bool symmetric)
    : LinearisedFriction(count, symmetric) {
  const LimitSurface unit(surface.a_m(), surface.b_m(), surface.exponent(), 1);
  const double arm = unit.eccentricity_m();
  if (!(arm > 0)) return;
  for (Eigen::Vector3d& vertex : vertices_)
    vertex /= unit.utilisation({vertex.x(), vertex.y(), vertex.z() * arm});
  inner_bound_ = fit_into_hull(vertices_, [&](const Eigen::Vector3d& normal) {
    return unit.support({normal.x(), normal.y(), normal.z() / arm});
  });
}

LinearisedFriction LinearisedFriction::with_tolerance(double tolerance) {
  // For many points no set reaches more than 1 - 2.42/u, so that no smaller u can be enough. The
  // sets found miss that bound by a few per cent of 2.42/u at most.
  constexpr double kGapTimesCount = 2.2;
  const double wanted = 1 - tolerance;
  int count = kSmallestCount;
  if (tolerance > 0)
    count = int(std::min(kGapTimesCount / tolerance, double(kLargestCount)));
  else
    count = kLargestCount;
  count = std::clamp(count - count % 2, kSmallestCount, kLargestCount);
  LinearisedFriction friction(count);
  while (!(friction.inner_bound() >= wanted - 1e-12) && count < kLargestCount) {
    count += 2;
    friction = LinearisedFriction(count);
  }
  return friction;
}

void LinearisedFriction::columns(double eccentricity_m,
                                 Eigen::Ref<Eigen::Matrix3Xd> columns) const noexcept {
  for (int i = 0; i < count(); ++i)
    columns.col(i) << vertices_[i].x(), vertices_[i].y(), vertices_[i].z() * eccentricity_m;
}

Eigen::Matrix3Xd LinearisedFriction::columns(double eccentricity_m) const {
  Eigen::Matrix3Xd result(3, count());
  columns(eccentricity_m, result);
  return result;
}

LimitWrench vertex_for_twist(const FrictionEllipsoid& ellipsoid, const Twist& twist) noexcept {
  const double spin = twist.angular_velocity_rad_per_s * ellipsoid.eccentricity_m;
  const double largest = std::max(
      {std::abs(twist.velocity_x_m_per_s), std::abs(twist.velocity_y_m_per_s), std::abs(spin)});
  if (!(largest > 0) || !std::isfinite(largest)) return {};
  // In two steps, so that nothing overflows or underflows on the way.
  const double x = twist.velocity_x_m_per_s / largest, y = twist.velocity_y_m_per_s / largest,
               z = spin / largest;
  const double norm = std::sqrt(x * x + y * y + z * z);
  return {ellipsoid.max_force_N * x / norm, ellipsoid.max_force_N * y / norm,
          ellipsoid.max_torque_Nm() * z / norm};
}

}  // namespace softfinger
