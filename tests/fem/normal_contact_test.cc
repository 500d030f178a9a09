#include "fem/contact/normal_contact.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <random>

namespace softfinger::fem {
namespace {

Eigen::MatrixXd random_compliance(int size, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  Eigen::MatrixXd root(size, size);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) root(i, j) = normal(random);
  return root * root.transpose() + 0.1 * Eigen::MatrixXd::Identity(size, size);
}

/// Minimises the energy over every possible active set: slow and independent of any iteration.
Eigen::VectorXd force_by_enumeration(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& gap,
                                     double load) {
  const int size = static_cast<int>(gap.size());
  double best = std::numeric_limits<double>::infinity();
  Eigen::VectorXd best_force;
  for (unsigned int mask = 1; mask < (1u << size); ++mask) {
    std::vector<int> set;
    for (int i = 0; i < size; ++i)
      if (mask & (1u << i)) set.push_back(i);
    const auto count = static_cast<Eigen::Index>(set.size());
    // Stationary point of f.C f/2 + gap.f subject to sum f = load, on this set.
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(count + 1, count + 1);
    system.topLeftCorner(count, count) = compliance(set, set);
    system.col(count).head(count).setOnes();
    system.row(count).head(count).setOnes();
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count + 1);
    right.head(count) = -gap(set);
    right[count] = load;
    const Eigen::VectorXd solution = system.partialPivLu().solve(right);
    if (solution.head(count).minCoeff() < 0) continue;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(size);
    force(set) = solution.head(count);
    const double energy = 0.5 * force.dot(compliance * force) + gap.dot(force);
    if (energy < best) {
      best = energy;
      best_force = force;
    }
  }
  return best_force;
}

TEST(NormalContact, EqualsTheEnergyMinimumOverAllActiveSets) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int trial = 0; trial < 200; ++trial) {
    const int size = 2 + trial % 7;
    const Eigen::MatrixXd compliance = random_compliance(size, random);
    Eigen::VectorXd gap(size);
    for (auto& value : gap) value = 3 * uniform(random);
    const double load = std::pow(10.0, -2 + 4 * uniform(random));
    const NormalContact contact = solve_normal_contact(compliance, gap, load);
    const Eigen::VectorXd expected = force_by_enumeration(compliance, gap, load);
    // Both solve systems whose condition is at most about 1e3.
    EXPECT_LT((contact.force - expected).norm(), 1e-11 * load) << "trial " << trial;
  }
}

TEST(NormalContact, IsExactlyComplementary) {
  std::mt19937_64 random(2);
  const int size = 120;
  const Eigen::MatrixXd compliance = random_compliance(size, random);
  const Eigen::VectorXd gap = Eigen::VectorXd::LinSpaced(size, 0, 20);
  const NormalContact contact = solve_normal_contact(compliance, gap, 1);
  const Eigen::VectorXd clearance =
      compliance * contact.force - Eigen::VectorXd::Constant(size, contact.approach) + gap;
  const double round_off = 1e-10 * (contact.approach + gap.maxCoeff());
  EXPECT_GE(contact.force.minCoeff(), 0);
  EXPECT_GE(clearance.minCoeff(), -round_off);
  for (int i = 0; i < size; ++i)
    EXPECT_TRUE(contact.force[i] == 0 || std::abs(clearance[i]) < round_off) << "node " << i;
  EXPECT_NEAR(contact.force.sum(), 1, 1e-12);
}

TEST(NormalContact, DoesNotDependOnTheOriginOfTheGap) {
  std::mt19937_64 random(3);
  const Eigen::MatrixXd compliance = random_compliance(20, random);
  const Eigen::VectorXd gap = Eigen::VectorXd::LinSpaced(20, 0, 5);
  const NormalContact contact = solve_normal_contact(compliance, gap, 2);
  const NormalContact shifted =
      solve_normal_contact(compliance, gap + Eigen::VectorXd::Constant(20, 7.0), 2);
  EXPECT_LT((contact.force - shifted.force).norm(), 1e-11);
  EXPECT_NEAR(shifted.approach - contact.approach, 7, 1e-11);
}

TEST(NormalContact, MayBeDrivenByItsApproach) {
  std::mt19937_64 random(4);
  const Eigen::MatrixXd compliance = random_compliance(40, random);
  const Eigen::VectorXd gap = Eigen::VectorXd::LinSpaced(40, 0, 10);
  const NormalContact by_load = solve_normal_contact(compliance, gap, 2);
  const NormalContact by_approach = solve_normal_contact_at(compliance, gap, by_load.approach);
  EXPECT_LT((by_approach.force - by_load.force).norm(), 1e-11);
  EXPECT_EQ(by_approach.approach, by_load.approach);
  EXPECT_EQ(by_approach.active, by_load.active);
}

TEST(NormalContact, IsTheSameByTheFactorOfNearlyTheSameNodes) {
  constexpr int size = 120;
  Eigen::MatrixXd compliance(size, size);
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) compliance(i, j) = std::exp(-std::abs(i - j) / 5.0);
  TouchingFactor kept;
  int bordered = 0;
  // The contact rolls along, and after a third of its path grows and shrinks as it does.
  for (int step = 0; step < 60; ++step) {
    const Eigen::ArrayXd from_centre =
        Eigen::ArrayXd::LinSpaced(size, 0, size - 1) - 45 - step / 3.0;
    const Eigen::VectorXd gap = 1e-3 * from_centre.square();
    const double load = step < 20 ? 20 : 20 + 5 * (step % 5);
    const NormalContact expected = solve_normal_contact(compliance, gap, load),
                        contact = solve_normal_contact(compliance, gap, load, &expected, &kept);
    // Round-off, by the compliance's condition number of some hundred.
    constexpr double round_off = 1e-11;
    EXPECT_LT((contact.force - expected.force).norm(), round_off * expected.force.norm()) << step;
    EXPECT_NEAR(contact.approach, expected.approach, round_off * expected.approach) << step;
    bordered += static_cast<int>(kept.nodes.size()) != contact.active ||
                (contact.force(kept.nodes).array() <= 0).any();
  }
  EXPECT_GT(bordered, 10) << "other nodes touched than those of the factor";
}

TEST(NormalContact, OfOneNodeIsASpring) {
  const NormalContact contact = solve_normal_contact(Eigen::MatrixXd::Constant(1, 1, 0.25),
                                                     Eigen::VectorXd::Constant(1, 3), 8);
  EXPECT_DOUBLE_EQ(contact.force[0], 8);
  EXPECT_DOUBLE_EQ(contact.approach, 5);
}

}  // namespace
}  // namespace softfinger::fem
