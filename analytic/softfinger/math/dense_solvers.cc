#include "softfinger/math/dense_solvers.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>

namespace softfinger::internal {

using Eigen::MatrixXd;

SymmetricEigen symmetric_eigen(const DenseMatrix& matrix) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

MatrixXd solve_definite(const DenseMatrix& matrix, const DenseMatrix& right) {
  return Eigen::LLT<MatrixXd>(matrix).solve(right);
}

MatrixXd solve_semidefinite(const DenseMatrix& matrix, const DenseMatrix& right) {
  return Eigen::LDLT<MatrixXd>(matrix).solve(right);
}

MatrixXd pseudo_inverse(const DenseMatrix& matrix) {
  return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(matrix).pseudoInverse();
}

MatrixXd inverse(const DenseMatrix& matrix) {
  return Eigen::PartialPivLU<MatrixXd>(matrix).inverse();
}

LeastSquaresSolution least_squares(const DenseMatrix& matrix, const DenseMatrix& right,
                                   double threshold) {
  Eigen::ColPivHouseholderQR<MatrixXd> qr(matrix);
  qr.setThreshold(threshold);
  return {qr.solve(right), qr.rank()};
}

MatrixXd gram(const DenseMatrix& matrix) { return matrix.transpose() * matrix; }

}  // namespace softfinger::internal
