// Flat faces in grips: soft ones have one limit of friction per pair, with the arm of a pad, and
// rigid ones share their force among their corners.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "comparisons/simulation/simulate.h"
#include "softfinger/pads/pad_model.h"

namespace softfinger::simulation {
namespace {

constexpr double kPadGrip_N = 10, kPadFriction = 0.7, kMass_kg = 0.5, kGravity = 9.81;
constexpr double kPad_m[2] = {0.022, 0.0375}, kThickness_m = 3e-3, kPoissonRatio = 0.49;

/// A gripper with pads of 22 x 37.5 mm holds a box of 500 g beside its centre of mass, from the
/// first step on.
std::string gripper(double offset_m, double duration_s,
                    const std::string& pad = "box_size_mm = [22, 20, 37.5]",
                    const char* layer = "layer = \"rubber\"") {
  const auto tip = [&](const char* side, double y_mm, int axis) {
    return fmt::format(
        "[[body]]\nname = \"{0}_pad\"\nmass_g = 20\nposition_mm = [0, {1}, 0]\n{5}\n"
        "shapes = [{{ {3} }}]\n"
        "[[joint]]\nname = \"{0}_slide\"\nkind = \"prismatic\"\nparent = \"world\"\n"
        "child = \"{0}_pad\"\naxis = [0, {2}, 0]\n"
        "[[motor]]\njoint = \"{0}_slide\"\ntime_s = [0]\neffort_N = [{4}]\n",
        side, y_mm, axis, pad, kPadGrip_N, layer);
  };
  return fmt::format(
             "id = \"gripper\"\n[simulation]\ntime_step_ms = 1\nduration_s = {}\n"
             "[[layer]]\nname = \"rubber\"\nthickness_mm = 3\nyoungs_modulus_kPa = 800\n"
             "poisson_ratio = 0.49\n"
             "[[body]]\nname = \"object\"\nmass_g = 500\ncenter_of_mass_mm = [{:.17g}, 0, 0]\n"
             "inertia_kg_mm2 = [500, 1500, 1500]\nshapes = [{{ box_size_mm = [200, 40, 80] }}]\n",
             duration_s, 1e3 * offset_m) +
         tip("left", -30, 1) + tip("right", 30, -1) +
         "[[contact]]\nbodies = [\"*\", \"object\"]\nfriction_coefficient = 0.7\n";
}

Simulation simulated_gripper(const std::string& text) {
  return simulate(input::parse_scene(text, "gripper.toml"));
}

double turned_by_rad(const Simulation& run) {
  return Eigen::AngleAxisd(run.recording.frames.back().poses[0].linear()).angle();
}

PadPrediction asked_pad() {
  const PadShape shape(ConvexOutline::rounded_rectangle(kPad_m[0], kPad_m[1]));
  PadProblem problem;
  problem.shape = &shape;
  problem.layer = {kThickness_m, 8e5, kPoissonRatio};
  problem.load = {kPadGrip_N, kPadFriction};
  return find_pad_model("pad_layer")->predict(problem);
}

double pad_arm_m() { return asked_pad().eccentricity_m; }

/// Offset at which both contacts of arm e_n leave the friction ellipsoid.
double largest_offset_m(double arm_m) {
  const double half_weight_N = kMass_kg * kGravity / 2, limit_N = kPadFriction * kPadGrip_N;
  return arm_m * std::sqrt(limit_N * limit_N - half_weight_N * half_weight_N) / half_weight_N;
}

TEST(SoftFaces, HoldABoxUpToTheOffsetOfTheClosedForm) {
  const double offset_m = largest_offset_m(pad_arm_m());
  const Simulation holds = simulated_gripper(gripper(0.99 * offset_m, 0.3));
  const Simulation turns = simulated_gripper(gripper(1.01 * offset_m, 0.3));
  ASSERT_TRUE(holds.failure.empty()) << holds.failure;
  ASSERT_TRUE(turns.failure.empty()) << turns.failure;
  // A step that only sticks turns by the rounding of its impulses; one beyond the limit is
  // accelerated by a hundredth of the weight's torque.
  EXPECT_LT(turned_by_rad(holds), 1e-7);
  EXPECT_GT(turned_by_rad(turns), 1e-3);
}

TEST(SoftFaces, ShareTheWeightWhileTheyTurn) {
  // Friction moves the pressure's centre, and the centre friction: the one must not drive the other
  // to and fro, so that one pad bears the weight and then the other one.
  const Simulation turns = simulated_gripper(gripper(1.1 * largest_offset_m(pad_arm_m()), 0.3));
  ASSERT_TRUE(turns.failure.empty()) << turns.failure;
  const auto& contacts = turns.recording.frames.back().contacts;
  ASSERT_EQ(contacts.size(), 2u);
  for (const RecordedContact& contact : contacts) EXPECT_TRUE(contact.slides);
  const auto force_N = [](const RecordedContact& contact) {
    return std::hypot(contact.tangent_force_1_N, contact.tangent_force_2_N);
  };
  EXPECT_NEAR(force_N(contacts[0]), force_N(contacts[1]), 1e-3 * force_N(contacts[0]));
}

/// Offset at which both faces turn whose corners bear equal loads: the weight's power in the turn
/// about any point of the line through the middle, against that of friction.
double largest_offset_on_corners_m() {
  const double half_weight_N = kMass_kg * kGravity / 2;
  double least_m = 1;
  for (double centre_m = -0.2; centre_m < 0.05; centre_m += 1e-5) {
    double arms_m = 0;
    for (const double x_m : {-kPad_m[0] / 2, kPad_m[0] / 2})
      arms_m += 2 * std::hypot(x_m - centre_m, kPad_m[1] / 2) / 4;
    least_m = std::min(least_m, centre_m + kPadFriction * kPadGrip_N * arms_m / half_weight_N);
  }
  return least_m;
}

TEST(RigidFaces, HoldABoxAsFarAsFourEquallyLoadedCornersDo) {
  const double offset_m = largest_offset_on_corners_m();
  const std::string pad = "box_size_mm = [22, 20, 37.5]";
  // Rigid bodies leave open how the corners share the load. Far below the limit a box once turned
  // by whatever share the solver met.
  for (const double part : {0.1, 0.5, 0.99}) {
    const Simulation holds = simulated_gripper(gripper(part * offset_m, 0.3, pad, ""));
    ASSERT_TRUE(holds.failure.empty()) << holds.failure;
    EXPECT_LT(turned_by_rad(holds), 1e-7) << "at " << part << " of the largest offset";
  }
  const Simulation turns = simulated_gripper(gripper(1.01 * offset_m, 0.3, pad, ""));
  ASSERT_TRUE(turns.failure.empty()) << turns.failure;
  EXPECT_GT(turned_by_rad(turns), 1e-3);
}

TEST(SoftFaces, AreOneContactForEachPairOfFaces) {
  const Simulation held = simulated_gripper(gripper(0.01, 0.02));
  const auto& contacts = held.recording.frames.back().contacts;
  ASSERT_EQ(contacts.size(), 2u);
  for (const RecordedContact& contact : contacts) {
    EXPECT_EQ(contact.model, "pad_layer");
    EXPECT_NEAR(contact.normal_force_N, kPadGrip_N, 1e-6 * kPadGrip_N);
    // The samples of the pressure against its own modes.
    EXPECT_NEAR(contact.eccentricity_m, pad_arm_m(), 2e-3 * pad_arm_m());
    // Each bears half of the weight, 10 mm beside the pressure's centre.
    EXPECT_NEAR(std::abs(contact.torque_Nm), kMass_kg * kGravity / 2 * 0.01, 1e-6);
    EXPECT_NEAR(std::hypot(contact.tangent_force_1_N, contact.tangent_force_2_N),
                kMass_kg * kGravity / 2, 1e-4);
  }
  EXPECT_TRUE(held.recording.unknown.empty()) << "nothing is taken as rigid points";
}

TEST(SoftFaces, WithPreslidingTurnByTheirTorqueOverTheStiffness) {
  constexpr double kOffset_m = 2e-3;
  const Simulation held = simulated_gripper(gripper(kOffset_m, 0.6) + "presliding = true\n");
  ASSERT_TRUE(held.failure.empty()) << held.failure;
  // The box swings about where it hangs.
  double sum_rad = 0;
  int count = 0;
  for (const Frame& frame : held.recording.frames) {
    if (frame.time_s < 0.3) continue;
    sum_rad += Eigen::AngleAxisd(frame.poses[0].linear()).angle();
    ++count;
  }
  const double expected_rad =
      kMass_kg * kGravity / 2 * kOffset_m / asked_pad().torsional_stiffness_Nm_per_rad;
  // At a third of the limit, and twice that as it first swings, part of the pad has slipped.
  EXPECT_GT(sum_rad / count, expected_rad);
  EXPECT_LT(sum_rad / count, 1.2 * expected_rad);
}

TEST(SoftFaces, OfACylinderAreDiscs) {
  const Simulation held = simulated_gripper(
      gripper(0.001, 0.02, "cylinder_radius_length_mm = [10, 20], rotation_deg = [90, 0, 0]"));
  ASSERT_TRUE(held.failure.empty()) << held.failure;
  const auto& contacts = held.recording.frames.back().contacts;
  ASSERT_EQ(contacts.size(), 2u);
  // Between thin incompressible and uniform pressure on a disc.
  EXPECT_GT(contacts[0].eccentricity_m, 8. / 15 * 0.01);
  EXPECT_LT(contacts[0].eccentricity_m, 2. / 3 * 0.01);
}

/// A pad on one joint is pressed on a plate that is fixed, and pushed or twisted along the joint.
Simulation pad_on_a_joint(const std::string& joint, const std::string& force) {
  return simulated_gripper(
      "id = \"joint\"\n[simulation]\ntime_step_ms = 1\nduration_s = 0.05\n"
      "gravity_m_per_s2 = [0, 0, 0]\n[[layer]]\nname = \"rubber\"\nthickness_mm = 3\n"
      "youngs_modulus_kPa = 800\npoisson_ratio = 0.49\n"
      "[[body]]\nname = \"plate\"\nfixed = true\nshapes = [{ box_size_mm = [200, 40, 80] }]\n"
      "[[body]]\nname = \"pad\"\nmass_g = 20\nposition_mm = [0, -30, 0]\nlayer = \"rubber\"\n"
      "shapes = [{ box_size_mm = [22, 20, 37.5] }]\n"
      "[[contact]]\nbodies = [\"*\", \"*\"]\nfriction_coefficient = 0.7\n" +
      joint + "[[force]]\nbody = \"pad\"\ntime_s = [0]\n" + force);
}

TEST(SoftFaces, ThatCannotSlideOnlyPress) {
  const Simulation pressed = pad_on_a_joint(
      "[[joint]]\nname = \"slide\"\nkind = \"prismatic\"\nparent = \"world\"\n"
      "child = \"pad\"\naxis = [0, 1, 0]\n",
      "force_N = [[0, 10, 0]]\ntorque_Nm = [[0, 0, 0]]\n");
  ASSERT_TRUE(pressed.failure.empty()) << pressed.failure;
  const auto& contacts = pressed.recording.frames.back().contacts;
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(contacts[0].normal_force_N, 10, 1e-6);
  EXPECT_NEAR(std::abs(contacts[0].torque_Nm), 0, 1e-12);
}

TEST(SoftFaces, NeverGainEnergyByRocking) {
  // A block on a soft foot, knocked, rocks from edge to edge until it rests.
  const std::string text =
      "id = \"rocking\"\n[simulation]\ntime_step_ms = 1\nduration_s = 10\n"
      "[[layer]]\nname = \"rubber\"\nthickness_mm = 3\nyoungs_modulus_kPa = 800\n"
      "poisson_ratio = 0.49\n"
      "[[body]]\nname = \"table\"\nfixed = true\nshapes = [{ half_space = true }]\n"
      "[[body]]\nname = \"block\"\nmass_g = 300\nposition_mm = [0, 0, 50]\n"
      "shapes = [{ box_size_mm = [40, 60, 100] }]\nlayer = \"rubber\"\n"
      "angular_velocity_deg_per_s = [70, 110, 30]\n"
      "[[contact]]\nbodies = [\"*\", \"*\"]\nfriction_coefficient = 0.6\n";
  const input::Scene scene = input::parse_scene(text, "rocking.toml");
  const Simulation rocking = simulate(scene);
  ASSERT_TRUE(rocking.failure.empty()) << rocking.failure;
  ASSERT_EQ(rocking.steps, 10000);
  const auto& body = scene.descriptions[1];
  const auto energy_J = [&](const Frame& frame) {
    const Eigen::Matrix3d turn = frame.poses[1].linear();
    const Eigen::Vector3d spin = turn.transpose() * frame.angular_velocities_rad_per_s[1];
    return 0.5 * body.mass.mass_kg * frame.velocities_m_per_s[1].squaredNorm() +
           0.5 * spin.dot(body.mass.inertia_kg_m2 * spin) +
           body.mass.mass_kg * kGravity * frame.poses[1].translation().z();
  };
  double last_J = energy_J(rocking.recording.frames.front());
  const double scale_J = body.mass.mass_kg * kGravity * 0.1;
  for (const Frame& frame : rocking.recording.frames) {
    const double now_J = energy_J(frame);
    // The rounding of a gap, which is closed within a step, lifts by as much.
    EXPECT_LE(now_J, last_J + 1e-6 * scale_J) << "at " << frame.time_s << " s";
    last_J = std::min(last_J, now_J);
  }
  const double rest_J = scale_J / 2;
  EXPECT_NEAR(last_J, rest_J, 1e-3 * rest_J) << "it rests on its foot";
}

}  // namespace
}  // namespace softfinger::simulation
