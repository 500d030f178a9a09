// Exact friction: single contacts with answers in closed form, the limit between holding and
// slipping, invariants of random scenes.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

constexpr double kRoundOff = 1e-12;

LcpResult solve(const ContactLcp& problem, ContactSolution& solution) {
  return ContactLcpSolver(problem.contacts(), 0).solve(problem, solution);
}

/// A body on the floor at one point below its centre: mass 2 kg, 0.5 kg m² about the normal.
ContactLcp block_on_floor(const Eigen::Vector4d& velocity, double friction, double eccentricity_m) {
  ContactLcp problem;
  problem.delassus = Eigen::Vector4d(0.5, 0.5, 0.5, 2).asDiagonal();
  problem.free_velocity = velocity;
  problem.friction_coefficient.setConstant(1, friction);
  problem.eccentricity_m.setConstant(1, eccentricity_m);
  problem.friction_rule = FrictionRule::ellipsoid;
  return problem;
}

/// Two fingers, prescribed and far too heavy to be moved, hold a body of 1 kg between them with
/// 10 N for a step of 1 ms; `force` and `torque` are the load over their common limit mu P, e_n mu
/// P at both contacts.
struct Pinch {
  static constexpr double kStep_s = 1e-3, kGrip_N = 10, kFriction = 0.8, kArm_m = 0.004;

  explicit Pinch(double force, double torque) {
    // Normals face each other; spring-like fingers: the grip is a free velocity of light fingers
    // that must be stopped by P = grip * step. Rows: normal, t1, t2, spin of contacts 0 and 1.
    const double inverse_mass = 1, inverse_inertia = 1 / 4e-4, finger = 1e-2;
    Eigen::Matrix<double, 8, 6> body = Eigen::Matrix<double, 8, 6>::Zero();
    for (int i = 0; i < 2; ++i) {
      const double side = i == 0 ? 1 : -1;
      body(4 * i, 0) = side;
      body(4 * i + 1, 1) = 1;
      body(4 * i + 2, 2) = side;
      body(4 * i + 3, 3) = side;
    }
    Eigen::Matrix<double, 6, 1> inverse;
    inverse << inverse_mass, inverse_mass, inverse_mass, inverse_inertia, inverse_inertia,
        inverse_inertia;
    problem.delassus = body * inverse.asDiagonal() * body.transpose();
    // Fingers that move along the normal alone: a large mass each.
    problem.delassus(0, 0) += finger;
    problem.delassus(4, 4) += finger;
    const double impulse = kGrip_N * kStep_s, limit = 2 * kFriction * impulse;
    Eigen::Matrix<double, 6, 1> velocity = Eigen::Matrix<double, 6, 1>::Zero();
    velocity[1] = force * limit * inverse_mass;
    velocity[3] = torque * limit * kArm_m * inverse_inertia;
    problem.free_velocity = body * velocity;
    problem.free_velocity[0] -= impulse * finger;
    problem.free_velocity[4] -= impulse * finger;
    problem.friction_coefficient.setConstant(2, kFriction);
    problem.eccentricity_m.setConstant(2, kArm_m);
    problem.friction_rule = FrictionRule::ellipsoid;
  }
  ContactLcp problem;
};

TEST(ExactFriction, SlidesAgainstTheVelocityOfASingleContact) {
  // Isotropic in the scaled space: e² 2 = 0.5 for e = 0.5 m. Friction is against the free slip.
  const Eigen::Vector3d slip(0.8, -0.6, 0.5 * 3);  // with e omega
  ContactSolution solution;
  const LcpResult result = solve(block_on_floor({-0.3, 0.8, -0.6, 3}, 0.7, 0.5), solution);
  ASSERT_EQ(result.status, LcpStatus::solved);
  const Eigen::Vector3d wrench = -0.7 * 0.6 * slip.normalized();
  EXPECT_NEAR(solution.impulse[0], 0.6, kRoundOff);
  EXPECT_NEAR(solution.impulse[1], wrench.x(), kRoundOff);
  EXPECT_NEAR(solution.impulse[2], wrench.y(), kRoundOff);
  EXPECT_NEAR(solution.impulse[3], 0.5 * wrench.z(), kRoundOff);
  EXPECT_NEAR(solution.slip[0], slip.norm() - 0.5 * 0.7 * 0.6, kRoundOff);
}

TEST(ExactFriction, PinchHoldsToTheLimitAndSlipsBeyondIt) {
  for (const double force : {0., 0.6, 0.8, 0.95}) {
    const double torque = std::sqrt(1 - force * force);
    ContactSolution solution;
    const Pinch below(force * 0.999999, torque * 0.999999);
    const LcpResult held = solve(below.problem, solution);
    ASSERT_EQ(held.status, LcpStatus::solved) << force;
    EXPECT_LE(std::abs(solution.velocity[3]), 1e-10) << force;
    EXPECT_LE(std::abs(solution.velocity[1]), 1e-12) << force;
    const Pinch above(force * 1.000001, torque * 1.000001);
    const LcpResult slipped = solve(above.problem, solution);
    ASSERT_EQ(slipped.status, LcpStatus::solved) << force;
    // 1e-6 of the limit turns the body by itself.
    const double excess = 1e-6 * torque * 2 * Pinch::kFriction * Pinch::kGrip_N * Pinch::kStep_s *
                          Pinch::kArm_m / 4e-4;
    EXPECT_GE(solution.velocity[3], 0.1 * excess) << force;
  }
}

TEST(ExactFriction, NoRandomSceneFails) {
  tests::RandomScenes scenes(21);
  ContactLcpSolver solver(12, 0);
  ContactSolution solution;
  for (int trial = 0; trial < 300; ++trial) {
    ContactLcp problem = scenes.next(1 + trial % 12, 16);
    problem.friction_rule = FrictionRule::ellipsoid;
    ASSERT_EQ(solver.solve(problem, solution).status, LcpStatus::solved) << trial;
    EXPECT_LE(exact_contact_residual(problem, solution), 1e-10) << trial;
  }
}

}  // namespace
}  // namespace softfinger
