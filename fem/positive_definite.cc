#include "fem/positive_definite.h"

#include <Eigen/Cholesky>

namespace softfinger::fem {

Eigen::MatrixXd inverse_of_positive_definite(const Eigen::MatrixXd& matrix) {
  const Eigen::LLT<Eigen::MatrixXd> factor(matrix);
  if (factor.info() != Eigen::Success) return {};
  return factor.solve(Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()));
}

Eigen::VectorXd solve_positive_definite(const Eigen::MatrixXd& matrix,
                                        const Eigen::VectorXd& right_hand_side) {
  return matrix.llt().solve(right_hand_side);
}

}  // namespace softfinger::fem
