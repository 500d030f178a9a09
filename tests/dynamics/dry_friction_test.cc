// Dry friction of joints against closed forms: what holds, how what slides slows down, and how much
// energy a swing loses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "softfinger/dynamics/step/time_stepper.h"
#include "tests/dynamics/simple_contacts.h"

namespace softfinger {
namespace {

using Eigen::Vector3d;
using tests::SimpleContacts;

constexpr double kGravity_m_per_s2 = 9.81;
/// Sums of a few thousand steps.
constexpr double kSumRoundOff = 1e-11;

TimeStepper::Options options_of(double time_step_s, const Vector3d& gravity = Vector3d::Zero()) {
  TimeStepper::Options result;
  result.time_step_s = time_step_s;
  result.gravity_m_per_s2 = gravity;
  return result;
}

/// A block of 2 kg on a slide along x.
Multibody sliding_block(double dry_friction_N) {
  JointDescription joint;
  joint.name = "slide";
  joint.child = 0;
  joint.kind = JointKind::prismatic;
  joint.axis = Vector3d::UnitX();
  joint.dry_friction = dry_friction_N;
  return Multibody({tests::box("block", Vector3d(0.1, 0.1, 0.1), 2, Vector3d::Zero())}, {joint});
}

TEST(DryFriction, HoldsABlockBelowItAndOpposesItAbove) {
  const double mass_kg = 2, friction_N = 3, dt = 1e-3;
  for (const double force_N : {0., 1., 2.999, 3.001, 4., 300.})
    for (const double direction : {1., -1.}) {
      TimeStepper stepper(sliding_block(friction_N), {}, options_of(dt));
      AppliedForce push;
      push.body = 0;
      push.force_N = direction * force_N * Vector3d::UnitX();
      stepper.applied_forces().push_back(push);
      SimpleContacts none;
      const int steps = 500;
      for (int i = 0; i < steps; ++i) {
        const StepResult result = stepper.step(none);
        ASSERT_TRUE(result.done());
      }
      const double expected = direction * std::max(0., force_N - friction_N) / mass_kg * steps * dt;
      EXPECT_NEAR(stepper.bodies().velocity()[0], expected, kSumRoundOff * (1 + std::abs(expected)))
          << force_N;
    }
}

TEST(DryFriction, StopsASlidingBlockWhereTheClosedFormSays) {
  const double mass_kg = 2, friction_N = 3, speed_m_per_s = 0.6;
  for (const double dt : {1e-3, 1e-4}) {
    TimeStepper stepper(sliding_block(friction_N), {}, options_of(dt));
    stepper.bodies().set_velocity(Eigen::VectorXd::Constant(1, speed_m_per_s));
    SimpleContacts none;
    double time_s = 0;
    while (stepper.bodies().velocity()[0] > 1e-12 && time_s < 1) {
      ASSERT_TRUE(stepper.step(none).done());
      time_s = stepper.time_s();
    }
    EXPECT_NEAR(time_s, mass_kg * speed_m_per_s / friction_N, 1.01 * dt);
    // Steps move by the velocity at their end: half a step times the speed is missing.
    const double way_m = mass_kg * speed_m_per_s * speed_m_per_s / (2 * friction_N);
    EXPECT_NEAR(stepper.bodies().joint_position(0), way_m, 1.01 * dt * speed_m_per_s / 2);
  }
}

/// A ball of 0.3 kg on a massless rod of 0.2 m, off the vertical by `start_rad`.
Multibody swinging_ball(double start_rad, double dry_friction_Nm) {
  BodyDescription ball = tests::box("ball", Vector3d::Constant(1e-3), 0.3, Vector3d::Zero());
  ball.pose.translation() = 0.2 * Vector3d(std::sin(start_rad), 0, -std::cos(start_rad));
  JointDescription joint;
  joint.name = "pin";
  joint.child = 0;
  joint.kind = JointKind::revolute;
  joint.axis = Vector3d::UnitY();
  joint.dry_friction = dry_friction_Nm;
  return Multibody({ball}, {joint});
}

/// The turning point of a swing that begins at rest at `from`, on the other side: friction takes
/// what the weight gives, m g l (cos b - cos a) = M (a + b).
double turning_point(double from_rad, double weight_Nm, double friction_Nm) {
  double low = -from_rad, high = from_rad;
  for (int i = 0; i < 200; ++i) {
    const double b = (low + high) / 2;
    const double left =
        weight_Nm * (std::cos(b) - std::cos(from_rad)) - friction_Nm * (from_rad + b);
    (left > 0 ? low : high) = b;
  }
  return low;
}

TEST(DryFriction, TakesFromAPendulumWhatTheClosedFormSays) {
  const double friction_Nm = 0.02, start_rad = 1.2;
  const double weight_Nm = 0.3 * kGravity_m_per_s2 * 0.2;
  double before = 0;
  for (const double dt : {4e-4, 2e-4, 1e-4}) {
    TimeStepper stepper(swinging_ball(start_rad, friction_Nm), {},
                        options_of(dt, Vector3d(0, 0, -kGravity_m_per_s2)));
    SimpleContacts none;
    double expected = start_rad, worst = 0, side = 1;
    int swings = 0;
    double last = 0;
    for (int i = 0; i < int(6 / dt) && swings < 4; ++i) {
      ASSERT_TRUE(stepper.step(none).done());
      const double speed = stepper.bodies().velocity()[0];
      if (i > 10 && speed * last < 0) {
        expected = turning_point(expected, weight_Nm, friction_Nm);
        side = -side;
        const Vector3d at = stepper.bodies().pose(0).translation();
        const double angle = std::abs(std::atan2(at.x(), -at.z()));
        worst = std::max(worst, std::abs(angle - expected));
        ++swings;
      }
      if (speed != 0) last = speed;
    }
    EXPECT_EQ(swings, 4);
    std::printf("pendulum, step %.1f ms: turns within %.1e rad of the closed form\n", 1e3 * dt,
                worst);
    // The steps are of first order.
    if (before > 0) {
      EXPECT_LT(worst, 0.6 * before);
    }
    before = worst;
  }
}

TEST(DryFriction, HoldsAPendulumAsideForGood) {
  const double weight_Nm = 0.3 * kGravity_m_per_s2 * 0.2, aside_rad = 0.5;
  for (const double part : {1.01, 0.99}) {
    TimeStepper stepper(swinging_ball(aside_rad, part * weight_Nm * std::sin(aside_rad)), {},
                        options_of(1e-3, Vector3d(0, 0, -kGravity_m_per_s2)));
    SimpleContacts none;
    for (int i = 0; i < 1000; ++i) ASSERT_TRUE(stepper.step(none).done());
    const double turned = std::abs(stepper.bodies().joint_position(0));
    if (part > 1)
      EXPECT_LT(turned, 1e-12);
    else
      EXPECT_GT(turned, 1e-2);
  }
}

/// Each law of friction has it, and contacts beside it: a block on a slide that leans on the floor
/// is held by both together.
TEST(DryFriction, AddsToThatOfContacts) {
  const double mass_kg = 2, friction = 0.4, dry_N = 3;
  JointDescription along, up;
  up.name = "up";
  up.child = 0;
  up.kind = JointKind::prismatic;
  up.axis = Vector3d::UnitZ();
  along.name = "along";
  along.parent = 0;
  along.child = 1;
  along.kind = JointKind::prismatic;
  along.axis = Vector3d::UnitX();
  along.dry_friction = dry_N;
  const double half_m = 0.05;
  BodyDescription carrier =
      tests::box("carrier", Vector3d::Constant(0.01), 1e-3, Vector3d(0, 0, half_m));
  BodyDescription block =
      tests::box("block", Vector3d::Constant(2 * half_m), mass_kg, Vector3d(0, 0, half_m));
  BodyDescription floor = tests::box("floor", Vector3d::Constant(0.1), 1, Vector3d(0, 0, -1));
  floor.fixed = true;
  const double most_N = friction * (mass_kg + 1e-3) * kGravity_m_per_s2 + dry_N;
  for (const FrictionRule rule : {FrictionRule::ellipsoid, FrictionRule::limit_surface})
    for (const double part : {0.999, 1.001}) {
      TimeStepper::Options options = options_of(1e-3, Vector3d(0, 0, -kGravity_m_per_s2));
      options.friction_rule = rule;
      TimeStepper stepper(Multibody({carrier, block, floor}, {up, along}), {}, options);
      AppliedForce push;
      push.body = 1;
      push.force_N = part * most_N * Vector3d::UnitX();
      stepper.applied_forces().push_back(push);
      struct Floor : ContactFinder {
        double friction = 0, half_m = 0;
        void find(const Multibody& bodies, double, std::vector<Contact>& contacts) override {
          Contact contact;
          contact.a = 2;
          contact.b = 1;
          contact.point_m = bodies.pose(1).translation() - half_m * Vector3d::UnitZ();
          contact.gap_m = contact.point_m.z();
          contact.friction_coefficient = friction;
          contact.id = 1;
          contacts.push_back(contact);
        }
      } on_floor;
      on_floor.friction = friction;
      on_floor.half_m = half_m;
      for (int i = 0; i < 200; ++i) ASSERT_TRUE(stepper.step(on_floor).done());
      const double speed = stepper.bodies().velocity()[1];
      const double expected = part > 1 ? (part - 1) * most_N / mass_kg * 0.2 : 0;
      EXPECT_NEAR(speed, expected, 1e-9) << part;
    }
}

/// The energy of a chain that swings in three joints with friction never grows, whatever the steps.
TEST(DryFriction, NeverAddsEnergy) {
  std::vector<BodyDescription> bodies;
  std::vector<JointDescription> joints;
  for (int i = 0; i < 3; ++i) {
    bodies.push_back(tests::box("link", Vector3d(0.2, 0.02, 0.02), 0.3 - 0.05 * i,
                                Vector3d(0.1 + 0.2 * i, 0, 0)));
    bodies.back().name += char('a' + i);
    JointDescription joint;
    joint.name = std::string("joint") + char('a' + i);
    joint.parent = i - 1;
    joint.child = i;
    joint.kind = JointKind::revolute;
    joint.axis = Vector3d(0.1 * i, 1, 0.2);
    joint.anchor_m = Vector3d(0.2 * i, 0, 0);
    joint.dry_friction = 0.03 * i;
    joints.push_back(joint);
  }
  const Vector3d gravity(0, 0, -kGravity_m_per_s2);
  for (const double dt : {1e-3, 5e-3}) {
    TimeStepper stepper(Multibody(bodies, joints), {}, options_of(dt, gravity));
    SimpleContacts none;
    const auto energy = [&] {
      return stepper.bodies().kinetic_energy_J() + stepper.bodies().potential_energy_J(gravity);
    };
    const double start = energy();
    double most = start;
    for (int i = 0; i < int(8 / dt); ++i) {
      ASSERT_TRUE(stepper.step(none).done());
      most = std::max(most, energy());
    }
    EXPECT_LT(most, start + 1e-9);
    EXPECT_LT(energy(), start - 0.1);
  }
}

}  // namespace
}  // namespace softfinger
