#include "fem/finite/deformation.h"

#include <Eigen/Geometry>

namespace softfinger::fem::finite {

Matrix9d cofactor_derivative(const Eigen::Matrix3d& gradient) {
  Matrix9d result = Matrix9d::Zero();
  // For each J != L the 3 x 3 block is the cross product with a column of F, up to its sign.
  for (int J = 0; J < 3; ++J) {
    const int L = (J + 1) % 3;
    const Eigen::Vector3d column = gradient.col((J + 2) % 3);
    Eigen::Matrix3d block;  // e_ikm column_m
    block << 0, column[2], -column[1], -column[2], 0, column[0], column[1], -column[0], 0;
    result.block<3, 3>(3 * J, 3 * L) = block;
    result.block<3, 3>(3 * L, 3 * J) = block.transpose();
  }
  return result;
}

Deformation::Deformation(const Eigen::Matrix3d& deformation_gradient, bool with_second)
    : gradient(deformation_gradient) {
  if (with_second) second = cofactor_derivative(gradient);
  cofactor.col(0) = gradient.col(1).cross(gradient.col(2));
  cofactor.col(1) = gradient.col(2).cross(gradient.col(0));
  cofactor.col(2) = gradient.col(0).cross(gradient.col(1));
  volume_ratio = gradient.col(0).dot(cofactor.col(0));
}

}  // namespace softfinger::fem::finite
