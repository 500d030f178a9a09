#include "softfinger/dynamics/exact/velocity_factor.h"

#include <gtest/gtest.h>

#include <limits>

#include "softfinger/input/errors.h"
#include "tests/dynamics/random_scene.h"

namespace softfinger::internal {
namespace {

/// C L L^T, but for the rows of friction that does nothing: these stay zero.
Eigen::MatrixXd product(const VelocityFactor& factor, int contacts) {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(4 * contacts, factor.rank());
  Eigen::VectorXd units(4 * contacts);
  for (int i = 0; i < contacts; ++i) {
    for (int k = 0; k < factor.rank(); ++k) {
      Eigen::Vector4d column;
      factor.rows().multiply(i, Eigen::VectorXd::Unit(factor.rank(), k), column.data());
      rows.block<4, 1>(4 * i, k) = column;
    }
    units.segment<4>(4 * i) = factor.unit(i);
  }
  return units.asDiagonal() * rows * rows.transpose();
}

/// Six columns per body, against the W that comes with them.
TEST(VelocityFactor, IsThatOfTheBodiesWhereTheyAreKnown) {
  constexpr int kMany = 40;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    tests::RandomScenes scenes(seed);
    scenes.gives_roots = true;
    const ContactLcp problem = scenes.next(kMany, 16);
    ContactOperator contacts(kMany);
    contacts.set(problem, 0);
    ASSERT_TRUE(contacts.given_root()) << seed;
    VelocityFactor factor(kMany);
    factor.factorise(contacts);
    EXPECT_LE(factor.rank(), problem.root.cols());
    const Eigen::MatrixXd found = product(factor, kMany);
    for (int i = 0; i < kMany; ++i) {
      EXPECT_LE(factor.rows().column_count(i), 12) << seed;  // of two bodies
      for (int j = 0; j < kMany; ++j) {
        const int rows = contacts.has_friction(i) ? 4 : 1,
                  columns = contacts.has_friction(j) ? 4 : 1;
        for (int a = 4 * i; a < 4 * i + rows; ++a)
          for (int b = 4 * j; b < 4 * j + columns; ++b) {
            // Rounding of six products each, of which no row has larger ones than its own.
            const Eigen::MatrixXd& delassus = contacts.delassus();
            const double size = std::sqrt(delassus(a, a) * delassus(b, b));
            const double units = std::sqrt(factor.unit(i)[a % 4] / factor.unit(j)[b % 4]);
            EXPECT_NEAR(found(a, b), delassus(a, b), 100 * 0x1p-52 * size * units) << seed;
          }
      }
    }
  }
}

TEST(VelocityFactor, IsNotTheRootThatHasMoreColumnsThanW) {
  tests::RandomScenes scenes(3);
  scenes.gives_roots = true;
  ContactLcp problem;
  do problem = scenes.next(2, 16);
  while (problem.root.cols() < 8);
  ContactOperator contacts(2);
  contacts.set(problem, 0);
  EXPECT_FALSE(contacts.given_root());
}

TEST(VelocityFactor, RefusesARootThatDoesNotFit) {
  tests::RandomScenes scenes(4);
  scenes.gives_roots = true;
  ContactLcp problem = scenes.next(20, 16);
  problem.friction_rule = FrictionRule::ellipsoid;
  ContactLcpSolver solver(20, 0);
  ContactSolution solution;
  const ContactLcp good = problem;
  problem.root.conservativeResize(79, good.root.cols());
  EXPECT_THROW(solver.solve(problem, solution), InputError);
  problem.root = good.root;
  problem.root.coeffRef(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(solver.solve(problem, solution), InputError);
  // One of another problem is of no use, and does no harm.
  problem.root = 3 * good.root;
  EXPECT_EQ(solver.solve(problem, solution).status, LcpStatus::solved);
  EXPECT_LE(exact_contact_residual(problem, solution), 1e-10);
}

}  // namespace
}  // namespace softfinger::internal
