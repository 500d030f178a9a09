#pragma once

#include <Eigen/Core>

/// Dense symmetric positive definite matrices by Cholesky's factorisation. Compiled once: the
/// factorisation takes several seconds in every file that has it.
namespace softfinger::fem {

/// @returns A^-1; empty (0 x 0) where A is not positive definite
Eigen::MatrixXd inverse_of_positive_definite(const Eigen::MatrixXd& matrix);

/// @returns A^-1 b. @pre A is positive definite
Eigen::VectorXd solve_positive_definite(const Eigen::MatrixXd& matrix,
                                        const Eigen::VectorXd& right_hand_side);

}  // namespace softfinger::fem
