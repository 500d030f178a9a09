// Warm start: the same answers as cold ones, for the same contacts, fewer, more, in another order;
// and hardly any work where hardly anything changed.
#include <gtest/gtest.h>

#include <numeric>

#include "softfinger/input/errors.h"
#include "tests/dynamics/random_scene.h"

namespace softfinger {
namespace {

/// Facets always start cold.
constexpr FrictionRule kExactRules[] = {FrictionRule::ellipsoid, FrictionRule::limit_surface};

std::vector<int> all(int contacts) {
  std::vector<int> continued(static_cast<std::size_t>(contacts));
  std::iota(continued.begin(), continued.end(), 0);
  return continued;
}

void use(ContactLcp& problem, FrictionRule rule) {
  static const SixPatchShape shape(0.5, 0.5);
  problem.friction_rule = rule;
  problem.vertices = tests::friction_vertices(32);
  problem.shapes.assign(std::size_t(problem.contacts()), &shape);
}

/// The contacts `kept` of a problem, in that order.
ContactLcp subset(const ContactLcp& problem, const std::vector<int>& kept) {
  ContactLcp part = problem;
  const int nc = int(kept.size());
  part.delassus.resize(4 * nc, 4 * nc);
  part.free_velocity.resize(4 * nc);
  part.friction_coefficient.resize(nc);
  part.eccentricity_m.resize(nc);
  part.shapes.resize(std::size_t(nc));
  for (int i = 0; i < nc; ++i) {
    const int a = kept[std::size_t(i)];
    part.free_velocity.segment<4>(4 * i) = problem.free_velocity.segment<4>(4 * a);
    part.friction_coefficient[i] = problem.friction_coefficient[a];
    part.eccentricity_m[i] = problem.eccentricity_m[a];
    part.shapes[std::size_t(i)] = problem.shapes[std::size_t(a)];
    for (int j = 0; j < nc; ++j)
      part.delassus.block<4, 4>(4 * i, 4 * j) =
          problem.delassus.block<4, 4>(4 * a, 4 * kept[std::size_t(j)]);
  }
  return part;
}

TEST(WarmStart, TakesTheSameProblemAgainAsItIs) {
  tests::RandomScenes scenes(31);
  for (const FrictionRule rule : kExactRules)
    for (int trial = 0; trial < 20; ++trial) {
      ContactLcp problem = tests::separate_contacts(scenes, 8);
      use(problem, rule);
      ContactLcpSolver solver(8, 32);
      ContactSolution first, second;
      ASSERT_EQ(solver.solve(problem, first).status, LcpStatus::solved);
      const std::vector<int> continued = all(8);
      const LcpResult again = solver.solve(problem, second, &continued);
      ASSERT_EQ(again.status, LcpStatus::solved);
      EXPECT_EQ(again.solved_by, SolvedBy::still);
      EXPECT_EQ(again.pivots, 0);
      EXPECT_LE((first.impulse - second.impulse).norm(), 1e-11);
    }
}

TEST(WarmStart, FindsWhatAColdStartFinds) {
  tests::RandomScenes scenes(32);
  for (const FrictionRule rule : kExactRules)
    for (const double change : {1e-6, 1e-3, 1e-1, 1.}) {
      ContactLcp problem = tests::separate_contacts(scenes, 8);
      use(problem, rule);
      ContactLcpSolver warm(8, 32), cold(8, 32);
      ContactSolution of_warm, of_cold;
      warm.solve(problem, of_warm);
      const std::vector<int> continued = all(8);
      for (int step = 0; step < 10; ++step) {
        for (double& velocity : problem.free_velocity) velocity += change * scenes.uniform(-1, 1);
        ASSERT_EQ(warm.solve(problem, of_warm, &continued).status, LcpStatus::solved);
        ASSERT_EQ(cold.solve(problem, of_cold).status, LcpStatus::solved);
        EXPECT_LE((of_warm.velocity - of_cold.velocity).norm(), 1e-9) << change;
      }
    }
}

TEST(WarmStart, FollowsContactsThatComeGoAndChangePlaces) {
  tests::RandomScenes scenes(33);
  for (const FrictionRule rule : kExactRules)
    for (int trial = 0; trial < 20; ++trial) {
      ContactLcp problem = tests::separate_contacts(scenes, 8);
      use(problem, rule);
      const ContactLcp fewer = subset(problem, {5, 2, 7, 0});
      ContactLcpSolver warm(8, 32), cold(8, 32);
      ContactSolution of_warm, of_cold;
      warm.solve(problem, of_warm);
      const std::vector<int> from_all{5, 2, 7, 0};
      ASSERT_EQ(warm.solve(fewer, of_warm, &from_all).status, LcpStatus::solved);
      ASSERT_EQ(cold.solve(fewer, of_cold).status, LcpStatus::solved);
      EXPECT_LE((of_warm.velocity - of_cold.velocity).norm(), 1e-9);
      const std::vector<int> from_fewer{3, -1, 1, -1, -1, 0, -1, 2};
      ASSERT_EQ(warm.solve(problem, of_warm, &from_fewer).status, LcpStatus::solved);
      ASSERT_EQ(cold.solve(problem, of_cold).status, LcpStatus::solved);
      EXPECT_LE((of_warm.velocity - of_cold.velocity).norm(), 1e-9);
    }
}

TEST(WarmStart, NeedsFewerIterationsInAStepOfSteadyMotion) {
  tests::RandomScenes scenes(34);
  ContactLcpSolver warm(10, 0), cold(10, 0);
  ContactSolution of_warm, of_cold;
  const std::vector<int> continued = all(10);
  int warm_iterations = 0, cold_iterations = 0, cold_starts = 0;
  for (int trial = 0; trial < 40; ++trial) {
    ContactLcp problem = scenes.next(10, 32);
    use(problem, FrictionRule::ellipsoid);
    ASSERT_EQ(warm.solve(problem, of_warm).status, LcpStatus::solved);
    for (int step = 0; step < 5; ++step) {
      scenes.disturb(problem, 1e-3);
      const LcpResult of_step = warm.solve(problem, of_warm, &continued);
      ASSERT_EQ(of_step.status, LcpStatus::solved) << trial;
      EXPECT_EQ(of_step.residual, exact_contact_residual(problem, of_warm)) << trial;
      cold_starts += !of_step.is_warm() && of_step.solved_by != SolvedBy::separating;
      warm_iterations += of_step.newton_iterations;
      cold_iterations += cold.solve(problem, of_cold).newton_iterations;
    }
  }
  EXPECT_LE(warm_iterations, cold_iterations / 2);
  EXPECT_LE(cold_starts, 4);
}

TEST(WarmStart, OfFacetsIsAColdOne) {
  tests::RandomScenes scenes(37);
  ContactLcpSolver solver(8, 32);
  ContactSolution first, second;
  ContactLcp problem = tests::separate_contacts(scenes, 8);
  use(problem, FrictionRule::facets);
  const LcpResult cold = solver.solve(problem, first);
  const std::vector<int> continued = all(8);
  const LcpResult again = solver.solve(problem, second, &continued);
  EXPECT_EQ(again.solved_by, SolvedBy::facets);
  EXPECT_EQ(again.pivots, cold.pivots);
  EXPECT_TRUE(first.impulse == second.impulse);
}

TEST(WarmStart, StartsColdAfterAProblemOfAnotherKind) {
  tests::RandomScenes scenes(35);
  ContactLcpSolver solver(6, 32);
  ContactSolution solution;
  ContactLcp problem = tests::separate_contacts(scenes, 6);
  const std::vector<int> continued = all(6);
  use(problem, FrictionRule::facets);
  solver.solve(problem, solution);
  use(problem, FrictionRule::ellipsoid);
  EXPECT_EQ(solver.solve(problem, solution, &continued).status, LcpStatus::solved);
  EXPECT_LE(exact_contact_residual(problem, solution), 1e-12);
}

TEST(WarmStart, RefusesContactsThatTheLastProblemDidNotHave) {
  tests::RandomScenes scenes(36);
  ContactLcpSolver solver(6, 32);
  ContactSolution solution;
  ContactLcp problem = tests::separate_contacts(scenes, 6);
  use(problem, FrictionRule::ellipsoid);
  const std::vector<int> good = all(6), short_list = all(5), unknown{0, 1, 2, 3, 4, 6};
  EXPECT_THROW(solver.solve(problem, solution, &good), InputError);  // there was none before
  solver.solve(problem, solution);
  EXPECT_THROW(solver.solve(problem, solution, &short_list), InputError);
  EXPECT_THROW(solver.solve(problem, solution, &unknown), InputError);
}

}  // namespace
}  // namespace softfinger
