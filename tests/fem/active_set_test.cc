#include "fem/contact/active_set.h"

#include <gtest/gtest.h>

#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Nodes = std::vector<Index>;

const VectorXd gap = (VectorXd(5) << 4, 0, 3, 1, 2).finished();
const VectorXd none = VectorXd::Zero(5);

TEST(ActiveSet, StartsFromTheNodesOfTheSmallestGapsOrFromALikelyContact) {
  EXPECT_EQ(ActiveSet(gap, nullptr).touching(), (Nodes{1, 3, 4}));
  EXPECT_EQ(ActiveSet(gap, nullptr).free(), (Nodes{0, 2}));
  EXPECT_EQ(ActiveSet(gap, &none).touching(), (Nodes{1, 3, 4})) << "unknown";
  const VectorXd likely = (VectorXd(5) << 0, 2, 1, 0, -1).finished();
  EXPECT_EQ(ActiveSet(gap, &likely).touching(), (Nodes{1, 2}));
}

TEST(ActiveSet, MovesNodesThatPullOrPenetrate) {
  ActiveSet set(gap, nullptr);
  const VectorXd force = (VectorXd(5) << 0, 1, 0, -1, 2).finished();
  const VectorXd clearance = (VectorXd(5) << -1, 0, 1, 0, 0).finished();
  EXPECT_FALSE(set.improve(force, clearance, 2, 4));
  EXPECT_EQ(set.touching(), (Nodes{0, 1, 4}));
  EXPECT_TRUE(set.improve(force.cwiseMax(0), clearance.cwiseMax(0), 2, 4));
}

TEST(ActiveSet, RoundOffDecidesNothing) {
  ActiveSet set(gap, nullptr);
  const VectorXd force = (VectorXd(5) << 0, 1, 0, -1.9e-12, 2).finished();
  const VectorXd clearance = (VectorXd(5) << -3.9e-12, 0, 1, 0, 0).finished();
  EXPECT_TRUE(set.improve(force, clearance, 2, 4));
  EXPECT_FALSE(set.improve(force, clearance, 1, 4));
  EXPECT_FALSE(ActiveSet(gap, nullptr).improve(force, clearance, 2, 3));
}

TEST(ActiveSet, MovesTheWorstNodeAloneWhenItStalls) {
  ActiveSet set(gap, nullptr);
  // Wherever they are, the nodes 2 and 3 are wrong, and 3 is the worse one.
  const VectorXd wrong = (VectorXd(5) << 1, 1, -1, -2, 1).finished();
  Nodes before = set.touching();
  int together = 0;
  for (int step = 0; step < 12; ++step) {
    EXPECT_FALSE(set.improve(wrong, wrong, 1, 1));
    const Nodes after = set.touching();
    const auto has = [](const Nodes& nodes, Index node) {
      return std::find(nodes.begin(), nodes.end(), node) != nodes.end();
    };
    EXPECT_NE(has(before, 3), has(after, 3));
    together += has(before, 2) != has(after, 2);
    before = after;
  }
  EXPECT_EQ(together, 9) << "the first step and eight without progress";
}

TEST(ActiveSet, NeverLetsGoOfTheLastNode) {
  ActiveSet set(gap, nullptr);
  EXPECT_FALSE(set.improve(VectorXd::Constant(5, -1), VectorXd::Ones(5), 1, 1));
  EXPECT_EQ(set.touching(), (Nodes{1}));
}

TEST(ActiveSet, GivesUpWithHowManyNodesKeepChanging) {
  ActiveSet set(gap, nullptr);
  const VectorXd wrong = (VectorXd(5) << 1, 1, -1, -2, 1).finished();
  set.improve(wrong, wrong, 1, 1);
  try {
    set.give_up();
    FAIL();
  } catch (const ConvergenceError& error) {
    EXPECT_EQ(error.iteration(), 200);
    EXPECT_EQ(error.residual(), 2);
  }
}

}  // namespace
}  // namespace softfinger::fem
