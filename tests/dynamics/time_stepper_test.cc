// Time stepping against closed forms and invariants: friction, rolling, stacks, energy, momentum,
// order of bodies, units, joint limits, motors, e_n of the load, steps without solution.
#include "softfinger/dynamics/step/time_stepper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "tests/dynamics/simple_contacts.h"

namespace softfinger {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using tests::SimpleContacts;
using Kind = SimpleContacts::Pair::Kind;
constexpr double kGravity = 9.81;
/// Residual of the contact solver in a step, relative to the largest velocity of the problem.
constexpr double kSolver = 1e-10;

TimeStepper::Options options(double time_step_s = 1e-3) {
  TimeStepper::Options result;
  result.time_step_s = time_step_s;
  result.gravity_m_per_s2 = Vector3d(0, 0, -kGravity);
  return result;
}

SimpleContacts::Pair corners(int a, int b, const Vector3d& size, double friction) {
  SimpleContacts::Pair pair{Kind::corners_on_plane, a, b};
  pair.size_m = size;
  pair.friction_coefficient = friction;
  return pair;
}

SimpleContacts::Pair on_plane(int a, int b, double radius, double friction,
                              double eccentricity = 0) {
  SimpleContacts::Pair pair{Kind::ball_on_plane, a, b};
  pair.radius_b_m = radius;
  pair.friction_coefficient = friction;
  pair.eccentricity_m = eccentricity;
  return pair;
}

SimpleContacts::Pair balls(int a, int b, double radius_a, double radius_b, double friction,
                           double eccentricity = 0) {
  SimpleContacts::Pair pair{Kind::ball_on_ball, a, b};
  pair.radius_a_m = radius_a;
  pair.radius_b_m = radius_b;
  pair.friction_coefficient = friction;
  pair.eccentricity_m = eccentricity;
  return pair;
}

double energy(const TimeStepper& stepper) {
  return stepper.bodies().kinetic_energy_J() +
         stepper.bodies().potential_energy_J(stepper.options().gravity_m_per_s2);
}

// --- friction in closed form ---------------------------------------------------------------------

/// A block on a plane inclined about y.
struct Incline {
  Incline(double angle_rad, double friction, FrictionRule rule = FrictionRule::ellipsoid)
      : turn(Eigen::AngleAxisd(angle_rad, Vector3d::UnitY()).toRotationMatrix()),
        stepper(make(angle_rad, rule)) {
    contacts.pairs = {corners(0, 1, size, friction)};
  }
  TimeStepper make(double, FrictionRule rule) {
    BodyDescription plane = tests::ground();
    plane.pose.linear() = turn;
    BodyDescription block = tests::box("block", size, 0.3, turn * Vector3d(0, 0, size.z() / 2));
    block.pose.linear() = turn;
    TimeStepper::Options stepping = options();
    stepping.friction_rule = rule;
    return TimeStepper(Multibody({plane, block}, {}), {}, stepping);
  }
  Vector3d moved() const {
    return turn.transpose() * stepper.bodies().pose(1).translation() - Vector3d(0, 0, size.z() / 2);
  }

  const Vector3d size{0.1, 0.06, 0.02};
  Matrix3d turn;
  TimeStepper stepper;
  SimpleContacts contacts;
};

TEST(Incline, HoldsABlockBelowTheAngleOfFriction) {
  for (const double angle : {0.0, 0.1, 0.5, 1.0}) {
    Incline incline(angle, std::tan(angle) * (1 + 1e-6) + 1e-9);
    const int steps = 1000;
    for (int i = 0; i < steps; ++i) ASSERT_TRUE(incline.stepper.step(incline.contacts).done());
    // Round-off of each step's free velocity g dt, moved through for a step.
    EXPECT_LE(incline.moved().norm(), steps * 1e3 * kEpsilon * kGravity * 1e-6) << angle;
    double normal = 0, tangent = 0;
    for (int i = 0; i < int(incline.stepper.contacts().size()); ++i) {
      const ContactWrench wrench = incline.stepper.wrench(i);
      const Contact& contact = incline.stepper.contacts()[std::size_t(i)];
      normal += wrench.normal_force_N;
      tangent += (contact.axes * Vector3d(wrench.tangent_force_1_N, wrench.tangent_force_2_N, 0))
                     .dot(incline.turn.col(0));
    }
    EXPECT_NEAR(normal, 0.3 * kGravity * std::cos(angle), kSolver);
    EXPECT_NEAR(tangent, -0.3 * kGravity * std::sin(angle), kSolver);
  }
}

TEST(Incline, LetsABlockSlideAboveTheAngleOfFriction) {
  for (const double angle : {0.1, 0.5, 1.0})
    for (const double part : {0., 0.5, 0.999}) {
      const double friction = part * std::tan(angle);
      Incline incline(angle, friction);
      const int steps = 500;
      for (int i = 0; i < steps; ++i) ASSERT_TRUE(incline.stepper.step(incline.contacts).done());
      const double dt = 1e-3, t = steps * dt;
      const double acceleration = kGravity * (std::sin(angle) - friction * std::cos(angle));
      EXPECT_NEAR(incline.moved().x(), acceleration * t * (t + dt) / 2, kSolver);
      EXPECT_NEAR(incline.moved().y(), 0, kSolver);
      EXPECT_NEAR(incline.moved().z(), 0, kSolver);
    }
}

TEST(Incline, StopsASlidingBlockWhereFrictionHasEatenItsEnergy) {
  Incline incline(0, 0.4);
  VectorXd velocity = VectorXd::Zero(6);
  velocity[0] = 1;
  incline.stepper.bodies().set_velocity(velocity);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(incline.stepper.step(incline.contacts).done());
  EXPECT_LE(incline.stepper.bodies().velocity().norm(), kSolver);
  // v²/(2 mu g), less half a step at the starting speed: the scheme is of first order.
  const double distance = 1 / (2 * 0.4 * kGravity), dt = 1e-3;
  EXPECT_NEAR(incline.moved().x(), distance - dt / 2, dt * dt * 0.4 * kGravity);
}

TEST(Rolling, ABallThatSlidesRollsAtFiveSeventhsOfItsSpeed) {
  for (const double friction : {0.05, 0.3, 1.0}) {
    const double radius = 0.03;
    BodyDescription ball = tests::ball("ball", radius, 0.2, Vector3d(0, 0, radius));
    ball.velocity_m_per_s = Vector3d(0.6, -0.8, 0);
    TimeStepper stepper(Multibody({tests::ground(), ball}, {}), {}, options());
    SimpleContacts contacts;
    contacts.pairs = {on_plane(0, 1, radius, friction)};
    // Slides for 2 v / (7 mu g).
    const int sliding = int(2 / (7 * friction * kGravity) / 1e-3);
    for (int i = 0; i < sliding - 1; ++i) ASSERT_TRUE(stepper.step(contacts).done());
    const double t = (sliding - 1) * 1e-3;
    const Vector3d along = ball.velocity_m_per_s;
    EXPECT_NEAR(stepper.bodies().velocity().head<3>().dot(along), 1 - friction * kGravity * t,
                kSolver);
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(stepper.step(contacts).done());
    const Vector3d velocity = stepper.bodies().velocity().head<3>(),
                   spin = stepper.bodies().velocity().tail<3>();
    EXPECT_LE((velocity - 5. / 7 * along).norm(), kSolver);
    EXPECT_LE((spin - Vector3d::UnitZ().cross(velocity) / radius).norm(), kSolver / radius);
    const double before = energy(stepper);
    for (int i = 0; i < 100; ++i) ASSERT_TRUE(stepper.step(contacts).done());
    EXPECT_NEAR(energy(stepper), before, kSolver) << "rolling costs nothing";
  }
}

TEST(Rolling, ABallRollsDownAnInclineAtFiveSeventhsOfGravity) {
  const double radius = 0.03, angle = 0.4, slope = kGravity * std::sin(angle);
  for (const double friction : {2. / 7 * std::tan(angle) * 1.001, 2. / 7 * std::tan(angle) * 0.9}) {
    BodyDescription plane = tests::ground();
    plane.pose.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitY()).toRotationMatrix();
    const Matrix3d turn = plane.pose.linear();
    TimeStepper stepper(
        Multibody({plane, tests::ball("ball", radius, 0.2, turn * Vector3d(0, 0, radius))}, {}), {},
        options());
    SimpleContacts contacts;
    contacts.pairs = {on_plane(0, 1, radius, friction)};
    const int steps = 300;
    for (int i = 0; i < steps; ++i) ASSERT_TRUE(stepper.step(contacts).done());
    const double t = steps * 1e-3;
    const bool rolls = friction > 2. / 7 * std::tan(angle);
    const double acceleration =
        rolls ? 5. / 7 * slope : slope - friction * kGravity * std::cos(angle);
    EXPECT_NEAR(stepper.bodies().velocity().head<3>().dot(turn.col(0)), acceleration * t, kSolver);
  }
}

TEST(Spinning, ASoftBallIsStoppedByItsTorqueAlone) {
  // mu P e_n against 2/5 m r²: alpha = 5 mu g e_n / (2 r²).
  const double radius = 0.03, friction = 0.5, arm = 0.002, spin = 20;
  BodyDescription ball = tests::ball("ball", radius, 0.2, Vector3d(0, 0, radius));
  ball.angular_velocity_rad_per_s = Vector3d(0, 0, spin);
  TimeStepper stepper(Multibody({tests::ground(), ball}, {}), {}, options());
  SimpleContacts contacts;
  contacts.pairs = {on_plane(0, 1, radius, friction, arm)};
  const double braking = 5 * friction * kGravity * arm / (2 * radius * radius);
  const int steps = 500;
  for (int i = 0; i < steps; ++i) ASSERT_TRUE(stepper.step(contacts).done());
  EXPECT_NEAR(stepper.bodies().velocity()[5], spin - braking * steps * 1e-3, kSolver * spin);
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(stepper.step(contacts).done());
  EXPECT_LE(stepper.bodies().velocity().norm(), kSolver);
}

// --- stacks
// ---------------------------------------------------------------------------------------

/// Stacks of five boxes, each a little aside, so that the loads of the corners differ.
struct Boxes {
  explicit Boxes(int stacks = 1) {
    for (int stack = 0; stack < stacks; ++stack)
      for (int i = 0; i < 5; ++i) {
        const int box = int(bodies.size());
        bodies.push_back(
            tests::box("box " + std::to_string(box), size, 0.5,
                       Vector3d(0.007 * (i % 3) + stack, 0.005 * (i % 2), size.z() * (i + 0.5))));
        SimpleContacts::Pair pair = corners(i == 0 ? 0 : box - 1, box, size, 0.5);
        pair.height_m = i == 0 ? 0 : size.z() / 2;
        contacts.pairs.push_back(pair);
      }
  }

  Vector3d size = Vector3d(0.1, 0.08, 0.05);
  std::vector<BodyDescription> bodies = {tests::ground()};
  SimpleContacts contacts;
};

TEST(Stack, OfFiveBoxesDoesNotCreep) {
  Boxes stack;
  const Vector3d size = stack.size;
  const std::vector<BodyDescription>& bodies = stack.bodies;
  SimpleContacts& contacts = stack.contacts;
  TimeStepper stepper(Multibody(bodies, {}), {}, options());
  const int steps = 10000;
  double residual = 0;
  for (int i = 0; i < steps; ++i) {
    const StepResult result = stepper.step(contacts);
    ASSERT_TRUE(result.done()) << i;
    residual = std::max(residual, result.lcp.residual);
  }
  double drift = 0, turn = 0;
  for (int b = 1; b <= 5; ++b) {
    drift = std::max(
        drift, (stepper.bodies().pose(b).translation() - bodies[std::size_t(b)].pose.translation())
                   .norm());
    turn = std::max(turn, (stepper.bodies().pose(b).linear() - Matrix3d::Identity()).norm());
  }
  std::printf("stack of 5 boxes after %d steps: moved %.1e m, turned %.1e rad, residual %.1e\n",
              steps, drift, turn, residual);
  // Free velocities of g dt have round-off of 1e3 epsilon after the solver; if every step adds its
  // own, over ten thousand steps of 1 ms:
  const double creep = 1e3 * kEpsilon * kGravity * 1e-3 * steps * 1e-3;
  EXPECT_LE(drift, creep);
  EXPECT_LE(turn, creep / size.minCoeff());
}

/// W is made row by row, G of the same bodies.
void expect_root(const ContactLcp& problem, int columns) {
  ASSERT_EQ(problem.root.cols(), columns);
  ASSERT_EQ(problem.root.rows(), problem.delassus.rows());
  const Eigen::MatrixXd product = problem.root * problem.root.transpose();
  for (int a = 0; a < product.rows(); ++a)
    for (int b = 0; b < product.cols(); ++b)
      EXPECT_NEAR(product(a, b), problem.delassus(a, b),
                  20 * kEpsilon * std::sqrt(product(a, a) * product(b, b)));  // twelve products
}

TEST(Root, IsThatOfEachIsland) {
  for (const int stacks : {1, 2}) {
    Boxes boxes(stacks);
    TimeStepper stepper(Multibody(boxes.bodies, {}), {}, options());
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(stepper.step(boxes.contacts).done());
    expect_root(stepper.problem(), 6 * 5 * stacks);
  }
}

TEST(Root, KnowsJointsTheirLimitsAndMotors) {
  // A bar that turns about its middle, pressed onto a table by a motor.
  BodyDescription bar = tests::box("bar", Vector3d(0.2, 0.02, 0.02), 0.4, Vector3d(0, 0, 0.02));
  JointDescription lift, hinge;
  lift.name = "lift";
  lift.parent = -1;
  lift.child = 1;
  lift.kind = JointKind::prismatic;
  lift.axis = Vector3d::UnitZ();
  lift.upper = 0;  // which it is at
  hinge.name = "hinge";
  hinge.parent = 1;
  hinge.child = 2;
  hinge.kind = JointKind::revolute;
  hinge.axis = Vector3d::UnitY();
  hinge.anchor_m = bar.pose.translation();
  Motor press;
  press.joint = 0;
  press.stiffness = 100;
  press.damping = 1;
  press.target = -0.01;
  TimeStepper stepper(
      Multibody({tests::ground(), tests::ball("slide", 0.005, 0.1, bar.pose.translation()), bar},
                {lift, hinge}),
      {press}, options());
  SimpleContacts contacts;
  contacts.pairs = {corners(0, 2, Vector3d(0.2, 0.02, 0.04), 0.5)};
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(stepper.step(contacts).done());
  expect_root(stepper.problem(), 2);
}

/// Presliding adds to W what the bodies do not know of, and facets need no root.
TEST(Root, IsNotThereWhereItIsNotThatOfW) {
  struct Giving final : ContactFinder {
    SimpleContacts contacts;
    void find(const Multibody& bodies, double time_step_s, std::vector<Contact>& found) override {
      contacts.find(bodies, time_step_s, found);
      found.back().compliance = Vector3d(1e-6, 1e-6, 1e-3);
    }
  };
  Boxes stack;
  Giving giving;
  giving.contacts = stack.contacts;
  TimeStepper gives(Multibody(stack.bodies, {}), {}, options());
  ASSERT_TRUE(gives.step(giving).done());
  EXPECT_EQ(gives.problem().root.cols(), 0);

  TimeStepper::Options facets = options();
  facets.friction_rule = FrictionRule::facets;
  TimeStepper other(Multibody(stack.bodies, {}), {}, facets);
  ASSERT_TRUE(other.step(stack.contacts).done());
  EXPECT_EQ(other.problem().root.cols(), 0);
}

// --- invariants over random scenes
// ----------------------------------------------------------------

/// Balls and boxes that fall on a floor and on each other.
struct RandomScene {
  RandomScene(unsigned seed, bool with_floor, bool with_boxes) : random(seed) {
    bodies.push_back(tests::ground());
    const int count = 6;
    for (int b = 1; b <= count; ++b) {
      const double size = uniform(0.01, 0.04), mass = std::pow(10, uniform(-2, 1));
      const Vector3d position(uniform(-0.06, 0.06), uniform(-0.06, 0.06), 0.07 * b);
      const bool is_box = with_boxes && b % 2 == 0;
      const Vector3d sizes(size, 1.5 * size, 0.7 * size);
      BodyDescription body = is_box ? tests::box("box", sizes, mass, position)
                                    : tests::ball("ball", size, mass, position);
      body.velocity_m_per_s = Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-3, 0));
      body.angular_velocity_rad_per_s =
          20 * Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      if (!with_floor) body.velocity_m_per_s -= 3 * position / position.norm();
      bodies.push_back(body);
      const double friction = uniform(0, 1.2), arm = uniform(0, 1) < 0.5 ? 0 : uniform(0, 5e-3);
      if (with_floor)
        pairs.push_back(is_box ? corners(0, b, sizes, friction)
                               : on_plane(0, b, size, friction, arm));
      if (is_box) continue;
      for (int other = 1; other < b; ++other)
        if (!(with_boxes && other % 2 == 0))
          pairs.push_back(balls(other, b, radius[std::size_t(other)], size, friction, arm));
      radius[std::size_t(b)] = size;
    }
    for (auto& pair : pairs) pair.reach_m = 0.02;
  }
  double uniform(double least, double most) {
    return least + (most - least) * std::generate_canonical<double, 53>(random);
  }

  std::mt19937_64 random;
  std::vector<BodyDescription> bodies;
  std::vector<SimpleContacts::Pair> pairs;
  std::array<double, 8> radius{};
};

TEST(RandomScenes, NeverGainEnergyWithoutMotors) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    RandomScene scene(seed, true, seed % 2 == 0);
    TimeStepper stepper(Multibody(scene.bodies, {}), {}, options());
    SimpleContacts contacts;
    contacts.pairs = scene.pairs;
    const double start = energy(stepper);
    double last = start;
    int touched = 0;
    for (int i = 0; i < 400; ++i) {
      ASSERT_TRUE(stepper.step(contacts).done()) << "seed " << seed << " step " << i;
      // Overlaps, which turning corners make, are pushed apart: that work is no dissipation.
      double pushed = 0;
      for (int c = 0; c < int(stepper.contacts().size()); ++c) {
        const double impulse = stepper.solution().impulse[4 * c];
        touched += impulse > 0;
        pushed += impulse * std::max(0., stepper.contact_velocity(c)[0]);
        ASSERT_LE(stepper.solution().impulse.segment<3>(4 * c + 1).dot(
                      stepper.contact_velocity(c).tail<3>()),
                  kSolver * start)
            << "friction takes energy";
      }
      const double now = energy(stepper);
      ASSERT_LE(now - last, pushed + kSolver * start) << "seed " << seed << " step " << i;
      last = now;
    }
    EXPECT_GT(touched, 100) << "seed " << seed;
    EXPECT_LT(last, 0.7 * start);
  }
}

TEST(RandomScenes, KeepMomentumThroughContacts) {
  int all_touched = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    RandomScene scene(seed, false, false);
    TimeStepper::Options weightless = options();
    weightless.gravity_m_per_s2.setZero();
    TimeStepper stepper(Multibody(scene.bodies, {}), {}, weightless);
    SimpleContacts contacts;
    contacts.pairs = scene.pairs;
    const Vector3d linear = stepper.bodies().linear_momentum_N_s(),
                   angular = stepper.bodies().angular_momentum_N_m_s();
    double size = 0;
    for (const BodyDescription& body : scene.bodies)
      size += body.fixed ? 0 : body.mass.mass_kg * body.velocity_m_per_s.norm();
    int touched = 0;
    const int steps = 300;
    for (int i = 0; i < steps; ++i) {
      ASSERT_TRUE(stepper.step(contacts).done());
      touched += stepper.solution().impulse.size() > 0 &&
                 stepper.solution().impulse.cwiseAbs().maxCoeff() > 0;
    }
    all_touched += touched;
    const double round_off = steps * 16 * kEpsilon * size;
    EXPECT_LE((stepper.bodies().linear_momentum_N_s() - linear).norm(), round_off);
    EXPECT_LE((stepper.bodies().angular_momentum_N_m_s() - angular).norm(), round_off);
  }
  EXPECT_GT(all_touched, 20);
}

TEST(RandomScenes, DoNotDependOnTheOrderOfTheBodies) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const RandomScene scene(seed, true, seed % 2 == 0);
    std::vector<int> order(scene.bodies.size());
    std::iota(order.begin(), order.end(), 0);
    std::mt19937 shuffle(seed);
    std::shuffle(order.begin(), order.end(), shuffle);
    std::vector<BodyDescription> bodies(scene.bodies.size());
    for (std::size_t b = 0; b < order.size(); ++b) bodies[std::size_t(order[b])] = scene.bodies[b];
    SimpleContacts contacts, shuffled;
    contacts.pairs = shuffled.pairs = scene.pairs;
    for (SimpleContacts::Pair& pair : shuffled.pairs) {
      pair.a = order[std::size_t(pair.a)];
      pair.b = order[std::size_t(pair.b)];
    }
    std::shuffle(shuffled.pairs.begin(), shuffled.pairs.end(), shuffle);
    TimeStepper one(Multibody(scene.bodies, {}), {}, options());
    TimeStepper other(Multibody(bodies, {}), {}, options());
    double size = 0;
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(one.step(contacts).done());
      ASSERT_TRUE(other.step(shuffled).done());
      size = std::max(size, one.bodies().velocity().cwiseAbs().maxCoeff());
    }
    for (std::size_t b = 1; b < order.size(); ++b) {
      // The solver's residual, magnified by mass ratios of 1e3.
      EXPECT_LE(
          (one.bodies().pose(int(b)).matrix() - other.bodies().pose(order[b]).matrix()).norm(),
          1e3 * kSolver * size)
          << "seed " << seed << " body " << b;
      EXPECT_LE((one.bodies().angular_velocity(int(b)) - other.bodies().angular_velocity(order[b]))
                    .norm(),
                1e3 * kSolver * size)
          << "seed " << seed << " body " << b;
    }
  }
}

TEST(RandomScenes, DoNotDependOnUnits) {
  for (unsigned seed = 1; seed <= 4; ++seed)
    for (const double length : {1e-3, 1e3})
      for (const double mass : {1e-3, 1e3})
        for (const double time : {1e-3, 1e3}) {
          const RandomScene scene(seed, true, seed % 2 == 0);
          SimpleContacts contacts, scaled_contacts;
          contacts.pairs = scaled_contacts.pairs = scene.pairs;
          for (SimpleContacts::Pair& pair : scaled_contacts.pairs) {
            for (double* value :
                 {&pair.radius_a_m, &pair.radius_b_m, &pair.eccentricity_m, &pair.reach_m})
              *value *= length;
            pair.size_m *= length;
          }
          std::vector<BodyDescription> bodies = scene.bodies;
          for (BodyDescription& body : bodies) {
            body.pose.translation() *= length;
            body.mass.mass_kg *= mass;
            body.mass.inertia_kg_m2 *= mass * length * length;
            body.velocity_m_per_s *= length / time;
            body.angular_velocity_rad_per_s /= time;
          }
          TimeStepper::Options scaled_options = options(1e-3 * time);
          scaled_options.gravity_m_per_s2 *= length / (time * time);
          scaled_options.correction_m_per_s *= length / time;
          TimeStepper one(Multibody(scene.bodies, {}), {}, options());
          TimeStepper other(Multibody(bodies, {}), {}, scaled_options);
          for (int i = 0; i < 60; ++i) {
            ASSERT_TRUE(one.step(contacts).done());
            ASSERT_TRUE(other.step(scaled_contacts).done())
                << "seed " << seed << " scales " << length << " " << mass << " " << time;
          }
          for (int b = 1; b < one.bodies().bodies(); ++b) {
            const double round_off = 1e3 * kSolver;
            EXPECT_LE(
                (one.bodies().pose(b).translation() - other.bodies().pose(b).translation() / length)
                    .norm(),
                round_off);
            EXPECT_LE((one.bodies().pose(b).linear() - other.bodies().pose(b).linear()).norm(),
                      100 * round_off)
                << "seed " << seed << " scales " << length << " " << mass << " " << time;
          }
        }
}

// --- joints and motors
// ----------------------------------------------------------------------------

/// A carriage of 2 kg on a rail along x.
struct Carriage {
  explicit Carriage(Motor motor, double lower = -kInfinity, double upper = kInfinity,
                    double gravity_along = 0)
      : stepper(make(motor, lower, upper, gravity_along)) {}
  static TimeStepper make(Motor motor, double lower, double upper, double gravity_along) {
    JointDescription rail;
    rail.name = "rail";
    rail.child = 0;
    rail.kind = JointKind::prismatic;
    rail.axis = Vector3d::UnitX();
    rail.lower = lower;
    rail.upper = upper;
    TimeStepper::Options stepping = options();
    stepping.gravity_m_per_s2 = Vector3d(gravity_along, 0, 0);
    std::vector<Motor> motors;
    if (motor.joint >= 0) motors.push_back(motor);
    return TimeStepper(
        Multibody({tests::box("carriage", {0.1, 0.1, 0.1}, 2, Vector3d::Zero())}, {rail}), motors,
        stepping);
  }
  double position() const { return stepper.bodies().joint_position(0); }
  double speed() const { return stepper.bodies().velocity()[0]; }
  StepResult step() { return stepper.step(nothing); }

  SimpleContacts nothing;
  TimeStepper stepper;
};

Motor motor(double stiffness, double damping, double target) {
  Motor result;
  result.joint = 0;
  result.stiffness = stiffness;
  result.damping = damping;
  result.target = target;
  return result;
}

TEST(JointLimits, StopAFallingCarriageExactly) {
  Carriage carriage({}, -0.1, 0.25, kGravity);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_TRUE(carriage.step().done());
    ASSERT_LE(carriage.position(), 0.25 + 4 * kEpsilon);
  }
  EXPECT_NEAR(carriage.position(), 0.25, 4 * kEpsilon);
  EXPECT_LE(std::abs(carriage.speed()), 1e3 * kEpsilon);
}

TEST(JointLimits, HoldAgainstAnyMotor) {
  for (const double stiffness : {1e2, 1e6, 1e12})
    for (const double damping : {0., 10., 1e6}) {
      Carriage carriage(motor(stiffness, damping, 5), -0.1, 0.25);
      for (int i = 0; i < 3000; ++i) {
        ASSERT_TRUE(carriage.step().done());
        ASSERT_LE(carriage.position(), 0.25 * (1 + 1e3 * kEpsilon))
            << "stiffness " << stiffness << " damping " << damping << " step " << i;
        if (i == 1500) carriage.stepper.motors()[0].target = -5;
        ASSERT_GE(carriage.position(), -0.1 * (1 + 1e3 * kEpsilon)) << stiffness << " step " << i;
      }
    }
}

TEST(JointLimits, HoldAJointWithoutRoomToMove) {
  Carriage carriage({}, 0, 0, kGravity);
  for (int i = 0; i < 1000; ++i) ASSERT_TRUE(carriage.step().done());
  EXPECT_LE(std::abs(carriage.position()), kEpsilon);
}

TEST(JointLimits, OfAPendulumAreHitWithoutBounce) {
  JointDescription hinge;
  hinge.name = "hinge";
  hinge.child = 0;
  hinge.kind = JointKind::revolute;
  hinge.axis = Vector3d::UnitY();
  hinge.lower = -0.5;
  hinge.upper = 0.3;
  BodyDescription rod = tests::box("rod", {0.02, 0.02, 0.3}, 1, Vector3d(0, 0, -0.15));
  TimeStepper stepper(Multibody({rod}, {hinge}), {}, options());
  stepper.bodies().set_velocity(VectorXd::Constant(1, 30));
  SimpleContacts nothing;
  bool hit = false;
  for (int i = 0; i < 2000; ++i) {
    ASSERT_TRUE(stepper.step(nothing).done());
    ASSERT_LE(stepper.bodies().joint_position(0), 0.3 + 1e2 * kEpsilon);
    ASSERT_GE(stepper.bodies().joint_position(0), -0.5 - 1e2 * kEpsilon);
    hit = hit || stepper.bodies().joint_position(0) > 0.3 - 1e2 * kEpsilon;
  }
  EXPECT_TRUE(hit);
}

TEST(Motors, ReachTheirTarget) {
  // Critically damped: 2 sqrt(k m), 40 time constants.
  const double stiffness = 800, mass = 2;
  Carriage carriage(motor(stiffness, 2 * std::sqrt(stiffness * mass), 0.3));
  for (int i = 0; i < 2000; ++i) ASSERT_TRUE(carriage.step().done());
  EXPECT_NEAR(carriage.position(), 0.3, 1e-12);
  EXPECT_NEAR(carriage.stepper.motor_effort(0), 0, 1e-9);
}

TEST(Motors, HoldALoadAtTheStaticDeflection) {
  const double stiffness = 800, mass = 2;
  Motor holding = motor(stiffness, 2 * std::sqrt(stiffness * mass), 0.3);
  Carriage carriage(holding, -10, 10, kGravity);
  for (int i = 0; i < 3000; ++i) ASSERT_TRUE(carriage.step().done());
  EXPECT_NEAR(carriage.position(), 0.3 + mass * kGravity / stiffness, 1e-12);
  EXPECT_NEAR(carriage.stepper.motor_effort(0), -mass * kGravity, 1e-9);
  // With the load known beforehand there is no deflection.
  carriage.stepper.motors()[0].feed_forward = -mass * kGravity;
  for (int i = 0; i < 3000; ++i) ASSERT_TRUE(carriage.step().done());
  EXPECT_NEAR(carriage.position(), 0.3, 1e-12);
}

TEST(Motors, OfAnyStiffnessAreStable) {
  for (const double stiffness : {1e4, 1e8, 1e12, 1e15})
    for (const double damping : {0., 1e3, 1e9}) {
      Carriage carriage(motor(stiffness, damping, 0.3), -10, 10, kGravity);
      double last = carriage.position() - 0.3;
      for (int i = 0; i < 2000; ++i) {
        ASSERT_TRUE(carriage.step().done());
        ASSERT_LE(std::abs(carriage.position() - 0.3), std::abs(last) * (1 + 1e-9) + 0.3)
            << stiffness << " " << damping;
      }
      if (damping == 0 && stiffness >= 1e8) {
        EXPECT_NEAR(carriage.position(), 0.3, 2 * kGravity / stiffness + 1e-12) << stiffness;
      }
    }
}

TEST(Motors, RegulateSpeed) {
  Motor driving = motor(0, 1e4, 0);
  driving.target_velocity = 0.7;
  Carriage carriage(driving);
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(carriage.step().done());
  EXPECT_NEAR(carriage.speed(), 0.7, 1e-12);
}

TEST(Motors, AccelerateWithTheirLimitExactly) {
  Motor weak = motor(1e6, 1e3, 10);
  weak.max_effort = 3;
  Carriage carriage(weak);
  const int steps = 200;
  for (int i = 0; i < steps; ++i) {
    const StepResult result = carriage.step();
    ASSERT_TRUE(result.done() && result.motors_agree);
    ASSERT_EQ(carriage.stepper.motor_effort(0), 3);
  }
  EXPECT_NEAR(carriage.speed(), 3. / 2 * steps * 1e-3, steps * kEpsilon);
}

TEST(Motors, OfNoEffortDoNothing) {
  Motor dead = motor(1e6, 1e3, 10);
  dead.max_effort = 0;
  Carriage carriage(dead);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(carriage.step().done());
  EXPECT_EQ(carriage.position(), 0);
}

TEST(Motors, PressAWallWithTheirLimit) {
  // A ball on a rail against a fixed plane, by a position motor that wants to go through.
  BodyDescription wall = tests::ground("wall");
  wall.pose.linear() = Eigen::AngleAxisd(-kPi / 2, Vector3d::UnitY()).toRotationMatrix();
  wall.pose.translation().x() = 0.1;  // its normal is -x
  ASSERT_LT(wall.pose.linear().col(2).x(), -0.99);
  JointDescription rail;
  rail.name = "rail";
  rail.child = 1;
  rail.kind = JointKind::prismatic;
  rail.axis = Vector3d::UnitX();
  for (const double stiffness : {1e3, 1e9}) {
    Motor pressing = motor(stiffness, 10, 1);
    pressing.max_effort = 7;
    TimeStepper stepper(Multibody({wall, tests::ball("ball", 0.02, 0.5, Vector3d::Zero())}, {rail}),
                        {pressing}, options());
    SimpleContacts contacts;
    contacts.pairs = {on_plane(0, 1, 0.02, 0.5)};
    for (int i = 0; i < 1000; ++i) {
      const StepResult result = stepper.step(contacts);
      ASSERT_TRUE(result.done() && result.motors_agree) << i;
      ASSERT_LE(std::abs(stepper.motor_effort(0)), 7);
    }
    EXPECT_NEAR(stepper.bodies().joint_position(0), 0.08, 1e-12);
    EXPECT_NEAR(stepper.wrench(0).normal_force_N, 7, 7 * kSolver);
    EXPECT_EQ(stepper.motor_effort(0), 7);
    // Called back to where the spring is weaker than its limit.
    stepper.motors()[0].target = 0.08 + 2 / stiffness;
    for (int i = 0; i < 10; ++i) ASSERT_TRUE(stepper.step(contacts).done());
    EXPECT_NEAR(stepper.wrench(0).normal_force_N, 2, 2e-6) << "1e9 N/m times round-off of 0.08 m";
  }
}

TEST(Motors, ManyAtTheirLimitsAgree) {
  // A chain of ten links, each motor with another limit, flung about.
  std::vector<BodyDescription> links;
  std::vector<JointDescription> hinges;
  std::vector<Motor> motors;
  std::mt19937 random(3);
  for (int b = 0; b < 10; ++b) {
    links.push_back(tests::box("link", {0.02, 0.02, 0.1}, 0.1, Vector3d(0, 0, -0.05 - 0.1 * b)));
    JointDescription hinge;
    hinge.name = "hinge";
    hinge.parent = b - 1;
    hinge.child = b;
    hinge.kind = JointKind::revolute;
    hinge.axis = b % 2 ? Vector3d::UnitX() : Vector3d::UnitY();
    hinge.anchor_m = Vector3d(0, 0, -0.1 * b);
    hinges.push_back(hinge);
    Motor drive = motor(std::pow(10, b % 5), 0.05, 0);
    drive.joint = b;
    drive.max_effort = 0.05 * (b % 3);
    motors.push_back(drive);
  }
  TimeStepper stepper(Multibody(links, hinges), motors, options());
  SimpleContacts nothing;
  for (int i = 0; i < 500; ++i) {
    if (i % 50 == 0)
      for (Motor& drive : stepper.motors()) drive.target = 2e-9 * random() - 4;
    const StepResult result = stepper.step(nothing);
    ASSERT_TRUE(result.done());
    ASSERT_TRUE(result.motors_agree) << i;
    for (int m = 0; m < 10; ++m) {
      const Motor& drive = stepper.motors()[std::size_t(m)];
      ASSERT_LE(std::abs(stepper.motor_effort(m)), drive.max_effort * (1 + 1e-9));
      // The law at the end of the step, clipped.
      const double law =
          drive.stiffness * (drive.target - stepper.bodies().joint_position(m)) -
          drive.damping * stepper.bodies().velocity()[stepper.bodies().velocity_of_joint(m)];
      ASSERT_NEAR(stepper.motor_effort(m), std::clamp(law, -drive.max_effort, drive.max_effort),
                  1e-8 * (1 + drive.stiffness))
          << i << " motor " << m;
    }
  }
}

// --- e_n of the load
// ------------------------------------------------------------------------------

struct PowerLaw final : EccentricityLaw {
  double eccentricity_m(double load_N) const noexcept override {
    return 2e-3 * std::pow(load_N, 1. / 3);
  }
};

TEST(Eccentricity, AgreesWithTheLoadAtTheEndOfTheStep) {
  // A spinning ball that falls, is pressed ever harder, and never stops: the torque is mu P e_n(P).
  const PowerLaw law;
  const double radius = 0.02, friction = 0.6;
  BodyDescription ball = tests::ball("ball", radius, 0.1, Vector3d(0, 0, radius + 1e-3));
  ball.angular_velocity_rad_per_s = Vector3d(0, 0, 3000);
  TimeStepper stepper(Multibody({tests::ground(), ball}, {}), {}, options());
  stepper.applied_forces().push_back({1});
  SimpleContacts contacts;
  contacts.pairs = {on_plane(0, 1, radius, friction)};
  contacts.pairs[0].law = &law;
  int touched = 0;
  for (int i = 0; i < 200; ++i) {
    stepper.applied_forces()[0].force_N.z() = -0.05 * i;
    const StepResult result = stepper.step(contacts);
    ASSERT_TRUE(result.done());
    ASSERT_LE(result.load_disagreement, 1e-9);
    const ContactWrench wrench = stepper.wrench(0);
    if (!(wrench.normal_force_N > 0)) continue;
    ++touched;
    EXPECT_GE(result.load_iterations, 1);
    const double arm = law.eccentricity_m(wrench.normal_force_N);
    ASSERT_NEAR(stepper.eccentricity_m(0) / arm, 1, 1e-9);
    ASSERT_NEAR(wrench.torque_Nm / (-friction * wrench.normal_force_N * arm), 1, 2e-9);
  }
  EXPECT_GT(touched, 150);
  ASSERT_GT(stepper.bodies().velocity()[5], 0);
}

TEST(Eccentricity, StaysThatOfTheLastLoadWhileThereIsNone) {
  const PowerLaw law;
  const double radius = 0.02;
  TimeStepper stepper(
      Multibody({tests::ground(), tests::ball("ball", radius, 0.1, Vector3d(0, 0, radius))}, {}),
      {}, options());
  stepper.applied_forces().push_back({1});
  SimpleContacts contacts;
  contacts.pairs = {on_plane(0, 1, radius, 0.6)};
  contacts.pairs[0].law = &law;
  double loaded_m = 0;
  int unloaded = 0;
  for (int i = 0; i < 60; ++i) {
    stepper.applied_forces()[0].force_N.z() = i < 30 ? 0.1 * i - 10 : 1;
    ASSERT_TRUE(stepper.step(contacts).done());
    ASSERT_EQ(stepper.contacts().size(), 1u);
    if (stepper.wrench(0).normal_force_N > 0) {
      EXPECT_EQ(unloaded, 0);
      loaded_m = stepper.eccentricity_m(0);
    } else {
      ++unloaded;
      EXPECT_EQ(stepper.eccentricity_m(0), loaded_m) << i;
    }
  }
  EXPECT_GE(unloaded, 20);
  EXPECT_NEAR(loaded_m, law.eccentricity_m(0.981 + 10 - 2.9), 1e-6);
}

/// 10 kPa on a circle a = 2 mm (P/N)^(1/3).
struct ConstantShearStress final : EccentricityLaw {
  static double radius_m(double load_N) { return 2e-3 * std::cbrt(load_N); }
  double eccentricity_m(double load_N) const noexcept override { return 2 * radius_m(load_N) / 3; }
  std::optional<double> friction_coefficient(double load_N) const noexcept override {
    const double a = radius_m(load_N);
    return effective_friction({M_PI * a * a * 1e4, 0}, load_N);
  }
};

TEST(Eccentricity, OfConstantShearStressTurnsWithTwoThirdsPiTauACubed) {
  // Pressed ever harder, the torque is proportional to a³, here to the load. The law replaces the
  // contact's own coefficient of friction.
  const ConstantShearStress law;
  const double radius = 0.02;
  BodyDescription ball = tests::ball("ball", radius, 0.1, Vector3d(0, 0, radius + 1e-3));
  ball.angular_velocity_rad_per_s = Vector3d(0, 0, 3000);
  TimeStepper stepper(Multibody({tests::ground(), ball}, {}), {}, options());
  stepper.applied_forces().push_back({1});
  SimpleContacts contacts;
  contacts.pairs = {on_plane(0, 1, radius, 0.3)};
  contacts.pairs[0].law = &law;
  int touched = 0;
  for (int i = 0; i < 200; ++i) {
    stepper.applied_forces()[0].force_N.z() = -0.05 * i;
    const StepResult result = stepper.step(contacts);
    ASSERT_TRUE(result.done());
    ASSERT_LE(result.load_disagreement, 1e-9);
    const ContactWrench wrench = stepper.wrench(0);
    if (!(wrench.normal_force_N > 0)) continue;
    ++touched;
    const double a = law.radius_m(wrench.normal_force_N);
    ASSERT_NEAR(wrench.torque_Nm / (-2 * M_PI / 3 * 1e4 * a * a * a), 1, 1e-8) << i;
    ASSERT_NEAR(stepper.friction_coefficient(0) / *law.friction_coefficient(wrench.normal_force_N),
                1, 1e-9);
  }
  EXPECT_GT(touched, 150);
  ASSERT_GT(stepper.bodies().velocity()[5], 0) << "it never stops";
}

TEST(Eccentricity, AgreesWhereTheLoadDependsOnIt) {
  // A lever about z presses a soft ball against a wall; its spin about the normal is braked.
  const PowerLaw law;
  std::vector<BodyDescription> bodies = {tests::ground()};
  SimpleContacts contacts;
  for (int b = 1; b <= 4; ++b) {
    bodies.push_back(tests::ball("ball", 0.02, 0.05 * b, Vector3d(0.001 * b, 0, 0.04 * b - 0.02)));
    bodies.back().angular_velocity_rad_per_s = Vector3d(5, 0, b % 2 ? 300 : -300);
    contacts.pairs.push_back(b == 1 ? on_plane(0, 1, 0.02, 0.7) : balls(b - 1, b, 0.02, 0.02, 0.7));
    contacts.pairs.back().law = &law;
  }
  TimeStepper stepper(Multibody(bodies, {}), {}, options());
  for (int i = 0; i < 100; ++i) {
    const StepResult result = stepper.step(contacts);
    ASSERT_TRUE(result.done());
    ASSERT_LE(result.load_disagreement, 1e-9) << i;
    for (int c = 0; c < int(stepper.contacts().size()); ++c) {
      const ContactWrench wrench = stepper.wrench(c);
      if (!(wrench.normal_force_N > 1e-6)) continue;
      ASSERT_NEAR(stepper.eccentricity_m(c) / law.eccentricity_m(wrench.normal_force_N), 1, 1e-9);
      const double f = std::hypot(wrench.tangent_force_1_N, wrench.tangent_force_2_N,
                                  wrench.torque_Nm / law.eccentricity_m(wrench.normal_force_N));
      ASSERT_LE(f, 0.7 * wrench.normal_force_N * (1 + 1e-8));
    }
  }
}

// --- bad input and steps without solution
// ---------------------------------------------------------

TEST(TimeStepper, RefusesBadInput) {
  const Multibody bodies({tests::ball("ball", 0.1, 1, Vector3d::Zero())}, {});
  for (const double dt : {0., -1e-3, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(TimeStepper(bodies, {}, options(dt)), InputError);
  EXPECT_THROW(TimeStepper(bodies, {motor(1, 1, 1)}, options()), InputError) << "no joint";
  EXPECT_THROW(TimeStepper(bodies, {Motor{}}, options()), InputError);
}

TEST(TimeStepper, LeavesTheStateOfAStepWithoutSolutionAlone) {
  // A ball wedged between a floor and a fixed ball above, both of which it overlaps.
  const double radius = 0.02;
  std::vector<BodyDescription> bodies = {tests::ground(), tests::ground("ceiling"),
                                         tests::ball("ball", radius, 1, Vector3d(0, 0, 0.019)),
                                         tests::ball("other", radius, 1, Vector3d(0.3, 0, 0.5))};
  bodies[1].pose.translation().z() = 0.058;
  bodies[3].velocity_m_per_s.x() = 1;
  TimeStepper stepper(Multibody(bodies, {}), {}, options());
  SimpleContacts contacts;
  contacts.pairs = {on_plane(0, 2, radius, 0.5), balls(1, 2, radius, radius, 0.5)};
  const Multibody before = stepper.bodies();
  for (int i = 0; i < 3; ++i) {
    const StepResult result = stepper.step(contacts);
    EXPECT_FALSE(result.done());
    EXPECT_EQ(result.lcp.status, LcpStatus::infeasible_or_ray);
    EXPECT_EQ(result.lcp.proof, RayProof::infeasible);
    EXPECT_EQ(result.contacts, 2);
    EXPECT_EQ(result.time_s, 0);
    EXPECT_EQ(stepper.steps(), 0);
    EXPECT_EQ((stepper.bodies().velocity() - before.velocity()).norm(), 0);
    for (int b = 0; b < 4; ++b)
      EXPECT_EQ((stepper.bodies().pose(b).matrix() - before.pose(b).matrix()).norm(), 0);
    EXPECT_GT(stepper.solution().ray[0], 0) << "the floor takes part";
    EXPECT_GT(stepper.solution().ray[4], 0) << "so does the ball above";
  }
  // Without the obstacle, it goes on.
  contacts.pairs.pop_back();
  EXPECT_TRUE(stepper.step(contacts).done());
  EXPECT_EQ(stepper.steps(), 1);
}

TEST(TimeStepper, HoldsABallThatJustFitsBetweenWalls) {
  const double radius = 0.02;
  std::vector<BodyDescription> bodies = {
      tests::ground(), tests::ground("right"),
      tests::ball("ball", radius, 0.1, Vector3d(0.3, 0.1, 0.02))};
  bodies[0].pose.linear() = Eigen::AngleAxisd(kPi / 2, Vector3d::UnitY()).toRotationMatrix();
  bodies[0].pose.translation().x() = 0.3 - radius;
  bodies[1].pose.linear() = Eigen::AngleAxisd(-kPi / 2, Vector3d::UnitY()).toRotationMatrix();
  bodies[1].pose.translation().x() = 0.3 + radius;
  TimeStepper stepper(Multibody(bodies, {}), {}, options());
  SimpleContacts contacts;
  contacts.pairs = {on_plane(0, 2, radius, 0.5), on_plane(1, 2, radius, 0.5)};
  for (int i = 0; i < 500; ++i) ASSERT_TRUE(stepper.step(contacts).done()) << i;
  EXPECT_NEAR(stepper.bodies().pose(2).translation().x(), 0.3, 1e3 * kEpsilon);
}

// --- islands from step to step -------------------------------------------------------------------

/// Contacts that come in another order in each second step, without their ids in each third.
class Unsteady final : public ContactFinder {
 public:
  explicit Unsteady(const SimpleContacts& contacts) : contacts_(contacts) {}

  void find(const Multibody& bodies, double time_step_s, std::vector<Contact>& contacts) override {
    contacts_.find(bodies, time_step_s, contacts);
    ++step_;
    if (step_ % 2 == 0) std::reverse(contacts.begin(), contacts.end());
    if (step_ % 3 == 0)
      for (Contact& contact : contacts) contact.id = Contact::kNoId;
  }

 private:
  SimpleContacts contacts_;
  int step_ = 0;
};

TEST(Islands, MoveTheSameWhetherTheirContactsStayInOrderOrNot) {
  const Vector3d size(0.1, 0.06, 0.02);
  std::vector<BodyDescription> descriptions = {tests::ground()};
  SimpleContacts steady;
  for (int b = 1; b <= 3; ++b) {
    descriptions.push_back(
        tests::box("box " + std::to_string(b), size, 0.3, Vector3d(0, 0.1 * b, 0.01)));
    descriptions.back().velocity_m_per_s.x() = 0.5 * b;
    steady.pairs.push_back(corners(0, b, size, 0.4));
  }
  descriptions.push_back(tests::ball("ball", 0.01, 0.05, Vector3d(-0.1, 0, 0.01)));
  descriptions.back().velocity_m_per_s.x() = 1;
  descriptions.back().angular_velocity_rad_per_s.z() = 30;
  const PowerEccentricity law(0.002, 1.0 / 3);
  steady.pairs.push_back(on_plane(0, 4, 0.01, 0.4));
  steady.pairs.back().law = &law;
  Unsteady unsteady(steady);
  TimeStepper one(Multibody(descriptions, {}), {}, options());
  TimeStepper other(Multibody(descriptions, {}), {}, options());
  const int steps = 200;
  for (int step = 0; step < steps; ++step) {
    ASSERT_TRUE(one.step(steady).done()) << step;
    ASSERT_TRUE(other.step(unsteady).done()) << step;
  }
  EXPECT_GT(one.bodies().pose(3).translation().x(), 0.1);
  // The residual of each step's velocities, up to 1.5 m/s, moved through for all that follow.
  const double moved_m = steps * steps * 1e-3 * kSolver * 1.5;
  for (int b = 1; b <= 4; ++b) {
    const Eigen::Isometry3d &pose = one.bodies().pose(b), &same = other.bodies().pose(b);
    EXPECT_LE((pose.translation() - same.translation()).norm(), moved_m) << b;
    EXPECT_LE((pose.linear() - same.linear()).norm(), moved_m / 0.01) << b;  // the least size
  }
}

}  // namespace
}  // namespace softfinger
