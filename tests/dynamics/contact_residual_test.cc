// The certificates of contact solutions: each of their terms has a solution, made by hand, that
// violates nothing else.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "softfinger/dynamics/contacts/contact_lcp.h"

namespace softfinger {
namespace {

constexpr double kOneRoundOff = 1e-15;

/// Directions of each axis, both signs: forces along the tangents, torques about the normal.
Eigen::Matrix3Xd axes() {
  Eigen::Matrix3Xd vertices(3, 6);
  vertices << Eigen::Matrix3d::Identity(), -Eigen::Matrix3d::Identity();
  return vertices;
}

/// A body on the floor at one point below its centre: 2 kg, 0.5 kg m² about the normal, e_n 0.5 m.
/// It falls at 1 m/s, so that P = 2 N s stops it: friction 0.5 then carries 1 N s.
ContactLcp block(const Eigen::Vector4d& velocity, FrictionRule rule = FrictionRule::facets) {
  ContactLcp problem;
  problem.delassus = Eigen::Vector4d(0.5, 0.5, 0.5, 2).asDiagonal();
  problem.free_velocity = velocity;
  problem.friction_coefficient.setConstant(1, 0.5);
  problem.eccentricity_m.setConstant(1, 0.5);
  problem.vertices = axes();
  problem.friction_rule = rule;
  return problem;
}

/// The solution with that load, weights of the facets' vertices and speed of slip.
ContactSolution with(const ContactLcp& problem, double load,
                     const std::vector<ContactSolution::Weight>& weights, double slip) {
  ContactSolution solution;
  solution.resize(1);
  solution.impulse[0] = load;
  for (const ContactSolution::Weight& weight : weights)
    solution.impulse.tail<3>() +=
        weight.value * Eigen::Vector3d(1, 1, 0.5).cwiseProduct(problem.vertices.col(weight.vertex));
  solution.weights = weights;
  solution.velocity = problem.delassus * solution.impulse + problem.free_velocity;
  solution.slip[0] = slip;
  return solution;
}

/// Residual under the exact rules of a solution that is given by its impulses.
double exact_residual(const ContactLcp& problem, const Eigen::Vector4d& impulse) {
  ContactSolution solution;
  solution.resize(1);
  solution.impulse = impulse;
  return exact_contact_residual(problem, solution);
}

TEST(ContactResidual, IsZeroForASolutionByHand) {
  // Free slip 2 m/s along x: friction of 1 N s against it leaves 1.5 m/s.
  const ContactLcp slides = block({-1, 2, 0, 0});
  EXPECT_LE(contact_residual(slides, with(slides, 2, {{0, 3, 1}}, 1.5)), kOneRoundOff);
  const ContactLcp sticks = block({-1, 0.25, 0, 0});
  EXPECT_LE(contact_residual(sticks, with(sticks, 2, {{0, 3, 0.5}}, 0)), kOneRoundOff);
  // Turns at 2 rad/s, e_n omega = 1 m/s: 0.5 N m s against it leave 0.5 m/s.
  const ContactLcp turns = block({-1, 0, 0, 2});
  EXPECT_LE(contact_residual(turns, with(turns, 2, {{0, 5, 1}}, 0.5)), kOneRoundOff);
}

TEST(ContactResidual, HasNoUnit) {
  for (const double scale : {1e-6, 1e6}) {
    const ContactLcp still = block({-scale, 0, 0, 0});
    EXPECT_NEAR(contact_residual(still, with(still, scale, {}, 0)), 0.5, kOneRoundOff);
    const ContactLcp slips = block({-scale, 0.5 * scale, 0, 0});
    EXPECT_NEAR(contact_residual(slips, with(slips, 2 * scale, {}, 0)), 0.5, kOneRoundOff);
    const ContactLcp exact = block({-scale, scale, 0, 0}, FrictionRule::ellipsoid);
    EXPECT_NEAR(exact_residual(exact, {2 * scale, 0, 0, 0}), 0.5, kOneRoundOff);
    EXPECT_NEAR(exact_residual(exact, {scale, -scale / 2, 0, 0}), 0.5, kOneRoundOff);
  }
}

TEST(ContactResidual, SeesThatBodiesApproachOrPull) {
  const ContactLcp still = block({-1, 0, 0, 0});
  // 0.5 m/s of approach are left.
  EXPECT_NEAR(contact_residual(still, with(still, 1, {}, 0)), 0.5, kOneRoundOff);
  // Pushed although they separate: 0.5 m/s.
  EXPECT_NEAR(contact_residual(still, with(still, 3, {}, 0)), 0.5, kOneRoundOff);
  // Pulled: W P = -1 m/s, and the cone of a negative load holds nothing.
  ContactLcp frictionless = block({1, 0, 0, 0});
  frictionless.friction_coefficient.setZero();
  EXPECT_NEAR(contact_residual(frictionless, with(frictionless, -2, {}, 0)), 1, kOneRoundOff);
}

TEST(ContactResidual, SeesSlipWithFrictionLeft) {
  // lambda = 1 m/s beside 1 of 2 N s that friction has left; the vertices leave it free to be so.
  const ContactLcp problem = block({-1, 0, 0, 0});
  EXPECT_NEAR(contact_residual(problem, with(problem, 2, {}, 1)), 0.5, kOneRoundOff);
}

TEST(ContactResidual, SeesFrictionBeyondTheCone) {
  // 1.5 N s where 1 N s may be carried, at rest: a quarter of the largest impulse too much.
  const ContactLcp problem = block({-1, 0.75, 0, 0});
  EXPECT_NEAR(contact_residual(problem, with(problem, 2, {{0, 3, 1.5}}, 0)), 0.25, kOneRoundOff);
}

TEST(ContactResidual, SeesSlipThatNoFrictionActsAgainst) {
  // Slips at 0.5 m/s, lambda = 0 denies it, no vertex has a weight.
  const ContactLcp problem = block({-1, 0.5, 0, 0});
  EXPECT_NEAR(contact_residual(problem, with(problem, 2, {}, 0)), 0.5, kOneRoundOff);
}

TEST(ContactResidual, SeesFrictionThatIsNotAgainstTheSlip) {
  // Slides along x at 2 m/s, friction of 1 N s is along y: there W beta = 0.5 m/s is the smaller of
  // the pair; v_free has 2 m/s.
  const ContactLcp problem = block({-1, 2, -0.5, 0});
  EXPECT_NEAR(contact_residual(problem, with(problem, 2, {{0, 1, 1}}, 2)), 0.25, kOneRoundOff);
}

TEST(ContactResidual, SeesNegativeWeights) {
  // -1 N s against +x acts along +x: at rest afterwards, but no such weight is allowed. W beta is
  // -0.5 m/s of 1 m/s. A second weight keeps the sum within the cone.
  const ContactLcp problem = block({-1, 0, 0, 0});
  EXPECT_NEAR(contact_residual(problem, with(problem, 2, {{0, 3, -1}, {0, 0, -1}}, 0)), 0.5,
              kOneRoundOff);
}

TEST(ContactResidual, SeesVelocitiesAndImpulsesThatDoNotBelongToTheWeights) {
  const ContactLcp problem = block({-1, 2, 0, 0});
  const ContactSolution solution = with(problem, 2, {{0, 3, 1}}, 1.5);
  for (int row = 0; row < 4; ++row) {
    ContactSolution wrong = solution;
    wrong.velocity[row] += 0.5;
    EXPECT_GE(contact_residual(problem, wrong), 0.2) << row;
    wrong = solution;
    wrong.impulse[row] += 0.5;
    EXPECT_GE(contact_residual(problem, wrong), 0.1) << row;
  }
}

TEST(ContactResidual, SeesWhatIsNoNumber) {
  const ContactLcp problem = block({-1, 2, 0, 0});
  ContactSolution solution = with(problem, 2, {{0, 3, 1}}, 1.5);
  solution.slip[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_GT(contact_residual(problem, solution), 1e300);
  solution = with(problem, 2, {{0, 3, 1}}, 1.5);
  solution.velocity[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_GT(contact_residual(problem, solution), 1e300);
  solution = with(problem, 2, {{0, 3, 1}}, 1.5);
  solution.weights[0].value = std::numeric_limits<double>::quiet_NaN();
  EXPECT_GT(contact_residual(problem, solution), 1e300);
}

TEST(ExactContactResidual, IsZeroForASolutionByHand) {
  const ContactLcp slides = block({-1, 2, 0, 0}, FrictionRule::ellipsoid);
  EXPECT_LE(exact_residual(slides, {2, -1, 0, 0}), kOneRoundOff);
  const ContactLcp sticks = block({-1, 0.25, 0, 0}, FrictionRule::ellipsoid);
  EXPECT_LE(exact_residual(sticks, {2, -0.5, 0, 0}), kOneRoundOff);
  const ContactLcp turns = block({-1, 0, 0, 2}, FrictionRule::ellipsoid);
  EXPECT_LE(exact_residual(turns, {2, 0, 0, -0.5}), kOneRoundOff);
}

TEST(ExactContactResidual, SeesThatBodiesApproachOrPull) {
  const ContactLcp still = block({-1, 0, 0, 0}, FrictionRule::ellipsoid);
  EXPECT_NEAR(exact_residual(still, {1, 0, 0, 0}), 0.5, kOneRoundOff);
  EXPECT_NEAR(exact_residual(still, {3, 0, 0, 0}), 0.5, kOneRoundOff);
  const ContactLcp apart = block({1, 0, 0, 0}, FrictionRule::ellipsoid);
  EXPECT_NEAR(exact_residual(apart, {-2, 0, 0, 0}), 1, kOneRoundOff);
}

TEST(ExactContactResidual, SeesFrictionBeyondTheLimit) {
  // Slides on at 0.1 m/s against 1.1 N s of friction; the largest impulse is 2 N s. As velocities
  // the excess is smaller: 0.05 m/s of 1.
  ContactLcp problem = block({-1, 0.65, 0, 0}, FrictionRule::ellipsoid);
  EXPECT_NEAR(exact_residual(problem, {2, -1.1, 0, 0}), 0.05, kOneRoundOff);
  // The velocity unit is now so large that only the excess over the largest impulse is seen.
  problem.delassus *= 1e-6;
  problem.free_velocity = Eigen::Vector4d(-1e-6, 1, 0, 0);
  EXPECT_NEAR(exact_residual(problem, {2, -1.1, 0, 0}), 0.05, kOneRoundOff);
}

TEST(ExactContactResidual, SeesFrictionThatIsNotAgainstTheSlip) {
  // The body rests along x, but slides along y at 1 m/s without friction there.
  const ContactLcp problem = block({-1, 0.5, 1, 0}, FrictionRule::ellipsoid);
  EXPECT_GE(exact_residual(problem, {2, -1, 0, 0}), 0.2);
  // Slips without any friction: it could move by W s = 0.5 m/s of 1 m/s.
  const ContactLcp free = block({-1, 1, 0, 0}, FrictionRule::ellipsoid);
  EXPECT_NEAR(exact_residual(free, {2, 0, 0, 0}), 0.5, kOneRoundOff);
}

TEST(ExactContactResidual, SeesATorqueWithoutAnArm) {
  ContactLcp problem = block({-1, 0, 0, 0}, FrictionRule::ellipsoid);
  problem.eccentricity_m.setZero();
  EXPECT_NEAR(exact_residual(problem, {2, 0, 0, 0.5}), 0.25, kOneRoundOff);
}

/// A body between walls that close. Added to impulses of 1e17 its velocity is lost, and both walls
/// seem to have what they need.
TEST(ContactResidual, IsNotZeroWhereImpulsesAbsorbTheVelocities) {
  ContactLcp problem;
  problem.delassus.setZero(8, 8);
  problem.delassus.diagonal().setOnes();
  problem.delassus(0, 4) = problem.delassus(4, 0) = -1;
  problem.free_velocity.setZero(8);
  problem.free_velocity[0] = problem.free_velocity[4] = -1;
  problem.friction_coefficient.setConstant(2, 0.5);
  problem.eccentricity_m.setConstant(2, 0.5);
  problem.vertices = axes();
  ContactSolution solution;
  solution.resize(2);
  solution.impulse[0] = solution.impulse[4] = 1e17;
  // Four roundings of both impulses.
  const double least = 4 * 0x1p-52 * 2e17;
  EXPECT_GE(contact_residual(problem, solution), least);
  problem.friction_rule = FrictionRule::ellipsoid;
  EXPECT_GE(exact_contact_residual(problem, solution), least);
}

TEST(ExactContactResidual, SeesWhatIsNoNumber) {
  ContactLcp problem = block({-1, 0, 0, 0}, FrictionRule::ellipsoid);
  problem.delassus *= 1e300;
  EXPECT_GT(exact_residual(problem, {1e300, 0, 0, 0}), 1e300);
  problem = block({-1, 0, 0, 0}, FrictionRule::ellipsoid);
  problem.delassus(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_GT(exact_residual(problem, {2, 0, 0, 0}), 1e300);
}

}  // namespace
}  // namespace softfinger
