#include "comparisons/simulation/shape_pair.h"

namespace softfinger::simulation {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d Part::local_point(const Vector3d& point_m) const { return pose.inverse() * point_m; }

Vector3d Part::local_direction(const Vector3d& direction) const {
  return pose.linear().transpose() * direction;
}

Matrix3d any_axes(const Vector3d& normal) {
  int least = 0;
  normal.cwiseAbs().minCoeff(&least);
  Matrix3d axes;
  axes.col(2) = normal;
  axes.col(0) = Vector3d::Unit(least).cross(normal).normalized();
  axes.col(1) = normal.cross(axes.col(0));
  return axes;
}

SurfacePoint surface(const Part& part, const std::optional<QuadricFit>& fit,
                     const Vector3d& point_m) {
  const Vector3d place = part.local_point(point_m);
  const SurfacePoint local = fit ? surface_near(*fit, place) : surface_near(part.kind(), place);
  const Matrix3d turn = part.pose.linear();
  return {part.pose * local.point_m, turn * local.normal,
          turn * local.curvature_per_m * turn.transpose(), local.smooth};
}

}  // namespace softfinger::simulation
