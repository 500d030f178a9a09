// Motion without contacts: order two, energy and momenta over many steps, and its transition to
// motion with contacts and joint limits.
#include "softfinger/dynamics/bodies/smooth_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "softfinger/dynamics/step/time_stepper.h"
#include "softfinger/input/constants.h"
#include "tests/dynamics/simple_contacts.h"

namespace softfinger {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using tests::SimpleContacts;
constexpr double kStandardGravity = 9.81;

TimeStepper::Options stepping(double time_step_s, double gravity = kStandardGravity) {
  TimeStepper::Options result;
  result.time_step_s = time_step_s;
  result.gravity_m_per_s2 = Vector3d(0, 0, -gravity);
  return result;
}

/// Small balls on rods without mass: the first hangs on the world, each other on the one before.
/// All rods point along x.
Multibody chain_of_balls(int count, double length_m, JointKind kind = JointKind::revolute) {
  std::vector<BodyDescription> bodies;
  std::vector<JointDescription> joints(static_cast<std::size_t>(count));
  for (int b = 0; b < count; ++b) {
    bodies.push_back(
        tests::ball("ball " + std::to_string(b), 0.01, 1, Vector3d((b + 1) * length_m, 0, 0)));
    JointDescription& joint = joints[std::size_t(b)];
    joint.name = "joint " + std::to_string(b);
    joint.parent = b - 1;
    joint.child = b;
    joint.kind = kind;
    joint.anchor_m = Vector3d(b * length_m, 0, 0);
    joint.axis = Vector3d::UnitY();
  }
  return Multibody(bodies, joints);
}

double total_energy_J(const TimeStepper& stepper) {
  return stepper.bodies().kinetic_energy_J() +
         stepper.bodies().potential_energy_J(stepper.options().gravity_m_per_s2);
}

/// Steps for a time and returns where the bodies' centres are.
VectorXd positions_after(TimeStepper stepper, double time_s,
                         std::vector<AppliedForce> forces = {}) {
  SimpleContacts none;
  stepper.applied_forces() = forces;
  const long steps = std::lround(time_s / stepper.options().time_step_s);
  for (long i = 0; i < steps; ++i) {
    const StepResult result = stepper.step(none);
    EXPECT_TRUE(result.done());
    EXPECT_EQ(result.smooth_trees, int(stepper.bodies().trees().size()));
  }
  const Multibody& bodies = stepper.bodies();
  VectorXd result(6 * bodies.bodies());
  for (int b = 0; b < bodies.bodies(); ++b)
    result.segment<6>(6 * b) << bodies.center_of_mass_m(b), bodies.pose(b).linear().col(0);
  return result;
}

/// Expects the error to fall with the square of the time step, for two halvings in a row.
void expect_second_order(const Multibody& bodies, double time_s, double time_step_s,
                         const std::vector<AppliedForce>& forces = {}) {
  // With the error C dt² + D dt⁴, differences of halved steps have ratios 4 + 15 D/C dt².
  std::array<VectorXd, 4> at;
  for (int i = 0; i < 4; ++i)
    at[std::size_t(i)] = positions_after(
        TimeStepper(bodies, {}, stepping(time_step_s / std::pow(2, i))), time_s, forces);
  for (int i = 0; i < 2; ++i) {
    const double order = std::log2((at[std::size_t(i)] - at[std::size_t(i) + 1]).norm() /
                                   (at[std::size_t(i) + 1] - at[std::size_t(i) + 2]).norm());
    std::printf("time step %g ms: order %.3f, difference to half of it %.1e m\n",
                1e3 * time_step_s / std::pow(2, i), order,
                (at[std::size_t(i)] - at[std::size_t(i) + 1]).norm());
    EXPECT_NEAR(order, 2, 0.05);
  }
}

TEST(SmoothMotion, OfADoublePendulumIsOfOrderTwo) {
  expect_second_order(chain_of_balls(2, 0.3), 0.5, 2e-3);
}

TEST(SmoothMotion, OfAChainOnBallJointsIsOfOrderTwo) {
  Multibody bodies = chain_of_balls(3, 0.2, JointKind::ball);
  bodies.set_velocity(VectorXd::LinSpaced(9, -2, 3));
  expect_second_order(bodies, 0.25, 1e-3);
}

/// A body that floats with two arms, one on a ball joint and one on a slide.
Multibody floating_body() {
  std::vector<BodyDescription> bodies = {
      tests::box("body", Vector3d(0.1, 0.2, 0.3), 2, Vector3d::Zero()),
      tests::box("arm", Vector3d(0.3, 0.05, 0.04), 0.5, Vector3d(0.2, 0.1, 0)),
      tests::box("slide", Vector3d(0.05, 0.1, 0.2), 0.7, Vector3d(0, 0, 0.3))};
  bodies[1].mass.center_m = Vector3d(0.02, -0.01, 0.03);
  std::vector<JointDescription> joints(2);
  joints[0] = {"shoulder", 0, 1, JointKind::ball};
  joints[0].anchor_m = Vector3d(0.05, 0.1, 0);
  joints[1] = {"rail", 0, 2, JointKind::prismatic};
  joints[1].axis = Vector3d(0, 1, 2);
  Multibody result(bodies, joints);
  VectorXd velocity(10);
  velocity << 0.2, -0.1, 0.3, 2, -3, 4, 1, 5, -2, 0.4;
  result.set_velocity(velocity);
  return result;
}

TEST(SmoothMotion, OfAFloatingTreeIsOfOrderTwo) {
  expect_second_order(floating_body(), 0.25, 1e-3);
}

TEST(SmoothMotion, OfABodyPulledAtAPointIsOfOrderTwo) {
  BodyDescription body = tests::box("body", Vector3d(0.1, 0.2, 0.3), 2, Vector3d::Zero());
  body.angular_velocity_rad_per_s = Vector3d(3, -2, 5);
  AppliedForce pull;
  pull.body = 0;
  pull.point_in_body_m = Vector3d(0.05, 0.1, -0.02);
  pull.force_N = Vector3d(3, 10, -4);
  expect_second_order(Multibody({body}, {}), 0.25, 2e-3, {pull});
}

TEST(SmoothMotion, FallsExactly) {
  BodyDescription body = tests::box("body", Vector3d(0.1, 0.2, 0.3), 2, Vector3d(1, 2, 3));
  body.velocity_m_per_s = Vector3d(1, -2, 4);
  body.angular_velocity_rad_per_s = Vector3d(1, 2, 3);
  const double time = 1;
  const VectorXd at = positions_after(TimeStepper(Multibody({body}, {}), {}, stepping(1e-2)), time);
  const Vector3d expected = Vector3d(1, 2, 3) + time * body.velocity_m_per_s +
                            time * time / 2 * Vector3d(0, 0, -kStandardGravity);
  const double steps = 100;
  EXPECT_LE((at.head<3>() - expected).norm(), steps * kEpsilon * expected.norm());
}

TEST(SmoothMotion, KeepsTheEnergyOfADoublePendulumForAHundredThousandSteps) {
  // Released with both rods level, where it moves chaotically.
  const double length = 1;
  for (const double time_step : {1e-3, 5e-4}) {
    TimeStepper stepper(chain_of_balls(2, length), {}, stepping(time_step));
    SimpleContacts none;
    const double start = total_energy_J(stepper),
                 scale = kStandardGravity * length;  // m g l, m = 1 kg
    double least = 0, most = 0, middle = 0;
    const int steps = 100000;
    for (int i = 0; i < steps; ++i) {
      ASSERT_TRUE(stepper.step(none).done());
      least = std::min(least, (total_energy_J(stepper) - start) / scale);
      most = std::max(most, (total_energy_J(stepper) - start) / scale);
      if (i == steps / 2) middle = most - least;
    }
    std::printf(
        "double pendulum, %d steps of %g ms: energy within %.1e and %.1e m g l, at the end "
        "%.1e\n",
        steps, 1e3 * time_step, least, most, (total_energy_J(stepper) - start) / scale);
    // The error is of second order: the bound is a multiple of (dt w)², w² = g/l; the fastest turns
    // are ten times faster than that.
    const double bound = 100 * time_step * time_step * kStandardGravity / length;
    EXPECT_LE(most - least, bound);
    // It does not grow: the second half needs no wider band than chance makes of the first.
    EXPECT_LE(most - least, 2 * middle);
  }
}

TEST(SmoothMotion, KeepsMomentaAndEnergyOfATumblingBody) {
  // About its middle axis, which is unstable (Dzhanibekov's nut).
  BodyDescription body = tests::box("nut", Vector3d(0.1, 0.2, 0.3), 2, Vector3d::Zero());
  body.angular_velocity_rad_per_s = Vector3d(0.1, 20, 0.2);
  body.velocity_m_per_s = Vector3d(0.3, -0.2, 0.1);
  TimeStepper stepper(Multibody({body}, {}), {}, stepping(1e-3, 0));
  SimpleContacts none;
  const Vector3d linear = stepper.bodies().linear_momentum_N_s(),
                 angular = stepper.bodies().angular_momentum_N_m_s();
  const double start = total_energy_J(stepper);
  const int steps = 100000;
  int turns = 0;
  double side = 1;
  for (int i = 0; i < steps; ++i) {
    ASSERT_TRUE(stepper.step(none).done());
    const double now = stepper.bodies().pose(0).linear()(1, 1);
    if (now * side < -0.5) {
      ++turns;
      side = -side;
    }
  }
  std::printf("tumbling body: %d turns, energy %.1e, angular momentum %.1e relative\n", turns,
              total_energy_J(stepper) / start - 1,
              (stepper.bodies().angular_momentum_N_m_s() - angular).norm() / angular.norm());
  EXPECT_GT(turns, 10);
  const double round_off = steps * 16 * kEpsilon;
  EXPECT_LE((stepper.bodies().linear_momentum_N_s() - linear).norm(), round_off * linear.norm());
  EXPECT_LE((stepper.bodies().angular_momentum_N_m_s() - angular).norm(),
            round_off * angular.norm() * 10);
  EXPECT_NEAR(total_energy_J(stepper) / start, 1, round_off);
}

TEST(SmoothMotion, KeepsMomentaOfAFloatingTreeToRoundOffAndItsEnergyInSecondOrder) {
  double last = 0;
  for (const double time_step : {2e-3, 1e-3}) {
    TimeStepper stepper(floating_body(), {}, stepping(time_step, 0));
    SimpleContacts none;
    const Vector3d linear = stepper.bodies().linear_momentum_N_s(),
                   angular = stepper.bodies().angular_momentum_N_m_s();
    const double start = total_energy_J(stepper);
    double departure = 0;
    const int steps = int(std::lround(1 / time_step));
    for (int i = 0; i < steps; ++i) {
      ASSERT_TRUE(stepper.step(none).done());
      departure = std::max(departure, std::abs(total_energy_J(stepper) / start - 1));
    }
    // Each step solves for its velocities to a few roundings.
    const double round_off = steps * 100 * kEpsilon;
    EXPECT_LE((stepper.bodies().linear_momentum_N_s() - linear).norm(), round_off * linear.norm());
    EXPECT_LE((stepper.bodies().angular_momentum_N_m_s() - angular).norm(),
              round_off * angular.norm());
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / departure), 2, 0.1);
    }
    last = departure;
  }
}

TEST(SmoothMotion, GivesWayToContacts) {
  // A ball on a rod swings down onto a floor, and a free ball falls beside it.
  Multibody pendulum = chain_of_balls(1, 0.3);
  std::vector<BodyDescription> bodies = {pendulum.body(0), tests::ground(),
                                         tests::ball("free", 0.01, 1, Vector3d(1, 0, 0.2))};
  bodies[1].pose.translation().z() = -0.2;
  TimeStepper stepper(Multibody(bodies, {pendulum.joint(0)}), {}, stepping(1e-3));
  SimpleContacts contacts;
  for (const int ball : {0, 2}) {
    SimpleContacts::Pair pair{SimpleContacts::Pair::Kind::ball_on_plane, 1, ball};
    pair.radius_b_m = 0.01;
    pair.friction_coefficient = 0.5;
    contacts.pairs.push_back(pair);
  }
  const double start = total_energy_J(stepper);
  double last = start;
  int touching = 0;
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(stepper.step(contacts).done());
    const bool touches = stepper.solution().impulse.size() > 0 &&
                         stepper.solution().impulse.cwiseAbs().maxCoeff() > 0;
    touching += touches;
    // The rod's energy is that of second order between contacts, (dt w)² m g l/10 at most.
    ASSERT_LE(total_energy_J(stepper) - last, 1e-6 * start + 1e-5 * kStandardGravity * 0.3) << i;
    last = total_energy_J(stepper);
    for (int c = 0; c < int(stepper.contacts().size()); ++c)
      ASSERT_GE(stepper.contacts()[std::size_t(c)].gap_m, -1e-5);
  }
  EXPECT_GT(touching, 500);
  EXPECT_LE(stepper.bodies().velocity().norm(), 1e-9) << "both rest";
}

TEST(SmoothMotion, KeepsToJointLimits) {
  Multibody free = chain_of_balls(1, 0.3);
  JointDescription joint = free.joint(0);
  joint.upper = 1;  // falls by about 57 degrees
  TimeStepper stepper(Multibody({free.body(0)}, {joint}), {}, stepping(1e-3));
  SimpleContacts none;
  int smooth = 0;
  for (int i = 0; i < 500; ++i) {
    const StepResult result = stepper.step(none);
    ASSERT_TRUE(result.done());
    smooth += result.smooth_trees;
    ASSERT_LE(stepper.bodies().joint_position(0), 1 + 4 * kEpsilon);
  }
  EXPECT_GT(smooth, 100) << "until it reaches the limit";
  EXPECT_LT(smooth, 400) << "not when it lies there";
  EXPECT_NEAR(stepper.bodies().joint_position(0), 1, 4 * kEpsilon);
}

}  // namespace
}  // namespace softfinger
