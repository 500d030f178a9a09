#include "fem/friction/coulomb_friction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace softfinger::fem {
namespace {

using Eigen::Index;

/// Random positive definite with a condition of about 1e2 to 1e3.
Eigen::MatrixXd random_plane_compliance(Index points, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(
      2 * points, 2 * points, [&](Index, Index) { return normal(random); });
  return root * root.transpose() + Eigen::MatrixXd::Identity(2 * points, 2 * points);
}

TEST(CoulombFriction, SticksBelowItsLimit) {
  std::mt19937_64 random(1);
  const Eigen::MatrixXd compliance = random_plane_compliance(5, random);
  const Eigen::VectorXd target = Eigen::VectorXd::LinSpaced(10, -1, 2);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(10);
  solve_friction(compliance, Eigen::VectorXd::Constant(5, 1e6), target, force);
  EXPECT_LT((compliance * force - target).norm(), 1e-9 * target.norm());
}

TEST(CoulombFriction, OfOneSlippingPointIsItsLimitAgainstTheMotion) {
  const Eigen::MatrixXd compliance = 0.5 * Eigen::MatrixXd::Identity(2, 2);
  const Eigen::Vector2d target(3, -4);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(2);
  solve_friction(compliance, Eigen::VectorXd::Constant(1, 2), target, force);
  EXPECT_LT((force - 2 * target.normalized()).norm(), 1e-9);
}

TEST(CoulombFriction, ObeysTheLawAtEveryPoint) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 30; ++trial) {
    const Index points = 2 + trial;
    const Eigen::MatrixXd compliance = random_plane_compliance(points, random);
    const Eigen::VectorXd limit =
        Eigen::VectorXd::NullaryExpr(points, [&](Index) { return 0.1 * uniform(random); });
    const Eigen::VectorXd target =
        Eigen::VectorXd::NullaryExpr(2 * points, [&](Index) { return 4 * uniform(random) - 2; });
    Eigen::VectorXd force = Eigen::VectorXd::Zero(2 * points);
    const FrictionSolution solution = solve_friction(compliance, limit, target, force);
    const Eigen::VectorXd slip = target - compliance * force;
    // The solver states its worst violation; ten times it leaves room for another norm.
    const double tolerance = 10 * solution.residual * target.cwiseAbs().maxCoeff() + 1e-12;
    EXPECT_LT(solution.residual, 1e-6);
    for (Index i = 0; i < points; ++i) {
      const Eigen::Vector2d q = force.segment<2>(2 * i), s = slip.segment<2>(2 * i);
      EXPECT_LE(q.norm(), limit[i] * (1 + 1e-9));
      if (q.norm() < limit[i] * (1 - 1e-9)) {
        EXPECT_LE(s.norm(), tolerance) << "sticks, point " << i;
      } else {
        EXPECT_LE((s - s.dot(q.normalized()) * q.normalized()).norm(), tolerance) << "point " << i;
        EXPECT_GE(s.dot(q), -tolerance * q.norm()) << "point " << i;
      }
    }
  }
}

TEST(CoulombFriction, DoesNotDependOnTheFirstGuess) {
  std::mt19937_64 random(3);
  const Eigen::MatrixXd compliance = random_plane_compliance(12, random);
  const Eigen::VectorXd limit = Eigen::VectorXd::LinSpaced(12, 0.01, 0.1);
  const Eigen::VectorXd target = Eigen::VectorXd::LinSpaced(24, -1, 3);
  Eigen::VectorXd first = Eigen::VectorXd::Zero(24), second = Eigen::VectorXd::Constant(24, 0.05);
  const double residual = std::max(solve_friction(compliance, limit, target, first).residual,
                                   solve_friction(compliance, limit, target, second).residual);
  // The compliance's smallest eigenvalue is at least 1: forces differ by no more than residuals.
  EXPECT_LT((first - second).norm(), 10 * residual * target.norm() + 1e-12);
}

TEST(CoulombFriction, KeepsItsFactorWhileTheSamePointsStickAndSlip) {
  std::mt19937_64 random(5);
  const Eigen::MatrixXd compliance = random_plane_compliance(20, random);
  Eigen::VectorXd limit = Eigen::VectorXd::LinSpaced(20, 0.001, 0.1);
  const Eigen::VectorXd target = Eigen::VectorXd::LinSpaced(40, -1, 3);
  Eigen::VectorXd kept_force = Eigen::VectorXd::Zero(40);
  StickSlipFactor kept;
  solve_friction(compliance, limit, target, kept_force, &kept);
  const auto lower = [&]() -> Eigen::MatrixXf {
    return kept.factor.triangularView<Eigen::Lower>();  // nothing sets the other one
  };
  const Eigen::MatrixXf factor = lower();
  const std::vector<bool> slips = kept.slips;
  ASSERT_GT(std::count(slips.begin(), slips.end(), true), 0);
  ASSERT_GT(std::count(slips.begin(), slips.end(), false), 0);
  limit *= 1 + 1e-5;
  const double residual = solve_friction(compliance, limit, target, kept_force, &kept).residual;
  EXPECT_EQ(lower(), factor) << "nothing was factorised";
  EXPECT_EQ(kept.slips, slips);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(40);
  solve_friction(compliance, limit, target, force);
  EXPECT_LT((force - kept_force).norm(), 10 * (residual + 1e-9) * target.norm());
  // Other points slip: the factor is replaced.
  limit /= 10;
  solve_friction(compliance, limit, target, kept_force, &kept);
  solve_friction(compliance, limit, target, force);
  EXPECT_NE(kept.slips, slips);
  EXPECT_LT((force - kept_force).norm(), 1e-7 * target.norm());
}

TEST(CoulombFriction, FollowsPointsThatComeIntoContactAndLeaveIt) {
  std::mt19937_64 random(6);
  const Eigen::MatrixXd compliance = random_plane_compliance(12, random);
  const Eigen::VectorXd target = Eigen::VectorXd::LinSpaced(24, -1, 3);
  Eigen::VectorXd kept_force = Eigen::VectorXd::Zero(24);
  StickSlipFactor kept;
  for (const Eigen::Index first : {4, 6, 0, 3}) {
    Eigen::VectorXd limit = Eigen::VectorXd::Zero(12);
    limit.segment(first, 6).setLinSpaced(0.01, 0.2);
    solve_friction(compliance, limit, target, kept_force, &kept);
    Eigen::VectorXd force = Eigen::VectorXd::Zero(24);
    solve_friction(compliance, limit, target, force);
    EXPECT_LT((force - kept_force).norm(), 1e-7 * target.norm()) << first;
    EXPECT_EQ(kept_force.head(2 * first).norm(), 0);
    EXPECT_EQ(kept_force.tail(24 - 2 * (first + 6)).norm(), 0);
  }
}

TEST(CoulombFriction, HasNoForceWhereNothingPresses) {
  std::mt19937_64 random(4);
  Eigen::VectorXd limit = Eigen::VectorXd::Constant(4, 0.1);
  limit[2] = 0;
  Eigen::VectorXd force = Eigen::VectorXd::Ones(8);
  solve_friction(random_plane_compliance(4, random), limit, Eigen::VectorXd::Ones(8), force);
  EXPECT_EQ(force.segment<2>(4).norm(), 0);
}

TEST(CoulombFriction, LeavesAComponentThatAMirrorFixesWithoutForce) {
  Eigen::MatrixXd compliance = Eigen::MatrixXd::Zero(2, 2);
  compliance(0, 0) = 2;
  const Eigen::Vector2d target(1, 0.3);
  Eigen::VectorXd force = Eigen::Vector2d(0.1, 0.1);
  solve_friction(compliance, Eigen::VectorXd::Constant(1, 10), target, force);
  EXPECT_DOUBLE_EQ(force[0], 0.5);
  EXPECT_EQ(force[1], 0);
  solve_friction(compliance, Eigen::VectorXd::Constant(1, 0.2), target, force);
  EXPECT_DOUBLE_EQ(force[0], 0.2);
  EXPECT_EQ(force[1], 0);
}

}  // namespace
}  // namespace softfinger::fem
