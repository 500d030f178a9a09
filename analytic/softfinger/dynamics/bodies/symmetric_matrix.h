#pragma once

#include <Eigen/Core>

/// Internal: decompositions of small symmetric matrices. Eigen's own are written for large ones:
/// they take seconds to compile in each source, and are no faster for a body or an arm.
namespace softfinger::internal {

/// The lower triangle of a symmetric matrix becomes L with L L^T = matrix; the upper one is not
/// used. False if the matrix is not positive definite: then only the columns before the bad pivot
/// are those of L.
bool factorise_cholesky(Eigen::Ref<Eigen::MatrixXd> matrix);

/// The eigenvalues and, as columns, the eigenvectors of a symmetric matrix, by Jacobi's rotations.
struct SymmetricModes {
  explicit SymmetricModes(Eigen::MatrixXd matrix);
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};

/// x becomes (L L^T)^-1 x.
void solve_cholesky(const Eigen::Ref<const Eigen::MatrixXd>& factor, Eigen::Ref<Eigen::VectorXd> x);

}  // namespace softfinger::internal
