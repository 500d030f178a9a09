#include "softfinger/dynamics/exact/dense_elimination.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <utility>

#include "softfinger/math/wide.h"
#include "tests/dynamics/random_scene.h"

namespace softfinger::internal {
namespace {

/// Three quarters of it are zero, its rows in an order that needs exchanges.
Eigen::MatrixXd sparse_matrix(tests::RandomScenes& random, int size) {
  return Eigen::MatrixXd::NullaryExpr(
      size, size, [&] { return random.uniform(0, 1) < 0.75 ? 0. : random.uniform(-1, 1); });
}

Eigen::VectorXd solve(const Eigen::MatrixXd& matrix, Eigen::VectorXd right) {
  const int size = int(matrix.rows());
  DenseElimination elimination(size + 3);
  elimination.zeros(size) = matrix;
  EXPECT_TRUE(elimination.factorise());
  elimination.substitute(right);
  return right;
}

TEST(DenseElimination, SolvesAsEigenDoes) {
  tests::RandomScenes random(5);
  for (int size = 20; size <= 100; ++size) {
    const Eigen::MatrixXd matrix = sparse_matrix(random, size);
    const Eigen::VectorXd right =
        Eigen::VectorXd::NullaryExpr(size, [&] { return random.uniform(-1, 1); });
    const Eigen::FullPivLU<Eigen::MatrixXd> reference(matrix);
    ASSERT_TRUE(reference.isInvertible()) << size;
    const double condition = 1 / reference.rcond();
    const Eigen::VectorXd expected = reference.solve(right);
    EXPECT_LE((solve(matrix, right) - expected).norm(), 10 * 0x1p-52 * condition * expected.norm())
        << size;
  }
}

TEST(DenseElimination, HasTheSameBitsWithoutWideInstructions) {
  tests::RandomScenes random(6);
  for (int size = 1; size <= 60; ++size) {
    Eigen::MatrixXd matrix = sparse_matrix(random, size);
    matrix.diagonal().array() += 1.5;
    const Eigen::VectorXd right = Eigen::VectorXd::Ones(size), wide = solve(matrix, right);
    const bool had_wide_instructions = std::exchange(has_wide_instructions, false);
    EXPECT_EQ(solve(matrix, right), wide) << size;
    has_wide_instructions = had_wide_instructions;
  }
}

TEST(DenseElimination, RefusesASingularMatrix) {
  DenseElimination elimination(3);
  elimination.zeros(3) << 1, 2, 3, 2, 4, 6, 1, 0, 1;
  EXPECT_FALSE(elimination.factorise());
}

}  // namespace
}  // namespace softfinger::internal
