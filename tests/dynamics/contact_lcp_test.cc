// The contact problem: single contacts solved by hand, redundant contacts, closing walls, and the
// invariants that any solver of it has to have.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "softfinger/dynamics/step/contact_lcp_solver.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

constexpr double kLcpRoundOff = 1e-12;

/// `contacts` times the same contact of a body with the floor: mass 2 kg, inertia such that a spin
/// is felt as 0.5 kg m² about the normal, no arms.
ContactLcp block_on_floor(int contacts, const Eigen::Vector4d& velocity, double friction,
                          double eccentricity_m, int vertices = 16) {
  ContactLcp problem;
  const Eigen::Vector4d inverse_inertia(0.5, 0.5, 0.5, 2);
  const Eigen::MatrixXd jacobian = Eigen::Matrix4d::Identity().replicate(contacts, 1);
  problem.delassus = jacobian * inverse_inertia.asDiagonal() * jacobian.transpose();
  problem.free_velocity = jacobian * velocity;
  problem.friction_coefficient.setConstant(contacts, friction);
  problem.eccentricity_m.setConstant(contacts, eccentricity_m);
  problem.vertices = tests::friction_vertices(vertices);
  return problem;
}

LcpResult solve(const ContactLcp& problem, ContactSolution& solution) {
  return ContactLcpSolver(problem.contacts(), int(problem.vertices.cols()))
      .solve(problem, solution);
}

TEST(ContactLcp, StopsAFallingBlock) {
  ContactSolution solution;
  const LcpResult result = solve(block_on_floor(1, {-0.3, 0, 0, 0}, 0.7, 0.01), solution);
  EXPECT_EQ(result.status, LcpStatus::solved);
  EXPECT_NEAR(solution.impulse[0], 0.6, kLcpRoundOff);
  EXPECT_LE(solution.velocity.norm(), kLcpRoundOff);
}

// Found by fuzzing: vertices of 1e150 made velocities that are no numbers, with a residual of 0.
TEST(ContactLcp, WhatIsNoNumberSolvesNothing) {
  const ContactLcp problem = block_on_floor(1, {-0.3, 0, 0, 0}, 0.7, 0.01);
  ContactSolution solution;
  ASSERT_EQ(solve(problem, solution).status, LcpStatus::solved);
  for (int row = 0; row < 4; ++row) {
    ContactSolution broken = solution;
    broken.velocity[row] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_GT(contact_residual(problem, broken), 1e300) << row;
    broken = solution;
    broken.impulse[row] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_GT(contact_residual(problem, broken), 1e300) << row;
    EXPECT_GT(exact_contact_residual(problem, broken), 1e300) << row;
  }
}

TEST(ContactLcp, LetsASeparatingBlockGo) {
  ContactSolution solution;
  const LcpResult result = solve(block_on_floor(1, {0.1, 1, 0, 3}, 0.7, 0.01), solution);
  EXPECT_EQ(result.status, LcpStatus::solved);
  EXPECT_EQ(solution.impulse, Eigen::Vector4d::Zero());
  EXPECT_LE(result.residual, kLcpRoundOff);
}

TEST(ContactLcp, SticksWhenFrictionSuffices) {
  ContactSolution solution;
  const LcpResult result = solve(block_on_floor(1, {-0.3, 0.05, -0.02, 0}, 0.7, 0.01), solution);
  EXPECT_EQ(result.status, LcpStatus::solved);
  EXPECT_LE(solution.velocity.norm(), kLcpRoundOff);
  EXPECT_NEAR(solution.impulse[1], -2 * 0.05, kLcpRoundOff);
  EXPECT_NEAR(solution.impulse[2], 2 * 0.02, kLcpRoundOff);
}

TEST(ContactLcp, GivesAllTorqueToAPureSpin) {
  // The first vertex is the pole: torque e_n mu P exactly, omega = omega_0 - 2 * 0.01 * 0.7 * 0.6.
  ContactSolution solution;
  const LcpResult result = solve(block_on_floor(1, {-0.3, 0, 0, 1}, 0.7, 0.01), solution);
  EXPECT_EQ(result.status, LcpStatus::solved);
  EXPECT_NEAR(solution.impulse[3], -0.01 * 0.7 * 0.6, kLcpRoundOff);
  EXPECT_NEAR(solution.velocity[3], 1 - 2 * 0.01 * 0.7 * 0.6, kLcpRoundOff);
}

TEST(ContactLcp, SharesALoadAmongTheSameContactManyTimes) {
  for (const int contacts : {2, 5, 10, 20}) {
    ContactSolution solution;
    const LcpResult result =
        solve(block_on_floor(contacts, {-0.3, 0.8, 0.1, 2}, 0.7, 0.01), solution);
    ASSERT_EQ(result.status, LcpStatus::solved) << contacts;
    EXPECT_LE(result.residual, kLcpRoundOff) << contacts;
    double sum = 0;
    for (int i = 0; i < contacts; ++i) sum += solution.impulse[4 * i];
    EXPECT_NEAR(sum, 0.6, kLcpRoundOff) << contacts;
  }
}

TEST(ContactLcp, ProvesThatClosingWallsCannotBeWithstood) {
  // A body between two walls that come 1 m/s each.
  ContactLcp problem = block_on_floor(2, {-1, 0, 0, 0}, 0.5, 0.001);
  const Eigen::Vector4d faces_other_way(-1, 1, -1, -1);
  const auto flip = faces_other_way.asDiagonal();
  problem.delassus.block<4, 4>(0, 4) = problem.delassus.block<4, 4>(0, 4) * flip;
  problem.delassus.block<4, 4>(4, 0) = flip * problem.delassus.block<4, 4>(4, 0);
  ContactSolution solution;
  const LcpResult result = solve(problem, solution);
  ASSERT_EQ(result.status, LcpStatus::infeasible_or_ray);
  EXPECT_EQ(result.proof, RayProof::infeasible);
  EXPECT_LE((problem.delassus * solution.ray).norm(), kLcpRoundOff * solution.ray.norm());
  EXPECT_LT(solution.ray.dot(problem.free_velocity), 0);
  // If one wall opens as fast as the other closes, the problem is solvable.
  problem.free_velocity[4] = 1;
  EXPECT_EQ(solve(problem, solution).status, LcpStatus::solved);
}

TEST(ContactLcp, StopsABodyInANarrowWedge) {
  // 2 kg at 1 m/s into a wedge of half angle delta without friction: P = m v/(2 sin delta) on each
  // wall. P = 1 on each moves the body by sin(delta) only, which must not pass for a proof that no
  // impulses stop it.
  for (const double half_angle_rad : {1e-1, 1e-3, 1e-5}) {
    const double sine = std::sin(half_angle_rad), cosine = std::cos(half_angle_rad), mass_kg = 2;
    ContactLcp problem = block_on_floor(2, Eigen::Vector4d::Zero(), 0, 0.01);
    problem.delassus.setZero();
    problem.delassus(0, 0) = problem.delassus(4, 4) = 1 / mass_kg;
    problem.delassus(0, 4) = problem.delassus(4, 0) = (sine * sine - cosine * cosine) / mass_kg;
    problem.free_velocity[0] = problem.free_velocity[4] = -sine;
    ContactSolution solution;
    const LcpResult result = solve(problem, solution);
    EXPECT_EQ(result.proof, RayProof::none) << half_angle_rad;
    // v = W P has lost that much of itself to rounding: 1e-5 at the narrowest one, where no
    // impulses can be shown to solve it.
    const double rounded = 1e-15 / (sine * sine);
    if (rounded > 1e-10) continue;
    EXPECT_EQ(result.status, LcpStatus::solved) << half_angle_rad;
    const double expected = mass_kg / (2 * sine);
    EXPECT_NEAR(solution.impulse[0], expected, rounded * expected);
    EXPECT_NEAR(solution.impulse[4], expected, rounded * expected);
  }
}

TEST(ContactLcp, TakesNoPivotsForContactsWithoutLoad) {
  tests::RandomScenes scenes(21);
  const int loaded = 6;
  const ContactLcp alone = tests::separate_contacts(scenes, loaded);
  ContactLcp problem = tests::separate_contacts(scenes, 2 * loaded);
  const int n = 4 * loaded;
  problem.vertices = tests::friction_vertices(32);
  problem.delassus.topLeftCorner(n, n) = alone.delassus;
  problem.delassus.topRightCorner(n, n).setZero();
  problem.delassus.bottomLeftCorner(n, n).setZero();
  problem.free_velocity.head(n) = alone.free_velocity;
  problem.friction_coefficient.head(loaded) = alone.friction_coefficient;
  problem.eccentricity_m.head(loaded) = alone.eccentricity_m;
  for (int i = loaded; i < 2 * loaded; ++i)
    problem.free_velocity[4 * i] = std::abs(problem.free_velocity[4 * i]);  // opens
  ContactLcp first = alone;
  first.vertices = problem.vertices;
  ContactSolution of_all, of_first;
  const LcpResult all = solve(problem, of_all), few = solve(first, of_first);
  ASSERT_EQ(all.status, LcpStatus::solved);
  ASSERT_EQ(few.status, LcpStatus::solved);
  EXPECT_EQ(all.pivots, few.pivots);
  EXPECT_LE((of_all.impulse.head(n) - of_first.impulse).norm(), kLcpRoundOff);
  EXPECT_TRUE(of_all.impulse.tail(n).isZero(0));
  // Their lambda is nevertheless what (3) asks for.
  for (int i = loaded; i < 2 * loaded; ++i) {
    const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[i]);
    const Eigen::Vector3d slip = arms.cwiseProduct(of_all.velocity.segment<3>(4 * i + 1));
    EXPECT_NEAR(of_all.slip[i], -(slip.transpose() * problem.vertices).minCoeff(), kLcpRoundOff);
  }
}

TEST(ContactLcp, SaysThatFrictionJamsWhatCouldEscapeWithoutIt) {
  // A slider on a rail, pushed by a wall whose normal is 60 degrees off the rail. Without friction
  // it gives way; with mu > cot 60 it cannot slide up the wall while the wall does not move
  // sideways.
  const double angle = 60 * kPi / 180, mass_kg = 2;
  const Eigen::Vector4d along(std::cos(angle), std::sin(angle), 0, 0);
  ContactLcp problem;
  problem.delassus = along * along.transpose() / mass_kg;
  problem.free_velocity = Eigen::Vector4d(-0.1, 0, 0, 0);
  problem.eccentricity_m.setConstant(1, 0.01);
  problem.vertices = tests::friction_vertices(32);
  for (const FrictionRule rule : {FrictionRule::facets, FrictionRule::ellipsoid}) {
    problem.friction_rule = rule;
    problem.friction_coefficient.setConstant(1, 1);
    ContactSolution solution;
    const LcpResult result = solve(problem, solution);
    ASSERT_EQ(result.status, LcpStatus::infeasible_or_ray);
    EXPECT_EQ(result.proof, RayProof::ray_only);
    const Eigen::VectorXd& ray = solution.ray;
    EXPECT_LE((problem.delassus * ray).norm(), kLcpRoundOff * ray.norm());
    EXPECT_LT(ray.dot(problem.free_velocity), 0);
    EXPECT_GT(ray[0], 0);
    EXPECT_LE(std::hypot(ray[1], ray[2], ray[3] / 0.01), ray[0] * (1 + kLcpRoundOff));
    // Slippery enough: v_t = 0.1 tan 60 and m x = P (cos - mu sin), x = 0.1/cos.
    problem.friction_coefficient.setConstant(1, 0.25);
    ASSERT_EQ(solve(problem, solution).status, LcpStatus::solved);
    EXPECT_NEAR(solution.velocity[1], 0.1 * std::tan(angle), kLcpRoundOff);
    if (rule == FrictionRule::facets) continue;
    EXPECT_NEAR(solution.impulse[0] * (std::cos(angle) - 0.25 * std::sin(angle)),
                mass_kg * 0.1 / std::cos(angle), kLcpRoundOff);
  }
}

TEST(ContactLcp, IsTheSameProblemAsTheRawOne) {
  // The whole matrix of nc (u + 2) unknowns: the residual of the structured solution in it.
  tests::RandomScenes scenes(11);
  for (int trial = 0; trial < 40; ++trial) {
    const ContactLcp problem = scenes.next(1 + trial % 6, 16);
    ContactSolution solution;
    ASSERT_EQ(solve(problem, solution).status, LcpStatus::solved);
    const int nc = problem.contacts(), u = 16, n = nc * (u + 2);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(4 * nc, n);
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n);
    for (int i = 0; i < nc; ++i) {
      const Eigen::Vector3d arms(1, 1, problem.eccentricity_m[i]);
      columns(4 * i, i) = 1;
      columns.block(4 * i + 1, nc + i * u, 3, u) = arms.asDiagonal() * problem.vertices;
      const int lambda = nc + nc * u + i;
      matrix.block(nc + i * u, lambda, u, 1).setOnes();
      matrix.block(lambda, nc + i * u, 1, u).setConstant(-1);
      matrix(lambda, i) = problem.friction_coefficient[i];
      z[i] = solution.impulse[4 * i];
      z[lambda] = solution.slip[i];
    }
    for (const auto& weight : solution.weights)
      z[nc + weight.contact * u + weight.vertex] = weight.value;
    matrix += columns.transpose() * problem.delassus * columns;
    const Eigen::VectorXd constant = columns.transpose() * problem.free_velocity;
    const Eigen::VectorXd w = matrix * z + constant;
    const double velocity = problem.free_velocity.lpNorm<Eigen::Infinity>();
    if (velocity == 0) continue;
    const double impulse = solution.impulse.lpNorm<Eigen::Infinity>();
    for (int i = 0; i < n; ++i) {
      const bool is_lambda = i >= nc + nc * u;
      const double own = is_lambda ? z[i] / velocity : matrix(i, i) * z[i] / velocity;
      EXPECT_LE(std::abs(std::min(own, w[i] / (is_lambda && impulse > 0 ? impulse : velocity))),
                1e-10);
    }
  }
}

TEST(ContactLcp, NeverGainsEnergy) {
  // r^T (v + v_free)/2 is the work of the contacts, and v_free = J u with a fixed world.
  tests::RandomScenes scenes(12);
  for (int trial = 0; trial < 200; ++trial) {
    const ContactLcp problem = scenes.next(1 + trial % 10, 16);
    ContactSolution solution;
    ASSERT_EQ(solve(problem, solution).status, LcpStatus::solved);
    const double work = 0.5 * solution.impulse.dot(solution.velocity + problem.free_velocity);
    const double natural = solution.impulse.cwiseAbs().dot(problem.free_velocity.cwiseAbs());
    EXPECT_LE(work, 1e-10 * natural) << trial;
  }
}

TEST(ContactLcp, DoesNotDependOnUnitsOfMassAndTime) {
  tests::RandomScenes scenes(13);
  for (int trial = 0; trial < 60; ++trial) {
    const ContactLcp problem = scenes.next(1 + trial % 10, 16);
    ContactSolution solution;
    const LcpResult plain = solve(problem, solution);
    for (const double of_mass : {1e-6, 1e6})
      for (const double of_velocity : {1e-6, 1e6}) {
        ContactLcp scaled = problem;
        scaled.delassus /= of_mass;
        scaled.free_velocity *= of_velocity;
        ContactSolution other;
        const LcpResult result = solve(scaled, other);
        EXPECT_EQ(result.status, plain.status);
        EXPECT_LE(result.residual, 1e-10);
        EXPECT_LE((other.velocity / of_velocity - solution.velocity).norm(),
                  1e-9 * problem.free_velocity.norm());
      }
  }
}

TEST(ContactLcp, RepeatsItselfExactly) {
  tests::RandomScenes scenes(14);
  const ContactLcp problem = scenes.next(12, 32), other = scenes.next(7, 16);
  ContactLcpSolver solver(12, 32);
  ContactSolution first, between, second;
  solver.solve(problem, first);
  solver.solve(other, between);
  solver.solve(problem, second);
  EXPECT_EQ(first.impulse, second.impulse);
  EXPECT_EQ(first.velocity, second.velocity);
}

TEST(ContactLcp, RefusesWhatIsNoProblem) {
  ContactSolution solution;
  ContactLcp problem = block_on_floor(1, {-1, 0, 0, 0}, 0.5, 0.01);
  problem.friction_coefficient[0] = -0.1;
  EXPECT_THROW(solve(problem, solution), InputError);
  problem = block_on_floor(1, {-1, 0, 0, 0}, 0.5, NAN);
  EXPECT_THROW(solve(problem, solution), InputError);
  problem = block_on_floor(1, {-1, 0, 0, 0}, 0.5, 0.01);
  problem.delassus.setZero();
  EXPECT_THROW(solve(problem, solution), InputError);
}

}  // namespace
}  // namespace softfinger
