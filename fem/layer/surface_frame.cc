#include "fem/layer/surface_frame.h"

#include <Eigen/Geometry>
#include <cmath>

namespace softfinger::fem {

Eigen::Matrix3d surface_frame(const Eigen::Vector3d& normal) {
  // As Eigen::Quaterniond::FromTwoVectors does, without its case of opposite vectors: that one
  // compiles a singular value decomposition.
  const Eigen::Vector3d to = normal.normalized();
  const double doubled_cosine = std::sqrt((1 + to.z()) * 2);  // of half the angle
  Eigen::Quaterniond rotation;
  rotation.vec() = Eigen::Vector3d::UnitZ().cross(to) * (1 / doubled_cosine);
  rotation.w() = doubled_cosine * 0.5;
  return rotation.toRotationMatrix();
}

}  // namespace softfinger::fem
