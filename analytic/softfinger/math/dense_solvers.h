#pragma once

#include <Eigen/Core>

/// Decompositions of dense matrices of any size. Eigen's are templates, which cost the compiler
/// several seconds for each size in each source; these are compiled once. They allocate, so hot
/// loops solve small systems of their own.
namespace softfinger::internal {

using DenseMatrix = Eigen::Ref<const Eigen::MatrixXd>;

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< a column of unit length for each value
};

/// Eigenvalues and eigenvectors of a symmetric matrix, of which the lower triangle is read.
SymmetricEigen symmetric_eigen(const DenseMatrix& matrix);

/// x of A x = b for a positive definite A, by Cholesky's factor of its lower triangle.
Eigen::MatrixXd solve_definite(const DenseMatrix& matrix, const DenseMatrix& right);

/// x of A x = b for a positive or negative semidefinite A, by the pivoted L D L' of its lower
/// triangle.
Eigen::MatrixXd solve_semidefinite(const DenseMatrix& matrix, const DenseMatrix& right);

/// The x of smallest |x| among those of smallest |A x - b| is the pseudo-inverse times b, whatever
/// the rank of A.
Eigen::MatrixXd pseudo_inverse(const DenseMatrix& matrix);

Eigen::MatrixXd inverse(const DenseMatrix& matrix);

struct LeastSquaresSolution {
  Eigen::MatrixXd solution;
  Eigen::Index rank = 0;
};

/// The x of smallest |A x - b|, by a QR decomposition with pivoted columns.
/// @param threshold  a pivot below this part of the largest one counts as zero
LeastSquaresSolution least_squares(const DenseMatrix& matrix, const DenseMatrix& right,
                                   double threshold);

/// A' A.
Eigen::MatrixXd gram(const DenseMatrix& matrix);

}  // namespace softfinger::internal
