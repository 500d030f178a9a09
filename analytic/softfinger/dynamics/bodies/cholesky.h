#pragma once

#include <Eigen/Core>

/// Internal: Cholesky's decomposition of small matrices. Eigen's own is written for large ones: it
/// takes seconds to compile in each source, and is no faster for a body or an arm.
namespace softfinger::internal {

/// The lower triangle of a symmetric matrix becomes L with L L^T = matrix; the upper one is not
/// used. False if the matrix is not positive definite: then only the columns before the bad pivot
/// are those of L.
bool factorise_cholesky(Eigen::Ref<Eigen::MatrixXd> matrix);

/// x becomes (L L^T)^-1 x.
void solve_cholesky(const Eigen::Ref<const Eigen::MatrixXd>& factor, Eigen::Ref<Eigen::VectorXd> x);

}  // namespace softfinger::internal
