#include "softfinger/dynamics/proximal_lanes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "softfinger/dynamics/exact_newton.h"
#include "softfinger/dynamics/impulse_start.h"
#include "softfinger/math/wide.h"
#include "tests/dynamics/random_scene.h"

namespace softfinger::internal {
namespace {

constexpr int kContacts = 60, kMostIterations = 300;
constexpr int kMostSteps = 5;  // between two proximal points, where a start can end

ContactLcp scene(unsigned seed) {
  ContactLcp problem = tests::RandomScenes(seed).next(kContacts, 16);
  problem.friction_rule = FrictionRule::ellipsoid;
  return problem;
}

/// A scene's contacts and drawn starts.
struct Starts {
  explicit Starts(const ContactLcp& problem) : contacts(kContacts) {
    contacts.set(problem, 0);
    ImpulseSearch search(contacts, kContacts);
    for (int start = 0; start < ProximalLanes::kLanes; ++start) {
      go_to_start(kGivenStarts + start, search);
      impulses.push_back(search.impulse());
    }
  }
  ContactOperator contacts;
  std::vector<Eigen::VectorXd> impulses;
};

struct Ended {
  Eigen::VectorXd impulse;
  double best = 0;
  bool operator==(const Ended& other) const {
    return impulse == other.impulse && best == other.best;
  }
};

/// The starts `first`, first + 1, ... in all lanes. Of more than `wait` steps before the next lane
/// starts.
std::vector<Ended> run(const Starts& starts, int first, int wait,
                       int most_iterations = kMostIterations) {
  VelocityFactor factor(kContacts);
  factor.factorise(starts.contacts);
  ProximalLanes lanes;
  lanes.begin_problem(starts.contacts, factor);
  std::vector<Ended> ended(starts.impulses.size(), {Eigen::VectorXd(4 * kContacts), 0});
  const int steps = most_iterations + kMostSteps + wait * ProximalLanes::kLanes;
  for (int step = 0, started = 0; step < steps; ++step) {
    for (; started < ProximalLanes::kLanes && step >= started * wait; ++started)
      lanes.start((first + started) % ProximalLanes::kLanes, starts.impulses[std::size_t(started)],
                  most_iterations);
    lanes.advance();
  }
  for (int start = 0; start < ProximalLanes::kLanes; ++start) {
    const int lane = (first + start) % ProximalLanes::kLanes;
    EXPECT_FALSE(lanes.is_running(lane));
    lanes.read_best(lane, ended[std::size_t(start)].impulse);
    ended[std::size_t(start)].best = lanes.best(lane);
  }
  return ended;
}

/// Both follow the same points. Sooner or later rounding parts them, where a contact nearly opens
/// or slips: with masses over six decades within five iterations.
TEST(ProximalLanes, FollowOneStartAlone) {
  constexpr int kFewIterations = 5, kSeeds = 8;
  constexpr double kRounding = 1e-7;  // 5 steps, each of some 1e3 times the last one's
  int same = 0, moved = 0;
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const Starts starts(scene(seed));
    const std::vector<Ended> ended = run(starts, 0, 0, kFewIterations);
    ExactNewton newton(kContacts);
    newton.begin_problem();
    for (std::size_t start = 0; start < ended.size(); ++start) {
      Eigen::VectorXd alone = starts.impulses[start];
      const double before = alone.lpNorm<Eigen::Infinity>();
      const double best = newton.approach(starts.contacts, alone, kFewIterations);
      const double apart = (ended[start].impulse - alone).lpNorm<Eigen::Infinity>();
      moved += alone != starts.impulses[start];
      same += std::abs(ended[start].best - best) <= kRounding * best + kSolved &&
              apart <= kRounding * before;
    }
  }
  EXPECT_GE(same, kSeeds * ProximalLanes::kLanes * 9 / 10);
  EXPECT_GE(moved, kSeeds * ProximalLanes::kLanes / 2);
}

/// A problem much like the last one: its solution is this one's but for a small part.
TEST(ProximalPoints, TakeFewIterationsFromNearTheSolution) {
  int far = 0, near = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const Starts starts(scene(seed));
    ExactNewton newton(kContacts);
    newton.begin_problem();
    Eigen::VectorXd solution = starts.impulses[0];
    if (newton.approach(starts.contacts, solution, kMostIterations) > kGood) continue;
    const auto approach = [&](ProximalCourse::Start start) {
      Eigen::VectorXd impulse = (1 + 1e-5) * solution;
      EXPECT_LE(newton.approach(starts.contacts, impulse, kMostIterations, {}, start), kGood);
      return newton.iterations();
    };
    far += approach(ProximalCourse::Start::far);
    near += approach(ProximalCourse::Start::near);
  }
  EXPECT_GT(near, 0) << "no scene was solved";
  EXPECT_LT(near, far);
}

TEST(ProximalLanes, DoNotDependOnEachOtherNorOnTheirPlaces) {
  const Starts starts(scene(7));
  const std::vector<Ended> together = run(starts, 0, 0);
  EXPECT_TRUE(run(starts, 3, 0) == together);
  EXPECT_TRUE(run(starts, 0, 5) == together);
}

TEST(ProximalLanes, HaveTheSameBitsWithAllInstructions) {
  const Starts starts(scene(8));
  const std::vector<Ended> widest = run(starts, 0, 0);
  const bool had_widest = std::exchange(has_widest_instructions, false);
  const std::vector<Ended> wide = run(starts, 0, 0);
  const bool had_wide = std::exchange(has_wide_instructions, false);
  const std::vector<Ended> usual = run(starts, 0, 0);
  has_widest_instructions = had_widest;
  has_wide_instructions = had_wide;
  EXPECT_TRUE(wide == widest);
  EXPECT_TRUE(usual == widest);
}

/// Against Eigen's elimination of the same pattern: nothing lies outside of it.
TEST(EliminationPattern, HoldsWhatEliminationFills) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Starts starts(scene(seed));
    VelocityFactor factor(kContacts);
    factor.factorise(starts.contacts);
    const EliminationPattern& pattern = factor.pattern();
    const int size = factor.rank();
    ASSERT_EQ(pattern.size(), size);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Identity(size, size);
    for (int i = 0; i < kContacts; ++i)
      factor.rows().add_product(i, Eigen::Matrix4d::Identity().eval().data(), sum);
    const Eigen::MatrixXd lower = sum.llt().matrixL();
    int column = 0;
    for (int first = 0; first < size; first += pattern.width(first)) {
      const auto last = pattern.rows(first + pattern.width(first) - 1);
      for (; column < first + pattern.width(first); ++column) {
        const auto rows = pattern.rows(column);
        const std::vector<int> own(rows.first, rows.first + rows.count);
        for (int row = column + 1; row < size; ++row) {
          if (lower(row, column) == 0) continue;
          EXPECT_TRUE(std::binary_search(own.begin(), own.end(), row)) << row << ' ' << column;
        }
        EXPECT_TRUE(std::equal(last.first, last.first + last.count, own.end() - last.count));
        EXPECT_EQ(rows.count, first + pattern.width(first) - 1 - column + last.count);
      }
    }
    EXPECT_EQ(column, size);
  }
}

}  // namespace
}  // namespace softfinger::internal
