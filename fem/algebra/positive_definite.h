#pragma once

#include <Eigen/Core>

/// Dense symmetric positive definite matrices by Cholesky's factorisation A = L L^T, by LAPACK. Of
/// a symmetric matrix or a factor that is given only the lower triangle is read.
namespace softfinger::fem {

/// Replaces the lower triangle by L; n³/3 operations, in single precision in half of the time.
/// @returns false where the matrix is not positive definite
bool factorise_positive_definite(Eigen::MatrixXd& matrix);
bool factorise_positive_definite(Eigen::MatrixXf& matrix);

/// @param factor  L
/// @returns A^-1 B
Eigen::MatrixXd solve_by_factor(const Eigen::MatrixXd& factor,
                                const Eigen::MatrixXd& right_hand_sides);
/// @returns A^-1 b
Eigen::VectorXd solve_vector_by_factor(const Eigen::MatrixXd& factor,
                                       const Eigen::VectorXd& right_hand_side);
Eigen::VectorXf solve_vector_by_factor(const Eigen::MatrixXf& factor,
                                       const Eigen::VectorXf& right_hand_side);

/// Replaces L by the lower triangle of A^-1; 2 n³/3 operations.
/// @returns false where L is singular
bool invert_by_factor(Eigen::MatrixXd& factor);

/// Replaces L by the lower triangle of A; n³/3 operations.
void multiply_factor(Eigen::MatrixXd& factor);

/// @returns A^-1; empty (0 x 0) where A is not positive definite
Eigen::MatrixXd inverse_of_positive_definite(Eigen::MatrixXd matrix);

/// @returns A b, of which columns that b has zeros for are not read: forces act where it touches
Eigen::VectorXd product_with_zeros(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& vector);

/// @returns A^-1 b. @pre A is positive definite
Eigen::VectorXd solve_positive_definite(const Eigen::MatrixXd& matrix,
                                        const Eigen::VectorXd& right_hand_side);

}  // namespace softfinger::fem
