// Robustness: ten thousand random scenes of 1 to 20 contacts, masses over six decades, e_n from
// 1e-6 to 1 m, under each friction rule.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

struct Count {
  int failures = 0, wedged = 0, most_attempts = 0;
  double worst = 0;
};

/// Bodies held between each other by impulses that would alone move them a million times faster
/// than anything moves: of the sixteen digits of a velocity ten are left, at best.
bool is_wedged(const ContactLcp& problem, const ContactSolution& solution) {
  double largest = 0;
  for (int i = 0; i < problem.contacts(); ++i)
    largest = std::max(largest, problem.delassus(4 * i, 4 * i) * solution.impulse[4 * i]);
  return largest > 1e6 * problem.free_velocity.lpNorm<Eigen::Infinity>();
}

Count solve(int scenes_to_solve, FrictionRule rule, unsigned seed = 7) {
  const SixPatchShape shape(0.5, 0.5);
  tests::RandomScenes scenes(seed);
  ContactLcpSolver solver(20, 64);
  ContactSolution solution;
  Count count;
  for (int trial = 0; trial < scenes_to_solve; ++trial) {
    ContactLcp problem = scenes.next(1 + trial % 20, 8 << (trial / 20 % 4));
    problem.friction_rule = rule;
    problem.shapes.assign(std::size_t(problem.contacts()), &shape);
    const LcpResult result = solver.solve(problem, solution);
    count.most_attempts = std::max(count.most_attempts, result.attempts);
    if (result.status != LcpStatus::solved) {
      EXPECT_EQ(result.proof, RayProof::none) << trial;  // bodies always have a solution
      const bool wedged = is_wedged(problem, solution);
      count.wedged += wedged;
      count.failures += !wedged;
      continue;
    }
    count.worst = std::max(count.worst, rule == FrictionRule::facets
                                            ? contact_residual(problem, solution)
                                            : exact_contact_residual(problem, solution));
  }
  std::printf("failures %d, wedged %d, worst residual %.1e, at most %d attempts\n", count.failures,
              count.wedged, count.worst, count.most_attempts);
  return count;
}

TEST(RandomScenes, NoneOfTenThousandFails) {
  const Count count = solve(10000, FrictionRule::facets);
  EXPECT_EQ(count.failures + count.wedged, 0);
  EXPECT_LE(count.worst, 1e-10);
}

/// One of these has contacts so nearly repeated on bodies so different that a ray of them looks
/// like a proof that nothing can hold them apart.
TEST(RandomScenes, NoneOfTenThousandOthersFails) {
  const Count count = solve(10000, FrictionRule::facets, 3);
  EXPECT_EQ(count.failures + count.wedged, 0);
  EXPECT_LE(count.worst, 1e-10);
}

TEST(RandomScenes, NoneOfTenThousandFailsWithTheExactEllipsoidButOneThatIsWedged) {
  const Count count = solve(10000, FrictionRule::ellipsoid);
  EXPECT_EQ(count.failures, 0);
  EXPECT_LE(count.wedged, 1);
  EXPECT_LE(count.worst, 1e-10);
}

TEST(RandomScenes, NoneOfTwoThousandFailsWithSixPatches) {
  const Count count = solve(2000, FrictionRule::limit_surface);
  EXPECT_EQ(count.failures + count.wedged, 0);
  EXPECT_LE(count.worst, 1e-10);
}

}  // namespace
}  // namespace softfinger
