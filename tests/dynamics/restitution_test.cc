// Newton's restitution against closed forms, and its energy with friction and many contacts.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "softfinger/dynamics/step/time_stepper.h"
#include "softfinger/input/constants.h"
#include "tests/dynamics/simple_contacts.h"

namespace softfinger {
namespace {

using Eigen::Vector3d;
using tests::SimpleContacts;

/// Gives all contacts of another finder a restitution.
class Bouncy final : public ContactFinder {
 public:
  void find(const Multibody& bodies, double time_step_s, std::vector<Contact>& contacts) override {
    simple.find(bodies, time_step_s, contacts);
    for (std::size_t i = 0; i < contacts.size(); ++i)
      contacts[i].restitution = restitution[i % restitution.size()];
  }
  SimpleContacts simple;
  std::vector<double> restitution;
};

SimpleContacts::Pair ball_on_floor(int ball, double radius_m, double friction) {
  SimpleContacts::Pair pair{SimpleContacts::Pair::Kind::ball_on_plane, 0, ball};
  pair.radius_b_m = radius_m;
  pair.friction_coefficient = friction;
  return pair;
}

SimpleContacts::Pair two_balls(int a, int b, double radius_m, double friction = 0) {
  SimpleContacts::Pair pair{SimpleContacts::Pair::Kind::ball_on_ball, a, b};
  pair.radius_a_m = pair.radius_b_m = radius_m;
  pair.friction_coefficient = friction;
  return pair;
}

double all_energy_J(const TimeStepper& stepper) {
  return stepper.bodies().kinetic_energy_J() +
         stepper.bodies().potential_energy_J(stepper.options().gravity_m_per_s2);
}

TEST(Restitution, ABallBouncesToESquaredOfItsHeight) {
  const double radius = 0.01, height = 0.5;
  for (const double e : {0.3, 0.7, 1.}) {
    TimeStepper::Options options;
    options.time_step_s = 1e-4;
    TimeStepper stepper(Multibody({tests::ground(), tests::ball("ball", radius, 0.1,
                                                                Vector3d(0, 0, radius + height))},
                                  {}),
                        {}, options);
    Bouncy contacts;
    contacts.simple.pairs = {ball_on_floor(1, radius, 0.5)};
    contacts.restitution = {e};
    double top = 0, energy = all_energy_J(stepper);
    const double fall = std::sqrt(2 * height / 9.81), speed = std::sqrt(2 * height * 9.81);
    const int until_second_hit = int((fall + 2 * e * fall) / options.time_step_s) - 10;
    for (int i = 0; i < until_second_hit; ++i) {
      ASSERT_TRUE(stepper.step(contacts).done());
      ASSERT_LE(all_energy_J(stepper), energy * (1 + 1e-12));
      energy = all_energy_J(stepper);
      if (i * options.time_step_s > 1.1 * fall)
        top = std::max(top, stepper.bodies().pose(1).translation().z() - radius);
    }
    std::printf("bouncing ball, e = %.1f: rises to %.5f m, closed form %.5f m\n", e, top,
                e * e * height);
    // It turns at most one step's fall above the floor.
    EXPECT_NEAR(top, e * e * height, speed * options.time_step_s);
  }
}

TEST(Restitution, ABallComesToRestAfterTheSumOfItsBounces) {
  // t = sqrt(2 h/g) (1 + e)/(1 - e)
  const double radius = 0.01, height = 0.2, e = 0.6;
  TimeStepper::Options options;
  options.time_step_s = 1e-4;
  TimeStepper stepper(
      Multibody(
          {tests::ground(), tests::ball("ball", radius, 0.1, Vector3d(0, 0, radius + height))}, {}),
      {}, options);
  Bouncy contacts;
  contacts.simple.pairs = {ball_on_floor(1, radius, 0.5)};
  contacts.restitution = {e};
  double moved_until = 0;
  for (int i = 0; i < 20000; ++i) {
    ASSERT_TRUE(stepper.step(contacts).done());
    if (stepper.bodies().velocity().norm() > 1e-9) moved_until = stepper.time_s();
  }
  const double expected = std::sqrt(2 * height / 9.81) * (1 + e) / (1 - e);
  std::printf("bouncing ball comes to rest at %.4f s, closed form %.4f s\n", moved_until, expected);
  // The bounces of fewer than eight steps are left out, and each other one is off by a step.
  EXPECT_NEAR(moved_until, expected, 30 * options.time_step_s);
}

TEST(Restitution, OfACradleIsNewtons) {
  // Three equal balls, the first one moves at 1 m/s.
  const double radius = 0.01;
  const auto speeds_after = [&](double gap_m) {
    std::vector<BodyDescription> bodies = {tests::ground()};
    for (int b = 0; b < 3; ++b)
      bodies.push_back(tests::ball("ball", radius, 0.1, Vector3d((2 * radius + gap_m) * b, 0, 0)));
    bodies[1].velocity_m_per_s.x() = 1;
    TimeStepper::Options options;
    options.gravity_m_per_s2.setZero();
    TimeStepper stepper(Multibody(bodies, {}), {}, options);
    Bouncy contacts;
    contacts.simple.pairs = {two_balls(1, 2, radius), two_balls(2, 3, radius)};
    contacts.restitution = {1};
    for (int i = 0; i < 50; ++i) EXPECT_TRUE(stepper.step(contacts).done());
    return Vector3d(stepper.bodies().velocity()[0], stepper.bodies().velocity()[6],
                    stepper.bodies().velocity()[12]);
  };
  // Balls farther apart than they move in a step hit one by one, as the toy's balls do.
  EXPECT_LE((speeds_after(2.5e-3) - Vector3d(0, 0, 1)).norm(), 1e-9);
  // Touching, Newton's law holds for both contacts at once.
  EXPECT_LE((speeds_after(0) - Vector3d(-1, 2, 2) / 3).norm(), 1e-9);
}

TEST(Restitution, NeverMakesEnergy) {
  // Balls with spin and friction that fall on each other, each contact with its own restitution.
  int hits = 0, reduced = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&](double least, double most) {
      return least + (most - least) * std::generate_canonical<double, 53>(random);
    };
    const double radius = 0.02;
    std::vector<BodyDescription> bodies = {tests::ground()};
    Bouncy contacts;
    for (int b = 1; b <= 6; ++b) {
      bodies.push_back(tests::ball("ball", radius, std::pow(10, uniform(-1, 1)),
                                   Vector3d(uniform(-0.02, 0.02), uniform(-0.02, 0.02), 0.06 * b)));
      bodies.back().velocity_m_per_s = Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-3, 0));
      bodies.back().angular_velocity_rad_per_s =
          50 * Vector3d(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      contacts.simple.pairs.push_back(ball_on_floor(b, radius, uniform(0, 1)));
      for (int other = 1; other < b; ++other)
        contacts.simple.pairs.push_back(two_balls(other, b, radius, uniform(0, 1)));
    }
    for (int i = 0; i < 7; ++i) contacts.restitution.push_back(uniform(0, 1));
    TimeStepper stepper(Multibody(bodies, {}), {}, {});
    const double start = all_energy_J(stepper);
    double last = start;
    for (int i = 0; i < 500; ++i) {
      const StepResult result = stepper.step(contacts);
      ASSERT_TRUE(result.done());
      reduced += result.restitution_used < 1;
      double pushed = 0;  // the work of pushing overlaps apart
      for (int c = 0; c < int(stepper.contacts().size()); ++c) {
        hits += stepper.solution().impulse[4 * c] > 0;
        if (stepper.contacts()[std::size_t(c)].gap_m < 0)
          pushed +=
              stepper.solution().impulse[4 * c] * std::max(0., stepper.contact_velocity(c)[0]);
      }
      // Smooth steps keep energy to rounding; the test of a step's energy allows 1e-9 of its work.
      ASSERT_LE(all_energy_J(stepper) - last, pushed + 1e-8 * start)
          << "seed " << seed << " step " << i;
      last = all_energy_J(stepper);
    }
  }
  std::printf("random impacts: %d loaded contacts, %d steps with less restitution\n", hits,
              reduced);
  EXPECT_GT(hits, 1000);
}

TEST(Restitution, IsReducedWhereNewtonsLawWithFrictionWouldMakeEnergy) {
  // Rods that hit with a tip beside their centre: where friction turns the slip round, Newton's law
  // alone gains energy (Kane, Levinson, Dynamics, 1985).
  std::mt19937_64 random(3);
  const auto uniform = [&](double least, double most) {
    return least + (most - least) * std::generate_canonical<double, 53>(random);
  };
  int reduced = 0, hits = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    BodyDescription rod = tests::box("rod", Vector3d(0.02, 0.02, 0.6), 1, Vector3d(0, 0, 1e-4));
    rod.mass.center_m = Vector3d(0, 0, 0.3);  // the frame is at the tip
    const double lean = uniform(-1.4, 1.4), spin = uniform(-5, 5);
    rod.pose.linear() = Eigen::AngleAxisd(lean, Vector3d::UnitY()).toRotationMatrix();
    const Vector3d turning(0, spin, 0), tip(uniform(-3, 3), 0, -1);
    rod.angular_velocity_rad_per_s = turning;
    rod.velocity_m_per_s = tip + turning.cross(rod.pose.linear() * rod.mass.center_m);
    Bouncy contacts;
    contacts.simple.pairs = {ball_on_floor(1, 1e-6, uniform(0, 2))};
    contacts.restitution = {uniform(0.3, 1)};
    TimeStepper::Options options;
    options.gravity_m_per_s2.setZero();
    TimeStepper stepper(Multibody({tests::ground(), rod}, {}), {}, options);
    const double before = all_energy_J(stepper);
    const StepResult result = stepper.step(contacts);
    ASSERT_TRUE(result.done());
    hits += stepper.solution().impulse[0] > 0;
    reduced += result.restitution_used < 1;
    ASSERT_LE(all_energy_J(stepper), before * (1 + 1e-8)) << "trial " << trial;
  }
  std::printf("rods on their tips: %d hits, %d with less restitution\n", hits, reduced);
  EXPECT_GT(hits, 900);
  EXPECT_GT(reduced, 0) << "no rod is such a case: the test is too easy";
}

}  // namespace
}  // namespace softfinger
