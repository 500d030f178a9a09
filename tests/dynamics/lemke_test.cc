// Lemke's algorithm on a raw (M, q): problems with solutions known by hand or by construction, and
// problems without any.
#include "softfinger/dynamics/facets/lemke.h"

#include <gtest/gtest.h>

#include <random>

#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Rounding of a solve of tens of unknowns in equilibrated units.
constexpr double kRoundOff = 1e-12;

struct Problem {
  MatrixXd matrix;
  VectorXd constant, solution;
};

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double uniform(double lowest, double highest) {
    return lowest + (highest - lowest) * std::generate_canonical<double, 53>(engine_);
  }
  MatrixXd matrix(int rows, int columns) {
    return MatrixXd::NullaryExpr(rows, columns, [this] { return uniform(-1, 1); });
  }

  /// M = B^T B + a skew matrix + a diagonal: positive definite, so a P-matrix, not symmetric. First
  /// z and w, complementary, then q.
  Problem with_known_solution(int n) {
    const MatrixXd root = matrix(n, n), other = matrix(n, n);
    Problem problem;
    problem.matrix = root.transpose() * root + other - other.transpose();
    problem.matrix.diagonal().array() += 0.1;
    problem.solution.setZero(n);
    VectorXd w = VectorXd::Zero(n);
    for (int i = 0; i < n; ++i) (uniform(0, 1) < 0.5 ? problem.solution : w)[i] = uniform(0.1, 1);
    problem.constant = w - problem.matrix * problem.solution;
    return problem;
  }

 private:
  std::mt19937_64 engine_;
};

LcpResult solve(const MatrixXd& matrix, const VectorXd& constant, VectorXd& z) {
  z.setConstant(constant.size(), -1);
  return LemkeSolver(int(constant.size())).solve(matrix, constant, z);
}

TEST(Lemke, SolvesByHandCottlePangStoneExample) {
  // min x² + y² - x y - 3 x + 0 y, x, y >= 0: z = (3/2, 0) would leave w_2 = -3/2; z = (2, 1).
  const MatrixXd matrix = (MatrixXd(2, 2) << 2, -1, -1, 2).finished();
  VectorXd z;
  const LcpResult result = solve(matrix, Eigen::Vector2d(-3, 0), z);
  EXPECT_EQ(result.status, LcpStatus::solved);
  EXPECT_LE(result.residual, kRoundOff);
  EXPECT_NEAR(z[0], 2, kRoundOff);
  EXPECT_NEAR(z[1], 1, kRoundOff);
}

TEST(Lemke, TakesZeroWhereItSolves) {
  VectorXd z;
  const LcpResult result = solve(-MatrixXd::Identity(3, 3), Eigen::Vector3d(1, 0, 2), z);
  EXPECT_EQ(result.status, LcpStatus::solved);
  EXPECT_EQ(z, Eigen::VectorXd::Zero(3));
}

TEST(Lemke, SolvesALinearProgramme) {
  // min -x - y, x + 2 y <= 4, 3 x + y <= 6: (1.6, 1.2), duals (0.4, 0.2). M is skew:
  // copositive-plus.
  MatrixXd matrix = MatrixXd::Zero(4, 4);
  const Eigen::Matrix2d rows = (Eigen::Matrix2d() << 1, 2, 3, 1).finished();
  matrix.topRightCorner(2, 2) = rows.transpose();
  matrix.bottomLeftCorner(2, 2) = -rows;
  VectorXd z;
  const LcpResult result = solve(matrix, Eigen::Vector4d(-1, -1, 4, 6), z);
  ASSERT_EQ(result.status, LcpStatus::solved);
  EXPECT_LE((z - Eigen::Vector4d(1.6, 1.2, 0.4, 0.2)).norm(), kRoundOff);
}

TEST(Lemke, FindsTheSolutionOfRandomPositiveDefiniteProblems) {
  Random random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const int n = 1 + trial % 60;
    const Problem problem = random.with_known_solution(n);
    VectorXd z;
    const LcpResult result = solve(problem.matrix, problem.constant, z);
    ASSERT_EQ(result.status, LcpStatus::solved) << n;
    EXPECT_LE(result.residual, kRoundOff) << n;
    // The smallest eigenvalue is at least 0.1, the largest about n.
    EXPECT_LE((z - problem.solution).lpNorm<Eigen::Infinity>(), 1e-10) << n;
  }
}

TEST(Lemke, SolvesSemidefiniteProblemsOfLowRankWithTies) {
  // M = B^T B of rank 3, q = B^T c in its range plus what is feasible: a load shared in many ways.
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    const int n = 4 + trial % 40;
    MatrixXd root = random.matrix(3, n);
    for (int j = 1; j < n; j += 3) root.col(j) = root.col(0);  // the same contact several times
    const VectorXd constant = root.transpose() * random.matrix(3, 1);
    VectorXd z;
    const LcpResult result = solve(root.transpose() * root, constant, z);
    ASSERT_EQ(result.status, LcpStatus::solved) << trial;
    EXPECT_LE(result.residual, 1e-10) << trial;
  }
}

TEST(Lemke, ProvesInfeasibilityByFarkas) {
  // w_1 = z_2 - 1, w_2 = -z_2 - 1: never both >= 0.
  MatrixXd matrix = MatrixXd::Zero(3, 3);
  matrix(0, 1) = 1;
  matrix(1, 0) = -1;
  matrix(2, 2) = 1;
  LemkeSolver solver(3);
  const Eigen::Vector3d constant(-1, -1, -1);
  VectorXd z = VectorXd::Zero(3);
  const LcpResult result = solver.solve(matrix, constant, z);
  ASSERT_EQ(result.status, LcpStatus::infeasible_or_ray);
  ASSERT_EQ(result.proof, RayProof::infeasible);
  const VectorXd y = solver.ray();
  EXPECT_GE(y.minCoeff(), 0);
  EXPECT_LE((matrix.transpose() * y).maxCoeff(), kRoundOff * y.norm());
  EXPECT_LT(y.dot(constant), 0);
}

TEST(Lemke, ProvesRandomInfeasibleCopositivePlusProblems) {
  Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    // y > 0 in the kernel of the semi-definite M, q with y^T q < 0.
    const int n = 3 + trial % 20;
    const VectorXd y = random.matrix(n, 1).cwiseAbs().array() + 0.1;
    MatrixXd root = random.matrix(n, n);
    root -= root * y * y.transpose() / y.squaredNorm();
    const VectorXd constant = random.matrix(n, 1) - y / y.norm() * std::sqrt(double(n));
    VectorXd z;
    const LcpResult result = solve(root.transpose() * root, constant, z);
    ASSERT_EQ(result.status, LcpStatus::infeasible_or_ray) << trial;
    EXPECT_EQ(result.proof, RayProof::infeasible) << trial;
  }
}

TEST(Lemke, DoesNotCallARayAProofWhereItIsNone) {
  // w = -z + 1 twice, coupled: z = (1, 0) etc. solve it; q_2 < 0 with M_22 < 0 has no solution.
  const MatrixXd matrix = (MatrixXd(2, 2) << 1, 0, 1, -1).finished();
  VectorXd z;
  const LcpResult result = solve(matrix, Eigen::Vector2d(1, -1), z);
  EXPECT_NE(result.status, LcpStatus::solved);
  EXPECT_NE(result.proof, RayProof::infeasible);  // z_1 = 2, z_2 = 0 is feasible
}

TEST(Lemke, DoesNotDependOnUnits) {
  Random random(4);
  for (int trial = 0; trial < 40; ++trial) {
    const int n = 2 + trial;
    const Problem problem = random.with_known_solution(n);
    VectorXd z;
    const LcpResult plain = solve(problem.matrix, problem.constant, z);
    for (const double of_matrix : {1e-6, 1.0, 1e6})
      for (const double of_constant : {1e-6, 1.0, 1e6}) {
        VectorXd scaled;
        const LcpResult result =
            solve(of_matrix * problem.matrix, of_constant * problem.constant, scaled);
        EXPECT_EQ(result.status, plain.status);
        EXPECT_EQ(result.pivots, plain.pivots);
        EXPECT_LE((scaled * (of_matrix / of_constant) - z).lpNorm<Eigen::Infinity>(), 1e-12 * n);
      }
    // Each unknown and each row in units of its own.
    VectorXd rows(n), columns(n);
    for (int i = 0; i < n; ++i) {
      rows[i] = std::pow(10, random.uniform(-6, 6));
      columns[i] = std::pow(10, random.uniform(-6, 6));
    }
    VectorXd scaled;
    const LcpResult result = solve(rows.asDiagonal() * problem.matrix * columns.asDiagonal(),
                                   rows.cwiseProduct(problem.constant), scaled);
    ASSERT_EQ(result.status, LcpStatus::solved);
    EXPECT_LE((columns.cwiseProduct(scaled) - problem.solution).lpNorm<Eigen::Infinity>(), 1e-10);
  }
}

TEST(Lemke, RepeatsItselfExactly) {
  Random random(5);
  LemkeSolver solver(50);
  const Problem problem = random.with_known_solution(50), other = random.with_known_solution(30);
  VectorXd first(50), between(30), second(50);
  const LcpResult before = solver.solve(problem.matrix, problem.constant, first);
  solver.solve(other.matrix, other.constant, between);
  const LcpResult after = solver.solve(problem.matrix, problem.constant, second);
  EXPECT_EQ(before.pivots, after.pivots);
  EXPECT_EQ(first, second);
}

TEST(Lemke, RefusesWhatIsNoProblem) {
  LemkeSolver solver(2);
  VectorXd z(2), long_z(3);
  EXPECT_THROW(solver.solve(MatrixXd::Identity(2, 3), VectorXd::Zero(2), z), InputError);
  EXPECT_THROW(solver.solve(MatrixXd::Identity(3, 3), VectorXd::Zero(3), long_z), InputError);
  EXPECT_THROW(solver.solve(MatrixXd::Identity(2, 2), Eigen::Vector2d(1, NAN), z), InputError);
}

}  // namespace
}  // namespace softfinger
