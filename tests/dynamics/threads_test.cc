// Contact problems whose first start fails, so that threads take the others.
#include <gtest/gtest.h>

#include <utility>

#include "softfinger/dynamics/contact_lcp.h"
#include "softfinger/math/wide.h"
#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

/// The starts with given impulses fail in both: further ones are drawn.
TEST(ContactThreads, DoNotChangeTheSolution) {
  constexpr int kContacts = 100;
  for (const auto& [seed, number] : {std::pair(11u, 85), {18u, 0}}) {
    tests::RandomScenes scenes(seed);
    ContactLcp problem;
    for (int trial = 0; trial <= number; ++trial) problem = scenes.next(kContacts, 16);
    problem.friction_rule = FrictionRule::ellipsoid;
    ContactSolution alone, together;
    const LcpResult expected = ContactLcpSolver(kContacts, 0, 1).solve(problem, alone);
    EXPECT_EQ(expected.status, LcpStatus::solved) << seed;
    EXPECT_GT(expected.newton_iterations, 1200) << seed;
    for (const int threads : {2, 4}) {
      ContactLcpSolver solver(kContacts, 0, threads);
      for (int again = 0; again < 2; ++again) {
        const LcpResult result = solver.solve(problem, together);
        EXPECT_EQ(result.newton_iterations, expected.newton_iterations) << seed << ' ' << threads;
        EXPECT_TRUE(together.impulse == alone.impulse && together.velocity == alone.velocity &&
                    together.slip == alone.slip)
            << seed << ' ' << threads;
      }
    }
  }
}

/// What processors do whose vectors hold fewer than four numbers.
TEST(ContactThreads, TakeOneStartAfterAnotherWithoutWideInstructions) {
  constexpr int kContacts = 100;
  ContactLcp problem = tests::RandomScenes(18).next(kContacts, 16);
  problem.friction_rule = FrictionRule::ellipsoid;
  ContactSolution solution;
  const bool had_wide = std::exchange(has_wide_instructions, false);
  const LcpResult result = ContactLcpSolver(kContacts, 0, 2).solve(problem, solution);
  has_wide_instructions = had_wide;
  EXPECT_EQ(result.status, LcpStatus::solved);
  EXPECT_GT(result.newton_iterations, 400);  // the first start has failed
}

/// A body of 100 contacts between two walls that close: no start can succeed, and the proof does
/// not wait for all of them.
TEST(ContactThreads, DoNotSearchWhatIsInfeasible) {
  constexpr int kContacts = 100;
  ContactLcp problem;
  problem.delassus.setZero(4 * kContacts, 4 * kContacts);
  problem.free_velocity.setZero(4 * kContacts);
  for (int i = 0; i < kContacts; ++i)
    for (int j = 0; j < kContacts; ++j) problem.delassus(4 * i, 4 * j) = i % 2 == j % 2 ? 1 : -1;
  for (int i = 0; i < kContacts; ++i) {
    problem.delassus.diagonal().segment<3>(4 * i + 1).setOnes();
    problem.free_velocity[4 * i] = -1;
  }
  problem.friction_coefficient.setConstant(kContacts, 0.5);
  problem.eccentricity_m.setConstant(kContacts, 0.001);
  problem.friction_rule = FrictionRule::ellipsoid;
  ContactSolution solution;
  const LcpResult result = ContactLcpSolver(kContacts, 0).solve(problem, solution);
  EXPECT_EQ(result.status, LcpStatus::infeasible_or_ray);
  EXPECT_EQ(result.proof, RayProof::infeasible);
  EXPECT_EQ(result.attempts, 0);
}

}  // namespace
}  // namespace softfinger
