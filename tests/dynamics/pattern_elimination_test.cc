#include "softfinger/dynamics/exact/pattern_elimination.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "softfinger/math/wide.h"
#include "tests/dynamics/random_scene.h"

namespace softfinger::internal {
namespace {

constexpr int kRows = 4;

/// 1 and a sum of L_i^T A_i L_i, with its pattern: L_i has the columns of two bodies, six each.
struct Sum {
  Sum(tests::RandomScenes& random, int bodies, int contacts)
      : size(kBody * bodies), rows(std::max(contacts, size)), pattern(size) {
    dense = Eigen::MatrixXd::Identity(size, size);
    for (int i = 0; i < contacts; ++i) {
      Eigen::MatrixXd of_columns = Eigen::MatrixXd::Zero(kRows, size);
      for (int side = 0; side < 2; ++side) {
        const int first = kBody * int(random.uniform(0, bodies));
        of_columns.middleCols<kBody>(first) = matrix<kRows, kBody>(random);
      }
      rows.append(kRows, size, [&](int k) { return of_columns.col(k).data(); });
      // Sliding friction makes A asymmetric, and little else.
      const Eigen::Matrix4d root = matrix<kRows, kRows>(random);
      own.push_back(root * root.transpose() + 0.3 * matrix<kRows, kRows>(random));
      dense += of_columns.transpose() * own.back() * of_columns;
    }
    pattern.set(rows, size);
  }

  template <int height, int width>
  static Eigen::Matrix<double, height, width> matrix(tests::RandomScenes& random) {
    return Eigen::Matrix<double, height, width>::NullaryExpr(
        [&random] { return random.uniform(-1, 1); });
  }

  static constexpr int kBody = 6;
  int size;
  ContactRows rows;
  EliminationPattern pattern;
  std::vector<Eigen::Matrix4d> own;
  Eigen::MatrixXd dense;
};

Eigen::VectorXd solve(PatternElimination& elimination, const Sum& sum, Eigen::VectorXd right) {
  elimination.set(sum.pattern);
  PatternElimination::Matrix matrix = elimination.identity();
  for (int i = 0; i < sum.rows.contacts(); ++i)
    sum.rows.add_product(i, sum.own[std::size_t(i)].data(), matrix);
  EXPECT_TRUE(elimination.factorise());
  elimination.substitute(right);
  return right;
}

/// One object solves them all, larger ones and smaller ones in turn.
TEST(PatternElimination, SolvesAsEigenDoes) {
  constexpr int kMostBodies = 20;
  tests::RandomScenes random(7);
  PatternElimination elimination(Sum::kBody * kMostBodies);
  for (int n = 0; n < 60; ++n) {
    const int bodies = n % 2 == 0 ? kMostBodies : 1 + n % kMostBodies;
    const Sum sum(random, bodies, 1 + int(random.uniform(0, 3 * bodies)));
    const Eigen::VectorXd right =
        Eigen::VectorXd::NullaryExpr(sum.size, [&] { return random.uniform(-1, 1); });
    const Eigen::FullPivLU<Eigen::MatrixXd> reference(sum.dense);
    const Eigen::VectorXd expected = reference.solve(right);
    // Without exchanges elements may grow: by less than a hundred here.
    EXPECT_LE((solve(elimination, sum, right) - expected).norm(),
              100 * 0x1p-52 / reference.rcond() * expected.norm())
        << n;
  }
}

TEST(PatternElimination, HasTheSameBitsWithoutWideInstructions) {
  tests::RandomScenes random(8);
  for (int bodies = 1; bodies <= 12; ++bodies) {
    const Sum sum(random, bodies, 2 * bodies);
    PatternElimination elimination(sum.size);
    const Eigen::VectorXd right = Eigen::VectorXd::Ones(sum.size);
    const Eigen::VectorXd wide = solve(elimination, sum, right);
    const bool had_wide_instructions = std::exchange(has_wide_instructions, false);
    EXPECT_EQ(solve(elimination, sum, right), wide) << bodies;
    has_wide_instructions = had_wide_instructions;
  }
}

/// Below 1e-8 of its column, in the group and below it.
TEST(PatternElimination, RefusesPivotsThatAreTooSmall) {
  tests::RandomScenes random(9);
  Sum sum(random, 2, 1);
  while (sum.pattern.rows(5).count == 0) sum = Sum(random, 2, 1);  // a contact of both bodies
  PatternElimination elimination(sum.size);
  elimination.set(sum.pattern);
  const auto is_accepted = [&](int row, int pivot, double ratio) {
    PatternElimination::Matrix matrix = elimination.identity();
    matrix(row, pivot) = 1 / ratio;
    return elimination.factorise();
  };
  for (const int pivot : {0, 2, 4})
    for (const int row : {5, 6, sum.size - 1}) {
      EXPECT_TRUE(is_accepted(row, pivot, 1.1e-8)) << row << ' ' << pivot;
      EXPECT_FALSE(is_accepted(row, pivot, 0.9e-8)) << row << ' ' << pivot;
      EXPECT_FALSE(is_accepted(row, pivot, -0.9e-8)) << row << ' ' << pivot;
      EXPECT_FALSE(is_accepted(row, pivot, std::numeric_limits<double>::quiet_NaN()));
    }
  for (const int pivot : {0, 7, sum.size - 1})
    for (const double value : {0., std::numeric_limits<double>::quiet_NaN()}) {
      elimination.identity()(pivot, pivot) = value;
      EXPECT_FALSE(elimination.factorise()) << pivot << " " << value;
    }
}

}  // namespace
}  // namespace softfinger::internal
