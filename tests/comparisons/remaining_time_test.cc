#include "comparisons/system/remaining_time.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace softfinger::system {
namespace {

struct Finish {
  double at_s, took_s, expected_s;
};

/// Jobs on workers that each take the next one: when each ends.
std::vector<Finish> schedule(const std::vector<double>& took_s,
                             const std::vector<double>& expected_s, std::size_t workers) {
  std::vector<double> free_at(workers, 0);
  std::vector<Finish> finishes;
  for (std::size_t i = 0; i < took_s.size(); ++i) {
    double& at = *std::min_element(free_at.begin(), free_at.end());
    at += took_s[i];
    finishes.push_back({at, took_s[i], expected_s[i]});
  }
  std::sort(finishes.begin(), finishes.end(),
            [](const Finish& one, const Finish& other) { return one.at_s < other.at_s; });
  return finishes;
}

TEST(RemainingTime, IsExactWhereTheExpectedTimesAre) {
  const std::vector<double> times = {1, 5, 2, 40, 3, 7};
  RemainingTime left(times.size(), 58, 1);
  EXPECT_DOUBLE_EQ(left.left_s(0), 58);
  double now = 0;
  for (const double time : times) {
    now += time;
    left.finished(time, time, now);
    EXPECT_NEAR(left.left_s(now), 58 - now, 1e-12);
    EXPECT_NEAR(left.left_s(now + 0.5), std::max(0., 58 - now - 0.5), 1e-12) << "counts down";
  }
}

// Short and long jobs in turn, of which the expected times are wrong by a factor of up to two, on a
// machine that is three times slower: after a fifth of the time the estimate is off by less than a
// factor of two, until the last fifth, of which single jobs decide, and it does not jump.
TEST(RemainingTime, DoesNotWander) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> factor(-1, 1);
  for (const std::size_t workers : {1u, 2u, 4u})
    for (const bool is_told : {true, false}) {
      std::vector<double> took, expected;
      for (int i = 0; i < 60; ++i) {
        expected.push_back(i % 3 == 0 ? 1 : i % 3 == 1 ? 4 : 12);
        took.push_back(3 * expected.back() * std::exp2(factor(random)));
      }
      const double all = std::accumulate(expected.begin(), expected.end(), 0.);
      const std::vector<Finish> finishes = schedule(took, expected, workers);
      RemainingTime left(took.size(), all, int(workers));
      const double end_s = finishes.back().at_s;
      for (const Finish& finish : finishes) {
        const double before = left.left_s(finish.at_s);
        left.finished(finish.expected_s,
                      is_told ? std::optional<double>(finish.took_s) : std::nullopt, finish.at_s);
        const double truth = end_s - finish.at_s, found = left.left_s(finish.at_s);
        if (finish.at_s < 0.2 * end_s || truth < 0.2 * end_s) continue;
        EXPECT_LT(std::abs(std::log2(found / truth)), 1) << finish.at_s << " of " << end_s;
        EXPECT_LT(std::abs(found - before), 0.15 * end_s) << finish.at_s << " of " << end_s;
      }
    }
}

TEST(RemainingTime, IsZeroAtTheEnd) {
  RemainingTime left(1, 10, 8);
  left.finished(10, 3, 3);
  EXPECT_EQ(left.left_s(3), 0);
  RemainingTime none(0, 0, 2);
  EXPECT_EQ(none.left_s(1), 0);
}

}  // namespace
}  // namespace softfinger::system
