#pragma once

#include <Eigen/Core>

namespace softfinger::fem::finite {

/// Second-order tensors as vectors, column by column: entry (i, J) is at i + 3 J.
using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

inline Vector9d as_vector(const Eigen::Matrix3d& tensor) {
  return Eigen::Map<const Vector9d>(tensor.data());
}

/// Derivative of the cofactor, symmetric: e_ikm e_JLN F_mN at (i + 3 J, k + 3 L). The determinant
/// is cubic in F, so this is linear in F.
Matrix9d cofactor_derivative(const Eigen::Matrix3d& gradient);

/// A deformation gradient F = dx/dX with what every material needs of it.
struct Deformation {
  /// @param with_second  false: `second` is left as it is; no tangent may be asked for
  explicit Deformation(const Eigen::Matrix3d& deformation_gradient, bool with_second = true);

  Eigen::Matrix3d gradient;
  double volume_ratio;       ///< J = det F
  Eigen::Matrix3d cofactor;  ///< dJ/dF = J F^-T
  Matrix9d second;           ///< d²J/dF²
};

}  // namespace softfinger::fem::finite
