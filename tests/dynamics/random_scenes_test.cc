// Robustness: ten thousand random scenes of 1 to 20 contacts, masses over six decades, e_n from
// 1e-6 to 1 m. None may fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

TEST(RandomScenes, NoneOfTenThousandFails) {
  tests::RandomScenes scenes(7);
  ContactLcpSolver solver(20, 64);
  ContactSolution solution;
  int failures = 0, most_attempts = 0;
  double worst = 0;
  for (int trial = 0; trial < 10000; ++trial) {
    const ContactLcp problem = scenes.next(1 + trial % 20, 8 << (trial / 20 % 4));
    const LcpResult result = solver.solve(problem, solution);
    failures += result.status != LcpStatus::solved;
    most_attempts = std::max(most_attempts, result.attempts);
    worst = std::max(worst, contact_residual(problem, solution));
  }
  std::printf("failures %d, worst residual %.1e, at most %d attempts\n", failures, worst,
              most_attempts);
  EXPECT_EQ(failures, 0);
  EXPECT_LE(worst, 1e-10);
}

}  // namespace
}  // namespace softfinger
