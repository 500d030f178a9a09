#pragma once

#include <cmath>

#include "tests/meshes/triangulated_ellipsoid.h"

namespace softfinger::meshes {

/// A finger of 8 mm radius along z: 20 mm of a cylinder, which touches a plane along a line,
/// between two round ends.
inline TriangleSurface capsule_finger() {
  constexpr double kRadius_m = 8e-3, kHalf_m = 10e-3, kSide = 0.1;
  TriangleSurface finger = triangulated_ellipsoid({1, 1, 1}, Eigen::Vector3d::Zero(), 40);
  for (Eigen::Vector3d& vertex : finger.vertices_m) {
    const double height = std::abs(vertex.z()), sign = vertex.z() < 0 ? -1 : 1;
    const double end = std::max(0., (height - kSide) / (1 - kSide));
    const Eigen::Vector2d across = vertex.head<2>();
    const double width =
        across.norm() > 0 ? kRadius_m * std::sqrt(1 - end * end) / across.norm() : 0;
    vertex << width * across, sign * (kHalf_m * std::min(1., height / kSide) + kRadius_m * end);
  }
  return finger;
}

}  // namespace softfinger::meshes
