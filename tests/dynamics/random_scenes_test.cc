// Robustness: ten thousand random scenes of 1 to 20 contacts, masses over six decades, e_n from
// 1e-6 to 1 m, under each friction rule.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

struct Count {
  int failures = 0, most_attempts = 0;
  double worst = 0, worst_failure = 0;  ///< residuals
};

Count solve(int scenes_to_solve, FrictionRule rule) {
  const SixPatchShape shape(0.5, 0.5);
  tests::RandomScenes scenes(7);
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
      ++count.failures;
      count.worst_failure = std::max(count.worst_failure, result.residual);
      continue;
    }
    count.worst = std::max(count.worst, rule == FrictionRule::facets
                                            ? contact_residual(problem, solution)
                                            : exact_contact_residual(problem, solution));
  }
  std::printf("failures %d (residual %.1e), worst residual %.1e, at most %d attempts\n",
              count.failures, count.worst_failure, count.worst, count.most_attempts);
  return count;
}

TEST(RandomScenes, NoneOfTenThousandFails) {
  const Count count = solve(10000, FrictionRule::facets);
  EXPECT_EQ(count.failures, 0);
  EXPECT_LE(count.worst, 1e-10);
}

// A known shortfall: in one scene, bodies held by internal impulses some 1e6 times what their
// motion needs, Newton's iteration ends at 2.6e-10. It says so, and the point is good enough to go
// on from.
TEST(RandomScenes, OneOfTenThousandIsNotExactWithTheExactEllipsoid) {
  const Count count = solve(10000, FrictionRule::ellipsoid);
  EXPECT_LE(count.failures, 1);
  EXPECT_LE(count.worst_failure, 1e-9);
  EXPECT_LE(count.worst, 1e-10);
}

TEST(RandomScenes, NoneOfTwoThousandFailsWithSixPatches) {
  const Count count = solve(2000, FrictionRule::limit_surface);
  EXPECT_EQ(count.failures, 0);
  EXPECT_LE(count.worst, 1e-10);
}

}  // namespace
}  // namespace softfinger
