// Closed loops and ball joints: linkages against closed forms, drift, energy, contacts and limits
// on loops.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "softfinger/dynamics/step/time_stepper.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "tests/dynamics/simple_contacts.h"

namespace softfinger {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using tests::SimpleContacts;
constexpr double kFall = 9.81;

TimeStepper::Options fall_with(double time_step_s) {
  TimeStepper::Options result;
  result.time_step_s = time_step_s;
  result.gravity_m_per_s2 = Vector3d(0, 0, -kFall);
  return result;
}

double energy_J(const Multibody& bodies) {
  return bodies.kinetic_energy_J() + bodies.potential_energy_J(Vector3d(0, 0, -kFall));
}

/// A rod of 1 kg per metre between two points of the plane y = 0.
BodyDescription rod(const std::string& name, const Vector2d& from, const Vector2d& to) {
  const Vector2d along = to - from;
  BodyDescription body = tests::box(name, Vector3d(along.norm(), 0.02, 0.01), along.norm(),
                                    Vector3d((from + to).x() / 2, 0, (from + to).y() / 2));
  body.pose.linear() =
      Eigen::AngleAxisd(-std::atan2(along.y(), along.x()), Vector3d::UnitY()).toRotationMatrix();
  return body;
}

JointDescription hinge(const std::string& name, int parent, int child, const Vector2d& anchor) {
  JointDescription joint;
  joint.name = name;
  joint.parent = parent;
  joint.child = child;
  joint.kind = JointKind::revolute;
  joint.axis = -Vector3d::UnitY();  // counter-clockwise from x to z
  joint.anchor_m = Vector3d(anchor.x(), 0, anchor.y());
  return joint;
}

/// Crank, coupler and rocker over a ground of length 0.5 m, in the plane y = 0.
struct FourBar {
  const double ground = 0.5, crank = 0.15, coupler = 0.45, rocker = 0.35;

  /// Position of the pin between coupler and rocker: where two circles meet, above.
  Vector2d pin(double crank_rad) const {
    const Vector2d elbow = crank * Vector2d(std::cos(crank_rad), std::sin(crank_rad));
    const Vector2d apart = Vector2d(ground, 0) - elbow;
    const double d = apart.norm();
    const double along = (d * d + coupler * coupler - rocker * rocker) / (2 * d);
    const double beside = std::sqrt(coupler * coupler - along * along);
    return elbow + along / d * apart + beside / d * Vector2d(-apart.y(), apart.x());
  }
  Multibody bodies(double crank_rad, JointKind kind) const {
    const Vector2d elbow = crank * Vector2d(std::cos(crank_rad), std::sin(crank_rad));
    const Vector2d top = pin(crank_rad), base(ground, 0);
    LoopDescription loop;
    loop.name = "pin";
    loop.a = 1;
    loop.b = 2;
    loop.kind = kind;
    loop.axis = Vector3d::UnitY();
    loop.anchor_m = Vector3d(top.x(), 0, top.y());
    return Multibody(
        {rod("crank", Vector2d::Zero(), elbow), rod("coupler", elbow, top),
         rod("rocker", base, top)},
        {hinge("a", -1, 0, Vector2d::Zero()), hinge("b", 0, 1, elbow), hinge("c", -1, 2, base)},
        {loop});
  }
};

double angle(const Vector2d& direction) { return std::atan2(direction.y(), direction.x()); }

TEST(Loops, AFourBarLinkageKeepsToItsClosedForm) {
  const FourBar linkage;
  const double start = 0.7;
  for (const JointKind kind : {JointKind::revolute, JointKind::ball}) {
    const Multibody bodies = linkage.bodies(start, kind);
    EXPECT_EQ(bodies.trees().size(), 1u);
    TimeStepper stepper(bodies, {}, fall_with(1e-3));
    SimpleContacts none;
    const double energy = energy_J(bodies);
    double error = 0, departure = 0, most = 0;
    for (int i = 0; i < 10000; ++i) {
      const StepResult result = stepper.step(none);
      ASSERT_TRUE(result.done());
      ASSERT_EQ(result.smooth_trees, 1) << i;
      const double crank = start + stepper.bodies().joint_position(0);
      const double expected = angle(linkage.pin(crank) - Vector2d(linkage.ground, 0)) -
                              angle(linkage.pin(start) - Vector2d(linkage.ground, 0));
      error = std::max(error, std::abs(stepper.bodies().joint_position(2) - expected));
      departure = std::max(departure, std::abs(energy_J(stepper.bodies()) - energy));
      most = std::max(most, stepper.bodies().kinetic_energy_J());
    }
    std::printf(
        "four-bar linkage, 10000 steps of 1 ms: rocker off by %.1e rad, energy by %.1e of "
        "%.1e J kinetic\n",
        error, departure, most);
    // The positions are solved for to round-off in each step, and drift does not add up.
    EXPECT_LE(error, 1e3 * kEpsilon);
    // Second order in the step: (dt w)² of the fastest turns, about 10 rad/s.
    EXPECT_LE(departure, 1e-3 * 1e-3 * 10 * 10 * most);
    EXPECT_GT(most, 0.1);
  }
}

TEST(Loops, AFourBarLinkageAcceleratesByLagrangesEquation) {
  // One coordinate, the crank's angle: effective inertia and forces by differences of the closed
  // form. dI/dt terms vanish from rest: I(q) q'' = -dV/dq.
  const FourBar linkage;
  const double q = 0.7, h = 1e-4;
  const auto placed = [&](double crank) { return linkage.bodies(crank, JointKind::revolute); };
  const Multibody ahead = placed(q + h), behind = placed(q - h), middle = placed(q);
  double inertia = 0;
  for (int b = 0; b < 3; ++b) {
    const Vector3d slope = (ahead.center_of_mass_m(b) - behind.center_of_mass_m(b)) / (2 * h);
    const Eigen::Matrix3d spin = (ahead.pose(b).linear() - behind.pose(b).linear()) / (2 * h) *
                                 middle.pose(b).linear().transpose();
    inertia += middle.body(b).mass.mass_kg * slope.squaredNorm() +
               middle.body(b).mass.inertia_kg_m2(1, 1) * spin(0, 2) * spin(0, 2);
  }
  const Vector3d gravity(0, 0, -kFall);
  const double force =
      -(ahead.potential_energy_J(gravity) - behind.potential_energy_J(gravity)) / (2 * h);
  const double dt = 1e-5;
  TimeStepper stepper(middle, {}, fall_with(dt));
  SimpleContacts none;
  ASSERT_TRUE(stepper.step(none).done());
  // Differences h², and the step's own dt.
  EXPECT_NEAR(stepper.bodies().joint_velocity(0) / dt / (force / inertia), 1, 10 * h * h + dt);
}

TEST(Loops, JoinTreesThatDidNotFeelEachOther) {
  // Two free boxes held together: they fall, tumble and keep their momenta as one body does.
  std::vector<BodyDescription> halves;
  for (const double x : {-0.05, 0.05}) {
    halves.push_back(
        tests::box(x < 0 ? "left" : "right", Vector3d(0.1, 0.2, 0.3), 1, Vector3d(x, 0, 0)));
    const Vector3d spin(4, -5, 6);
    halves.back().angular_velocity_rad_per_s = spin;
    halves.back().velocity_m_per_s = spin.cross(Vector3d(x, 0, 0));
  }
  LoopDescription glue;
  glue.name = "glue";
  glue.a = 0;
  glue.b = 1;
  glue.kind = JointKind::fixed;
  TimeStepper stepper(Multibody(halves, {}, {glue}), {}, fall_with(1e-3));
  ASSERT_EQ(stepper.bodies().trees().size(), 1u);
  EXPECT_TRUE(stepper.bodies().are_joined(0, 1));
  BodyDescription whole = tests::box("whole", Vector3d(0.2, 0.2, 0.3), 2, Vector3d::Zero());
  whole.angular_velocity_rad_per_s = Vector3d(4, -5, 6);
  TimeStepper one(Multibody({whole}, {}), {}, fall_with(1e-3));
  SimpleContacts none;
  const int steps = 500;
  for (int i = 0; i < steps; ++i) {
    ASSERT_TRUE(stepper.step(none).done());
    ASSERT_TRUE(one.step(none).done());
  }
  const Eigen::Isometry3d left = one.bodies().pose(0) * Eigen::Translation3d(-0.05, 0, 0);
  // Both are of second order, with different errors: dt² w³ t.
  EXPECT_LE((stepper.bodies().pose(0).matrix() - left.matrix()).norm(), 1e-6 * 700 * 0.5);
  const Eigen::Isometry3d between = stepper.bodies().pose(0).inverse() * stepper.bodies().pose(1);
  EXPECT_LE((between.translation() - Vector3d(0.1, 0, 0)).norm(), 1e3 * kEpsilon);
  EXPECT_LE((between.linear() - Eigen::Matrix3d::Identity()).norm(), 1e3 * kEpsilon);
}

TEST(Loops, StayClosedUnderContactsAndMotors) {
  // A motor drives the crank against its limit while the coupler's pin would go on.
  const FourBar linkage;
  Multibody free = linkage.bodies(0.7, JointKind::revolute);
  JointDescription crank = free.joint(0);
  crank.upper = 1;
  Vector2d top = linkage.pin(0.7);
  LoopDescription loop;
  loop.name = "pin";
  loop.a = 1;
  loop.b = 2;
  loop.kind = JointKind::revolute;
  loop.axis = Vector3d::UnitY();
  loop.anchor_m = Vector3d(top.x(), 0, top.y());
  Motor motor;
  motor.joint = 0;
  motor.stiffness = 50;
  motor.damping = 1;
  motor.target = 2;
  TimeStepper stepper(Multibody({free.body(0), free.body(1), free.body(2)},
                                {crank, free.joint(1), free.joint(2)}, {loop}),
                      {motor}, fall_with(1e-3));
  SimpleContacts none;
  double open = 0, fastest = 0;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(stepper.step(none).done());
    MatrixXd jacobian;
    VectorXd opening;
    stepper.bodies().loops(stepper.bodies().trees()[0], jacobian, opening);
    open = std::max(open, opening.lpNorm<Eigen::Infinity>());
    fastest = std::max(fastest, stepper.bodies().velocity().lpNorm<Eigen::Infinity>());
  }
  std::printf("linkage on its limit: open by at most %.1e m\n", open);
  // The gap that a step leaves is of second order in its rotation, and the next step closes it.
  EXPECT_LE(open, linkage.coupler * std::pow(fastest * 1e-3, 2));
  EXPECT_NEAR(stepper.bodies().joint_position(0), 1, 1e-9);
  EXPECT_LE(stepper.bodies().velocity().norm(), 1e-9);
  EXPECT_EQ(stepper.problem().contacts(), 1) << "the crank's limit";
  EXPECT_EQ(stepper.problem().root.cols(), 0) << "the loop takes from W what three joints would do";
}

TEST(Loops, ThatLockAMechanismHoldIt) {
  // A rod hinged to the world at one end and held by a ball at the other cannot move, whatever its
  // limit says.
  JointDescription joint = hinge("a", -1, 0, Vector2d::Zero());
  joint.lower = 0;
  joint.upper = 1;
  LoopDescription loop;
  loop.name = "pin";
  loop.a = -1;
  loop.b = 0;
  loop.anchor_m = Vector3d(0.3, 0, 0);
  TimeStepper stepper(Multibody({rod("rod", Vector2d::Zero(), Vector2d(0.3, 0))}, {joint}, {loop}),
                      {}, fall_with(1e-3));
  SimpleContacts none;
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(stepper.step(none).done()) << i;
  EXPECT_NEAR(stepper.bodies().joint_position(0), 0, 1e3 * kEpsilon);
}

TEST(Loops, AreRefusedWhereTheyHoldNothing) {
  const auto refusal = [](LoopDescription loop) -> std::string {
    loop.name = "pin";
    JointDescription glue;
    glue.name = "glue";
    glue.parent = 0;
    glue.child = 1;
    try {
      Multibody({tests::box("a", Vector3d(1, 1, 1), 1, Vector3d::Zero()),
                 tests::box("b", Vector3d(1, 1, 1), 1, Vector3d(1, 0, 0)), tests::ground()},
                {glue}, {loop});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  LoopDescription loop;
  loop.a = 0;
  loop.b = 1;
  EXPECT_NE(refusal(loop).find("move against each other"), std::string::npos);
  loop.b = 0;
  EXPECT_NE(refusal(loop).find("different"), std::string::npos);
  loop.b = 7;
  EXPECT_NE(refusal(loop).find("bodies"), std::string::npos);
  loop.a = 2;
  loop.b = -1;
  EXPECT_NE(refusal(loop), "") << "neither moves";
  loop.a = 0;
  EXPECT_EQ(refusal(loop), "");
  loop.axis.setZero();
  EXPECT_NE(refusal(loop).find("axis"), std::string::npos);
}

TEST(BallJoint, SwingsInAPlaneLikeAHinge) {
  const BodyDescription body = rod("rod", Vector2d::Zero(), Vector2d(0.3, 0));
  JointDescription joint = hinge("hinge", -1, 0, Vector2d::Zero());
  TimeStepper hinged(Multibody({body}, {joint}), {}, fall_with(1e-3));
  joint.kind = JointKind::ball;
  TimeStepper ball(Multibody({body}, {joint}), {}, fall_with(1e-3));
  SimpleContacts none;
  double error = 0;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(hinged.step(none).done());
    ASSERT_TRUE(ball.step(none).done());
    error =
        std::max(error, (hinged.bodies().pose(0).matrix() - ball.bodies().pose(0).matrix()).norm());
  }
  std::printf("ball joint against hinge, 2000 steps: %.1e\n", error);
  // Both are the midpoint rule of the same equation; each step rounds.
  EXPECT_LE(error, 2000 * 100 * kEpsilon);
}

TEST(BallJoint, PendulumTurnsAboutTheVerticalAtTheConicalRate) {
  // A point on a rod at angle a from the vertical: w² = g/(l cos a). A small ball, whose own moment
  // about its centre counts as (r/l)².
  const double l = 0.3, a = 0.5, rate = std::sqrt(kFall / (l * std::cos(a)));
  JointDescription joint;
  joint.name = "ball";
  joint.child = 0;
  joint.kind = JointKind::ball;
  const Vector3d start = l * Vector3d(std::sin(a), 0, -std::cos(a));
  Multibody bodies({tests::ball("bob", 1e-3, 0.1, start)}, {joint});
  bodies.set_velocity(Vector3d(0, 0, rate));
  TimeStepper stepper(bodies, {}, fall_with(1e-3));
  SimpleContacts none;
  double error = 0;
  for (int i = 1; i <= 2000; ++i) {
    ASSERT_TRUE(stepper.step(none).done());
    const Vector3d expected = Eigen::AngleAxisd(rate * 1e-3 * i, Vector3d::UnitZ()) * start;
    error = std::max(error, (stepper.bodies().center_of_mass_m(0) - expected).norm());
  }
  std::printf("conical pendulum, 2 s: off by %.1e m\n", error);
  EXPECT_LE(error, l * rate * 2 * (std::pow(rate * 1e-3, 2) / 4 + std::pow(1e-3 / l, 2)));
}

/// Two hinges as gears have them: a pendulum lifts another one at half its angle. Mass and energy
/// are those of the closed form of one angle.
TEST(Followers, MoveAsGearsMakeThem) {
  const double ratio = -0.5, length_m = 0.3, dt = 1e-3;
  const auto pendulums = [&](double leader_rad) {
    std::vector<BodyDescription> bodies;
    std::vector<JointDescription> joints;
    for (int i = 0; i < 2; ++i) {
      const double angle = (i == 0 ? 1 : ratio) * leader_rad;
      bodies.push_back(rod(i == 0 ? "a" : "b", Vector2d(i, 0),
                           Vector2d(i + length_m * std::sin(angle), -length_m * std::cos(angle))));
      joints.push_back(hinge(i == 0 ? "ja" : "jb", -1, i, Vector2d(i, 0)));
    }
    joints[1].leader = 0;
    joints[1].ratio = ratio;
    return Multibody(bodies, joints);
  };
  const double start_rad = 0.8;
  TimeStepper stepper(pendulums(start_rad), {}, fall_with(dt));
  SimpleContacts none;
  const double start_J = energy_J(stepper.bodies());
  // A rod of m = l kg, 0.01 m thick: (m l²/3 + its thickness) a'' = -m g l/2 sin a, and ratio² and
  // ratio sin(ratio a) of the other.
  const double inertia = length_m * (length_m * length_m / 3 + 0.01 * 0.01 / 12),
               weight = kFall * length_m * length_m / 2;
  const auto acceleration = [&](double a) {
    return -weight * (std::sin(a) + ratio * std::sin(ratio * a)) / (inertia * (1 + ratio * ratio));
  };
  double angle = start_rad, speed = 0;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(stepper.step(none).done());
    const double h = dt / 10;
    for (int k = 0; k < 10; ++k) {  // the middle of each tenth of a step: of second order
      const double half = speed + h / 2 * acceleration(angle);
      angle += h * half;
      speed = half + h / 2 * acceleration(angle);
    }
    const double opening =
        stepper.bodies().joint_position(1) - ratio * stepper.bodies().joint_position(0);
    ASSERT_LT(std::abs(opening), 1e-9);
  }
  EXPECT_NEAR(stepper.bodies().joint_position(0), angle - start_rad, 1e-4);
  EXPECT_NEAR(energy_J(stepper.bodies()), start_J, 1e-5);
}

TEST(Followers, AreRefusedInRings) {
  std::vector<BodyDescription> bodies = {rod("a", {0, 0}, {0.1, 0}), rod("b", {1, 0}, {1.1, 0})};
  std::vector<JointDescription> joints = {hinge("ja", -1, 0, {0, 0}), hinge("jb", -1, 1, {1, 0})};
  joints[0].leader = 1;
  joints[1].leader = 0;
  EXPECT_THROW(Multibody(bodies, joints), InputError);
  joints[1].leader = 1;
  EXPECT_THROW(Multibody(bodies, joints), InputError);
  joints[1].leader = 7;
  EXPECT_THROW(Multibody(bodies, joints), InputError);
}

}  // namespace
}  // namespace softfinger
