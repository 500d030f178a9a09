#pragma once

#include <Eigen/Core>

namespace softfinger::fem {

/// The frame of a surface point: two tangents and, last, the outward normal, as columns. It is the
/// smallest rotation that takes z to the normal. So it leaves x alone on the plane x = 0 of a
/// symmetric contact, where the mirror fixes it, and y on y = 0.
/// @param normal  not along -z
Eigen::Matrix3d surface_frame(const Eigen::Vector3d& normal);

/// e_z x x: how fast a point moves when its object turns about the normal through the origin.
inline Eigen::Vector3d turned(const Eigen::Vector3d& position) {
  return {-position.y(), position.x(), 0};
}

}  // namespace softfinger::fem
