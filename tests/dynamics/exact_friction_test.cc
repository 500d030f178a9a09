// Exact friction: single contacts with answers in closed form, the limit between holding and
// slipping, invariants of random scenes.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

constexpr double kExactRoundOff = 1e-12;

/// The equation that defines it: nu + A P nu/|nu| = target, over twelve decades of A and P.
TEST(FrictionExcess, ReachesBeyondTheEllipsoidByWhatIsMissing) {
  tests::RandomScenes random(8);
  for (int trial = 0; trial < 20000; ++trial) {
    const auto decades = [&random] { return std::pow(10, random.uniform(-6, 6)); };
    const Eigen::Vector3d metric(decades(), decades(), decades());
    const double radius = decades();
    const Eigen::Vector3d inside = radius * metric;
    Eigen::Vector3d target;
    for (int axis = 0; axis < 3; ++axis) target[axis] = random.uniform(-1, 1) * 3 * inside[axis];
    if (trial % 3 == 0) target[trial % 2] *= decades();
    const FrictionExcess found = friction_excess(nullptr, target, radius, metric);
    const double length = found.excess.norm();
    if (!(length > 0)) {
      EXPECT_LE(target.cwiseQuotient(inside).norm(), 1) << trial;
      continue;
    }
    const Eigen::Vector3d reached = found.excess + inside.cwiseProduct(found.excess / length);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(reached[axis], target[axis], 16 * 0x1p-52 * std::abs(target[axis]))
          << trial << ", axis " << axis;
  }
}

LcpResult solve_exactly(const ContactLcp& problem, ContactSolution& solution) {
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

/// A body of 1 kg between two fingers that press with 10 N from both sides for a step of 1 ms, and
/// hold still across the normal; its load in tangent 1, tangent 2 and about the normal, in units of
/// what both contacts carry together: 2 mu P, 2 mu P, 2 e_n mu P.
struct Pinch {
  static constexpr double kStep_s = 1e-3, kGrip_N = 10, kFriction = 0.8, kArm_m = 0.004;
  static constexpr double kMass_kg = 1, kInertia_kg_m2 = 4e-4, kFinger_kg = 100;

  explicit Pinch(const Eigen::Vector3d& load) {
    Eigen::Matrix<double, 8, 4> body = Eigen::Matrix<double, 8, 4>::Zero();
    const Eigen::Vector4d faces_other_way(-1, 1, -1, -1);
    body.topRows<4>().setIdentity();
    body.bottomRows<4>() = faces_other_way.asDiagonal();
    const Eigen::Vector4d inverse(1 / kMass_kg, 1 / kMass_kg, 1 / kMass_kg, 1 / kInertia_kg_m2);
    problem.delassus = body * inverse.asDiagonal() * body.transpose();
    problem.delassus(0, 0) += 1 / kFinger_kg;
    problem.delassus(4, 4) += 1 / kFinger_kg;
    const double limit = 2 * kFriction * kGrip_N * kStep_s;
    Eigen::Vector4d impulse = Eigen::Vector4d::Zero();
    impulse.tail<3>() = limit * Eigen::Vector3d(1, 1, kArm_m).cwiseProduct(load);
    problem.free_velocity = body * inverse.cwiseProduct(impulse);
    problem.free_velocity[0] -= kGrip_N * kStep_s / kFinger_kg;
    problem.free_velocity[4] -= kGrip_N * kStep_s / kFinger_kg;
    problem.friction_coefficient.setConstant(2, kFriction);
    problem.eccentricity_m.setConstant(2, kArm_m);
    problem.friction_rule = FrictionRule::ellipsoid;
  }
  /// The speed that a load this far beyond the limit leaves, were it a pure torque.
  static double spin_beyond(double excess) {
    return excess * 2 * kFriction * kGrip_N * kStep_s * kArm_m / kInertia_kg_m2;
  }
  ContactLcp problem;
};

TEST(ExactFriction, SlidesAgainstTheVelocityOfASingleContact) {
  // Isotropic in the scaled space: e² 2 = 0.5 for e = 0.5 m. Friction is against the free slip.
  const Eigen::Vector3d slip(0.8, -0.6, 0.5 * 3);  // with e omega
  ContactSolution solution;
  const LcpResult result = solve_exactly(block_on_floor({-0.3, 0.8, -0.6, 3}, 0.7, 0.5), solution);
  ASSERT_EQ(result.status, LcpStatus::solved);
  const Eigen::Vector3d wrench = -0.7 * 0.6 * slip.normalized();
  EXPECT_NEAR(solution.impulse[0], 0.6, kExactRoundOff);
  EXPECT_NEAR(solution.impulse[1], wrench.x(), kExactRoundOff);
  EXPECT_NEAR(solution.impulse[2], wrench.y(), kExactRoundOff);
  EXPECT_NEAR(solution.impulse[3], 0.5 * wrench.z(), kExactRoundOff);
  EXPECT_NEAR(solution.slip[0], slip.norm() - 0.5 * 0.7 * 0.6, kExactRoundOff);
}

TEST(ExactFriction, PinchHoldsToTheLimitAndSlipsBeyondIt) {
  for (const double force : {0., 0.6, 0.8, 0.95}) {
    const Eigen::Vector3d limit(force, 0, std::sqrt(1 - force * force));
    ContactSolution solution;
    ASSERT_EQ(solve_exactly(Pinch(0.999999 * limit).problem, solution).status, LcpStatus::solved);
    EXPECT_LE(std::abs(solution.velocity[3]), 1e-10) << force;
    EXPECT_LE(std::abs(solution.velocity[1]), 1e-12) << force;
    ASSERT_EQ(solve_exactly(Pinch(1.000001 * limit).problem, solution).status, LcpStatus::solved);
    EXPECT_GE(solution.velocity[3], 0.1 * Pinch::spin_beyond(1e-6)) << force;
  }
}

TEST(ExactFriction, PinchHoldsToTheLimitSurfaceGiven) {
  const SixPatchShape six(0.4, 0.5);
  const LimitSurfaceShape exact(0.4, 1);
  for (const FrictionShape* shape :
       {static_cast<const FrictionShape*>(&six), static_cast<const FrictionShape*>(&exact)})
    for (const double force : {0., 0.6, 0.8, 0.95}) {
      const Eigen::Vector3d load(force, 0, std::sqrt(1 - force * force));
      const Eigen::Vector3d limit = load / friction_gauge(shape, load);
      for (const double factor : {0.999999, 1.000001}) {
        ContactLcp problem = Pinch(factor * limit).problem;
        problem.friction_rule = FrictionRule::limit_surface;
        problem.shapes.assign(2, shape);
        ContactSolution solution;
        ASSERT_EQ(solve_exactly(problem, solution).status, LcpStatus::solved) << force;
        if (factor < 1) {
          EXPECT_LE(std::abs(solution.velocity[3]), 1e-10) << force;
        } else {
          EXPECT_GE(solution.velocity[3], 0.1 * Pinch::spin_beyond(1e-6)) << force;
        }
      }
    }
}

TEST(ExactFriction, SlidesByTheRuleOfTheSurfaceGiven) {
  // Steady state of a single contact: the wrench is minus that of the twist it slides with.
  const LimitSurface surface(0.5, 0.2, 0.5, 1);
  const LimitSurfaceShape shape(0.4, 0.5);
  ContactLcp problem = block_on_floor({-0.3, 0.8, -0.6, 3}, 0.7, surface.eccentricity_m());
  problem.friction_rule = FrictionRule::limit_surface;
  problem.shapes = {&shape};
  ContactSolution solution;
  ASSERT_EQ(solve_exactly(problem, solution).status, LcpStatus::solved);
  const Twist twist{solution.velocity[1], solution.velocity[2], solution.velocity[3]};
  const LimitWrench wrench = surface.wrench_for_twist(twist);
  const double limit = 0.7 * solution.impulse[0];
  EXPECT_GT(solution.slip[0], 0.1);
  EXPECT_NEAR(solution.impulse[1], -limit * wrench.force_x_N, 1e-11);
  EXPECT_NEAR(solution.impulse[2], -limit * wrench.force_y_N, 1e-11);
  EXPECT_NEAR(solution.impulse[3], -limit * wrench.torque_Nm, 1e-11);
}

TEST(ExactFriction, IsTheLimitOfManyFacets) {
  // Well-conditioned, little friction: velocities are unique. 1000 vertices reach 99.7 % of the
  // ellipsoid.
  tests::RandomScenes scenes(22);
  for (int trial = 0; trial < 20; ++trial) {
    ContactLcp problem = tests::separate_contacts(scenes, 6);
    ContactSolution exact, facets;
    problem.friction_rule = FrictionRule::ellipsoid;
    ASSERT_EQ(solve_exactly(problem, exact).status, LcpStatus::solved);
    double last = 1;
    for (const int count : {16, 1000}) {
      problem.vertices = tests::friction_vertices(count);
      problem.friction_rule = FrictionRule::facets;
      ContactLcpSolver solver(6, count);
      ASSERT_EQ(solver.solve(problem, facets).status, LcpStatus::solved);
      const double error = (facets.velocity - exact.velocity).lpNorm<Eigen::Infinity>();
      EXPECT_LE(error, last) << trial;
      last = error + 1e-12;
    }
    EXPECT_LE(last, 0.05 * problem.free_velocity.lpNorm<Eigen::Infinity>()) << trial;
  }
}

TEST(ExactFriction, CarriesNoTorqueWithoutAnArm) {
  ContactSolution solution;
  ASSERT_EQ(solve_exactly(block_on_floor({-0.3, 0.8, -0.6, 3}, 0.7, 0), solution).status,
            LcpStatus::solved);
  EXPECT_NEAR(solution.impulse[1], -0.42 * 0.8, kExactRoundOff);
  EXPECT_NEAR(solution.impulse[2], 0.42 * 0.6, kExactRoundOff);
  EXPECT_EQ(solution.impulse[3], 0);
  EXPECT_NEAR(solution.velocity[3], 3, kExactRoundOff);
}

/// A body of 1 kg between two jaws of 1 kg each, pushed sideways and twisted: both contacts carry
/// half, however small the arm of their torque is.
TEST(ExactFriction, ContactsAcrossEachOtherShareForcesAndTorque) {
  constexpr double kLeastFelt_m = 1e-7;  // shorter arms move by less than the residual allows
  constexpr double kInertia_kg_m2 = 1e-3, kClosing_m_per_s = 0.1, kSideways_m_per_s = 0.02;
  for (const double arm_m : {1e-2, 1e-5, 1e-7, 1e-8, 1e-9, 1e-10}) {
    // Rows: along the normal, two tangents, about the normal. Columns: x, y, z, spin of the body.
    Eigen::Matrix<double, 8, 4> jacobian = Eigen::Matrix<double, 8, 4>::Zero();
    for (int i = 0; i < 2; ++i) {
      const double side = i == 0 ? 1 : -1;
      jacobian(4 * i, 2) = jacobian(4 * i + 2, 1) = jacobian(4 * i + 3, 3) = side;
      jacobian(4 * i + 1, 0) = 1;
    }
    const Eigen::Vector4d inverse_mass(1, 1, 1, 1 / kInertia_kg_m2);
    const double spin_rad_per_s = 0.5 * kSideways_m_per_s * arm_m / kInertia_kg_m2;
    ContactLcp problem;
    problem.friction_rule = FrictionRule::ellipsoid;
    problem.delassus = jacobian * inverse_mass.asDiagonal() * jacobian.transpose();
    problem.free_velocity = jacobian * Eigen::Vector4d(kSideways_m_per_s, 0, 0, spin_rad_per_s);
    for (int i = 0; i < 2; ++i) {
      problem.delassus(4 * i, 4 * i) += 1;  // of its jaw
      problem.free_velocity[4 * i] -= kClosing_m_per_s;
    }
    problem.friction_coefficient.setConstant(2, 0.5);
    problem.eccentricity_m.setConstant(2, arm_m);
    ContactSolution solution;
    ASSERT_EQ(solve_exactly(problem, solution).status, LcpStatus::solved) << arm_m;
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(solution.impulse[4 * i], kClosing_m_per_s, 1e-9 * kClosing_m_per_s) << arm_m;
      EXPECT_NEAR(solution.impulse[4 * i + 1], -kSideways_m_per_s / 2, 1e-9 * kSideways_m_per_s)
          << arm_m;
      if (arm_m < kLeastFelt_m) continue;
      const double torque_Nms = -kInertia_kg_m2 * spin_rad_per_s / 2 * (i == 0 ? 1 : -1);
      EXPECT_NEAR(solution.impulse[4 * i + 3], torque_Nms, 1e-6 * std::abs(torque_Nms)) << arm_m;
    }
  }
}

TEST(ExactFriction, TakesFrictionlessRowsUnderEveryRule) {
  // A joint's limit: one row that pushes the block sideways, its tangential rows of W zero; with
  // friction coefficient 0, and with one that has nothing to act on.
  for (const FrictionRule rule :
       {FrictionRule::facets, FrictionRule::ellipsoid, FrictionRule::limit_surface})
    for (const double friction : {0., 0.5}) {
      ContactLcp problem = block_on_floor({-0.3, -0.8, 0, 0}, 0.5, 0.01);
      problem.delassus.conservativeResizeLike(Eigen::MatrixXd::Zero(8, 8));
      problem.free_velocity.conservativeResizeLike(Eigen::VectorXd::Zero(8));
      problem.delassus(4, 4) = 0.5;
      problem.delassus(4, 1) = problem.delassus(1, 4) = 0.5;
      problem.free_velocity[4] = -0.8;
      problem.friction_coefficient = Eigen::Vector2d(0.5, friction);
      problem.eccentricity_m = Eigen::Vector2d(0.01, 0);
      problem.friction_rule = rule;
      problem.shapes.assign(2, nullptr);
      if (rule == FrictionRule::facets) problem.vertices = tests::friction_vertices(16);
      ContactSolution solution;
      ContactLcpSolver solver(2, 16);
      const LcpResult result = solver.solve(problem, solution);
      ASSERT_EQ(result.status, LcpStatus::solved);
      EXPECT_LE(result.residual, kExactRoundOff);
      // The limit stops the block; friction and limit share what that takes, 1.6 N s.
      EXPECT_NEAR(solution.velocity[4], 0, kExactRoundOff);
      EXPECT_NEAR(solution.impulse[1] + solution.impulse[4], 1.6, kExactRoundOff);
      EXPECT_EQ(solution.impulse.tail<3>(), Eigen::Vector3d::Zero());
    }
}

TEST(ExactFriction, NeverGainsEnergyAndKeepsWithinTheLimit) {
  tests::RandomScenes scenes(23);
  for (int trial = 0; trial < 200; ++trial) {
    ContactLcp problem = scenes.next(1 + trial % 10, 16);
    problem.friction_rule = FrictionRule::ellipsoid;
    ContactSolution solution;
    ASSERT_EQ(solve_exactly(problem, solution).status, LcpStatus::solved);
    const double work = 0.5 * solution.impulse.dot(solution.velocity + problem.free_velocity);
    const double natural = solution.impulse.cwiseAbs().dot(problem.free_velocity.cwiseAbs());
    EXPECT_LE(work, 1e-10 * natural) << trial;
    for (int i = 0; i < problem.contacts(); ++i) {
      const double limit = problem.friction_coefficient[i] * solution.impulse[4 * i];
      const double force = solution.impulse.segment<2>(4 * i + 1).norm();
      const double torque = solution.impulse[4 * i + 3] / problem.eccentricity_m[i];
      EXPECT_LE(std::hypot(force, torque), limit * (1 + 1e-12)) << trial;
    }
  }
}

TEST(ExactFriction, DoesNotDependOnUnitsOfMassAndTime) {
  tests::RandomScenes scenes(24);
  for (int trial = 0; trial < 20; ++trial) {
    ContactLcp problem = tests::separate_contacts(scenes, 5);
    problem.friction_rule = FrictionRule::ellipsoid;
    ContactSolution solution, other;
    ASSERT_EQ(solve_exactly(problem, solution).status, LcpStatus::solved);
    for (const double of_mass : {1e-6, 1e6})
      for (const double of_velocity : {1e-6, 1e6}) {
        ContactLcp scaled = problem;
        scaled.delassus /= of_mass;
        scaled.free_velocity *= of_velocity;
        ASSERT_EQ(solve_exactly(scaled, other).status, LcpStatus::solved);
        EXPECT_LE((other.velocity / of_velocity - solution.velocity).norm(),
                  1e-9 * problem.free_velocity.norm());
      }
  }
}

TEST(ExactFriction, CertificateSeesEveryKindOfError) {
  ContactSolution solution;
  const ContactLcp problem = block_on_floor({-0.3, 0.8, -0.6, 3}, 0.7, 0.5);
  ASSERT_EQ(solve_exactly(problem, solution).status, LcpStatus::solved);
  EXPECT_LE(exact_contact_residual(problem, solution), kExactRoundOff);
  for (int row = 0; row < 4; ++row)
    for (const double factor : {0.999, 1.001}) {
      ContactSolution wrong = solution;
      wrong.impulse[row] *= factor;
      EXPECT_GE(exact_contact_residual(problem, wrong), 1e-5) << row;
    }
  solution.impulse[0] = NAN;
  EXPECT_FALSE(exact_contact_residual(problem, solution) < 1);
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
