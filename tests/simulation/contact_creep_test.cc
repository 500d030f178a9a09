// Soft contacts of rubber that relaxes, in motion.
#include "comparisons/simulation/contact_creep.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "comparisons/simulation/simulate.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/time/predict_in_time.h"

namespace softfinger::simulation {
namespace {

const Relaxation kRubber({{0.12, 0.05}, {0.08, 0.7}});

TEST(ContactCreep, FollowsTheComplianceUnderAConstantLoad) {
  constexpr double load_N = 3;
  double last_off = 0;
  for (const double step_s : {0.02, 0.01, 0.005}) {
    ContactCreep creep(kRubber);
    double off = 0;
    for (int step = 1; step * step_s <= 3 + 1e-9; ++step) {
      const double exact_N = load_N * kRubber.compliance(step * step_s);
      off = std::max(off, std::abs(creep.over(step_s).of(load_N) / exact_N - 1));
      creep.hold(load_N, step_s);
    }
    // The load comes within the first step, not at once: half of what relaxes in a step.
    EXPECT_LT(off, 0.5 * 0.12 * step_s / 0.05);
    // First order; the second one is a step over a time constant, 0.2 to 0.4 at most.
    if (last_off > 0) {
      EXPECT_NEAR(last_off / off, 2, 0.3) << step_s;
    }
    last_off = off;
  }
}

/// Largest difference from the sizes of a history whose contact shrinks at most once.
double off_history(const std::vector<HistoryPoint>& points, double step_s) {
  const ContactHistory history(kRubber, ContactHistory::Drive::load, points);
  ContactCreep creep(kRubber);
  double off = 0;
  for (int step = 1; step * step_s < points.back().time_s - 1e-9; ++step) {
    const double time_s = step * step_s, load_N = history.value(time_s);
    off = std::max(off, std::abs(creep.over(step_s).of(load_N) / history.at(time_s).size - 1));
    creep.hold(load_N, step_s);
  }
  return off;
}

TEST(ContactCreep, FollowsARisingAndAFallingLoadToTheSecondOrderOfTheStep) {
  // Rises as Lee and Radok say, falls as Ting says.
  const std::vector<HistoryPoint> points = {{0, 0}, {0.2, 5}, {2, 6}, {3, 0.5}};
  const double coarse = off_history(points, 0.02), fine = off_history(points, 0.01);
  std::printf("effective load: %.2g off with steps of 20 ms, %.2g of 10 ms\n", coarse, fine);
  // The square of a step of 10 ms over a rise of 200 ms, of which a tenth creeps.
  EXPECT_LT(fine, 1e-3);
  // Shells that were merged know their mean age only, which halved steps do not change.
  EXPECT_LT(fine, 0.7 * coarse);
}

TEST(ContactCreep, ForgetsAnImpact) {
  // A hundredfold load for a millisecond: what it made leaves with it.
  ContactCreep hit(kRubber), set_down(kRubber);
  constexpr double step_s = 1e-3, load_N = 1;
  hit.hold(100, step_s);
  for (int step = 0; step < 3000; ++step) {
    hit.hold(load_N, step_s);
    set_down.hold(load_N, step_s);
  }
  EXPECT_NEAR(hit.over(step_s).of(load_N) / set_down.over(step_s).of(load_N), 1, 1e-3)
      << "of a millisecond's relaxation at the time constant of 50 ms, 2 % of 0.12";
}

TEST(ContactCreep, GrowsAgainWhereItIsHeldAtLess) {
  ContactCreep creep(kRubber);
  constexpr double step_s = 5e-3;
  for (int step = 0; step < 400; ++step) creep.hold(5, step_s);
  creep.hold(2, step_s);
  const double relieved_N = creep.over(step_s).of(2);
  for (int step = 0; step < 4000; ++step) creep.hold(2, step_s);
  const double long_after_N = creep.over(step_s).of(2);
  EXPECT_GT(long_after_N, relieved_N);
  // All has relaxed.
  EXPECT_NEAR(long_after_N, 2 / kRubber.long_time_modulus(), 1e-6);
}

TEST(ContactCreep, BeginsAnewWhereItTouchesAgain) {
  ContactCreep creep(kRubber);
  for (int step = 0; step < 400; ++step) creep.hold(5, 5e-3);
  creep.hold(0, 5e-3);
  // A step's own growth is all there is: at most the relaxation of 5 ms.
  EXPECT_NEAR(creep.over(5e-3).of(0.01) / 0.01, 1, 0.12 * 5e-3 / 0.05);
}

TEST(ContactCreep, IsContinuousInTheLoadOfAStep) {
  ContactCreep creep(kRubber);
  std::mt19937 random(3011);
  std::uniform_real_distribution<double> load(0, 8);
  for (int round = 0; round < 200; ++round) {
    const EffectiveLoad effective = creep.over(0.1);
    double last_N = 0;
    for (double trial_N = 0; trial_N < 8; trial_N += 0.01) {
      const double size_N = effective.of(trial_N);
      EXPECT_GE(size_N, trial_N * (1 - 1e-12)) << "rubber that relaxes is never stiffer";
      // The ratio of both moduli is 1.25. Steeper it would be a jump.
      EXPECT_LE(size_N - last_N, 0.0125 * (1 + 1e-9)) << trial_N;
      EXPECT_GE(size_N, last_N) << trial_N;
      last_N = size_N;
    }
    EXPECT_LE(effective.size_N.size(), 200u) << "memory that grows without end";
    const double next_N = load(random);
    for (int step = round % 7; step >= 0; --step) creep.hold(next_N, 0.01);
  }
}

TEST(ContactCreep, IsElasticForRubberThatDoesNotRelax) {
  ContactCreep creep{Relaxation()};
  creep.hold(5, 0.1);
  EXPECT_EQ(creep.over(0.1).of(2), 2);
}

TEST(ContactCreep, TwoLayersHaveACommonRelaxationOnlyIfTheyRelaxAlike) {
  input::SceneBody soft, other, rigid;
  soft.layer = other.layer = ElasticLayer{2e-3, 3e5, 0.49};
  soft.relaxation = kRubber;
  EXPECT_EQ(common_relaxation(soft, rigid)->terms().size(), 2u);
  EXPECT_EQ(common_relaxation(rigid, soft)->terms().size(), 2u);
  EXPECT_FALSE(common_relaxation(soft, other));
  other.relaxation = Relaxation({{0.08, 0.7}, {0.12, 0.05}});
  EXPECT_EQ(common_relaxation(soft, other)->terms().size(), 2u);
}

/// A ball of soft skin on a table, 0.3 kg, at rest; a force pulls it sideways or turns it.
input::Scene resting_ball(const std::string& relaxation, const std::string& more) {
  return input::parse_scene(
      fmt::format("id = \"rest\"\n[simulation]\ntime_step_ms = 5\nduration_s = 3\n"
                  "[[layer]]\nname = \"skin\"\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
                  "poisson_ratio = 0.49\n{}\n"
                  "[[body]]\nname = \"table\"\nfixed = true\nshapes = [{{ half_space = true }}]\n"
                  "[[body]]\nname = \"ball\"\nposition_mm = [0, 0, 10]\nmass_g = 300\n"
                  "shapes = [{{ sphere_radius_mm = 10 }}]\nlayer = \"skin\"\n"
                  "[[joint]]\nname = \"post\"\nkind = \"prismatic\"\nparent = \"world\"\n"
                  "child = \"ball\"\naxis = [0, 0, 1]\n{}\n",
                  relaxation, more),
      "rest.toml");
}

const char* const kRelaxes =
    "relaxation = [{ share = 0.12, time_s = 0.05 }, { share = 0.08, time_s = 0.7 }]";

TEST(ContactCreep, TheEccentricityOfAHeldBallGrowsAsPredicted) {
  const Simulation held = simulate(resting_ball(kRelaxes, ""));
  ASSERT_TRUE(held.failure.empty()) << held.failure;
  for (const int step : {1, 20, 600}) {
    const Frame& frame = held.recording.frames[std::size_t(step)];
    ASSERT_EQ(frame.contacts.size(), 1u);
    const RecordedContact& contact = frame.contacts.front();
    ContactProblem problem;
    problem.radii = {0.01, 0.01, 0};
    problem.finger_curvature = {1 / 0.01, 1 / 0.01, 0};
    problem.layer = {2e-3, 3e5, 0.49};
    problem.load = {contact.normal_force_N, 0.5};
    const PredictionInTime there = predict_at(
        default_model(problem), problem,
        ContactHistory::held(kRubber, ContactHistory::Drive::load, contact.normal_force_N),
        frame.time_s);
    // The load comes within the first step, not at once: half of what relaxes in 5 ms, of which a
    // follows by the cube root.
    EXPECT_NEAR(contact.semi_axis_a_m / there.prediction.a_m, 1, 0.5 * 0.12 * 5e-3 / 0.05 / 3)
        << step;
    // The pressure that the history leaves is not quite the elastic one of this size.
    EXPECT_NEAR(contact.eccentricity_m / there.prediction.torque_arm_exact_m, 1, 5e-3) << step;
    std::printf("%.3f s: e_n %.5g mm, of the history %.5g mm\n", frame.time_s,
                1e3 * contact.eccentricity_m, 1e3 * there.prediction.torque_arm_exact_m);
  }
  const auto eccentricity_m = [&](std::size_t step) {
    return held.recording.frames[step].contacts.front().eccentricity_m;
  };
  EXPECT_GT(eccentricity_m(600), 1.03 * eccentricity_m(1));
}

TEST(ContactCreep, WhatGivesWayBeforeItSlidesCreepsByTheCompliance) {
  // The joint lets the ball turn about the normal only.
  const auto turned_rad = [](const char* relaxation) {
    input::Scene scene = input::parse_scene(
        fmt::format("id = \"turn\"\n[simulation]\ntime_step_ms = 5\nduration_s = 3\n"
                    "gravity_m_per_s2 = [0, 0, 0]\n"
                    "[[layer]]\nname = \"skin\"\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
                    "poisson_ratio = 0.49\n{}\n"
                    "[[body]]\nname = \"table\"\nfixed = true\nshapes = [{{ half_space = true }}]\n"
                    "[[body]]\nname = \"ball\"\nposition_mm = [0, 0, 10]\nmass_g = 300\n"
                    "shapes = [{{ sphere_radius_mm = 10 }}]\nlayer = \"skin\"\n"
                    "[[force]]\nbody = \"ball\"\ntime_s = [0, 0.005]\n"
                    "force_N = [[0, 0, -5], [0, 0, -5]]\ntorque_Nm = [[0, 0, 0], [0, 0, 2e-4]]\n"
                    "[[contact]]\nbodies = [\"ball\", \"table\"]\nfriction_coefficient = 1\n"
                    "presliding = true\nmodel = \"bonded_layer\"\n",
                    relaxation),
        "turn.toml");
    std::vector<double> angles;
    for (const Frame& frame : simulate(scene).recording.frames)
      angles.push_back(Eigen::AngleAxisd(frame.poses[1].linear()).angle());
    return angles;
  };
  const std::vector<double> creeps = turned_rad(kRelaxes), stays = turned_rad("");
  ASSERT_EQ(creeps.size(), 601u);
  ASSERT_EQ(stays.size(), 601u);
  EXPECT_NEAR(stays[600] / stays[100], 1, 1e-3) << "nothing creeps in rubber that does not relax";
  // The contact grows by creep, and becomes stiffer for what comes; what is held keeps its place.
  // Between the compliance and that over the growth of the stiffness, a^3 ~ P at most.
  const double grown = creeps[600] / stays[600];
  const double compliance = kRubber.compliance(3);
  std::printf("turned %.4f times as far, E0 J %.4f\n", grown, compliance);
  EXPECT_LT(grown, compliance * 1.01);
  EXPECT_GT(grown, 1 + 0.5 * (compliance - 1));
}

}  // namespace
}  // namespace softfinger::simulation
