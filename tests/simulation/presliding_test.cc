// Contacts that give way before they slide, in whole scenes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "comparisons/simulation/presliding_contacts.h"
#include "comparisons/simulation/simulate.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/friction/partial_slip.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/equivalent_exponent.h"

namespace softfinger::simulation {
namespace {

/// A plate of 50 g between two soft fingertips that press with 5 N; a torque about their line over
/// time, in steps of 4 ms.
std::string pinch(const std::string& torque, double duration_s, const std::string& contact,
                  double time_step_ms = 4) {
  const auto tip = [](const char* side, int x_mm, int axis) {
    return fmt::format(
        "[[body]]\nname = \"{0}\"\nmass_g = 10\nposition_mm = [{1}, 0, 0]\n"
        "shapes = [{{ sphere_radius_mm = 10 }}]\nlayer = \"silicone\"\n"
        "[[joint]]\nname = \"{0}_slide\"\nkind = \"prismatic\"\nparent = \"world\"\n"
        "child = \"{0}\"\naxis = [{2}, 0, 0]\n"
        "[[motor]]\njoint = \"{0}_slide\"\ntime_s = [0]\neffort_N = [5]\n",
        side, x_mm, axis);
  };
  return fmt::format(
             "id = \"pinch\"\n[simulation]\ntime_step_ms = {}\nduration_s = {}\n"
             "gravity_m_per_s2 = [0, 0, 0]\n"
             "[[layer]]\nname = \"silicone\"\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
             "poisson_ratio = 0.49\n"
             "[[body]]\nname = \"plate\"\nmass_g = 50\nshapes = [{{ box_size_mm = [10, 40, 40] "
             "}}]\n",
             time_step_ms, duration_s) +
         tip("left", -15, 1) + tip("right", 15, -1) +
         fmt::format(
             "[[force]]\nbody = \"plate\"\n{}\n"
             "[[contact]]\nbodies = [\"*\", \"plate\"]\nfriction_coefficient = 0.8\n{}\n",
             torque, contact);
}

Simulation simulated(const std::string& text) {
  return simulate(input::parse_scene(text, "pinch.toml"));
}

double turned_rad(const Frame& frame) { return Eigen::AngleAxisd(frame.poses[0].linear()).angle(); }

/// The contact's largest torque, its stiffness and its curve.
struct Fingertip {
  double max_torque_Nm, stiffness_Nm_per_rad;
  TwistCurve curve;
};
Fingertip fingertip() {
  ContactProblem problem;
  problem.radii = {0.01, 0.01, 0};
  problem.finger_curvature = {1 / 0.01, 1 / 0.01, 0};  // a ball on a flat plate
  problem.layer.thickness_m = 2e-3;
  problem.layer.youngs_modulus_Pa = 3e5;
  problem.layer.poisson_ratio = 0.49;
  problem.load = {5, 0.8};
  const PressureModel& model = default_model(problem);
  const Prediction prediction = model.predict(problem);
  return {
      0.8 * 5 * prediction.torque_arm_exact_m,
      stuck_stiffness_at(model, problem, 5)->torsional_Nm_per_rad,
      TwistCurve(equivalent_exponent(prediction), 1, prediction.a_m / problem.layer.thickness_m)};
}

const char* const kPresliding = "presliding = true";

TEST(Presliding, HoldsAPlateAtTheAngleOfTheCurveWithoutCreep) {
  const Fingertip tip = fingertip();
  for (const double used : {0.3, 0.6, 0.8}) {
    const double torque_Nm = 2 * used * tip.max_torque_Nm;
    const Simulation held = simulated(
        pinch(fmt::format("time_s = [0.2, 2]\ntorque_Nm = [[0, 0, 0], [{:.17g}, 0, 0]]", torque_Nm),
              12, kPresliding));
    ASSERT_TRUE(held.failure.empty()) << held.failure;
    const auto& frames = held.recording.frames;
    const double angle = turned_rad(frames.back());
    std::printf("held at %.0f %% of the limit: turned by %.3f degrees\n", 100 * used,
                angle * 180 / kPi);
    // 16 chords: 0.6 % of the limit.
    EXPECT_NEAR(tip.curve(tip.stiffness_Nm_per_rad * angle / tip.max_torque_Nm), used, 0.012);
    EXPECT_NEAR(turned_rad(frames[frames.size() - 500]), angle, 1e-8)
        << "two seconds before; the solver's residual makes some 1e-9 rad/s";
    for (const RecordedContact& contact : frames.back().contacts) EXPECT_FALSE(contact.slides);
  }
}

TEST(Presliding, LeavesTheAngleOfMasingsRulesBehind) {
  const Fingertip tip = fingertip();
  const Simulation released = simulated(
      pinch(fmt::format("time_s = [0.2, 4, 6, 10]\ntorque_Nm = [[0, 0, 0], [{0:.17g}, 0, 0], "
                        "[{0:.17g}, 0, 0], [0, 0, 0]]",
                        2 * 0.8 * tip.max_torque_Nm),
            16, kPresliding));
  ASSERT_TRUE(released.failure.empty());
  const double angle = turned_rad(released.recording.frames.back());
  MasingPath<TwistCurve> path{tip.curve};
  double most = 0;
  while (tip.curve(most) < 0.8) most += 1e-4;
  path.go_to(most);
  path.go_to(tip.stiffness_Nm_per_rad * angle / tip.max_torque_Nm);
  EXPECT_NEAR(path.y(), 0, 0.02) << "the torque at this angle, over the largest";
  EXPECT_GT(angle, 0.01) << "some of it has slipped";
}

TEST(Presliding, KeepsTheLimit) {
  const Fingertip tip = fingertip();
  for (const double used : {0.98, 1.02}) {
    const Simulation turned =
        simulated(pinch(fmt::format("time_s = [0.2, 3]\ntorque_Nm = [[0, 0, 0], [{:.17g}, 0, 0]]",
                                    2 * used * tip.max_torque_Nm),
                        5, kPresliding));
    const Frame& end = turned.recording.frames.back();
    EXPECT_EQ(std::all_of(end.contacts.begin(), end.contacts.end(),
                          [](const RecordedContact& contact) { return contact.slides; }),
              used > 1);
    if (used < 1) continue;
    for (const RecordedContact& contact : end.contacts)
      EXPECT_NEAR(std::abs(contact.torque_Nm) / tip.max_torque_Nm, 1, 1e-9);
  }
}

TEST(Presliding, SwingsOfAPlateDieAway) {
  // A blow, then nothing: each swing back is smaller, at any time step, in which a plate on these
  // springs turns by 0.06 to 6 radians of its swing.
  for (const double step_ms : {1., 10., 100.}) {
    const Simulation struck = simulated(
        pinch(fmt::format(
                  "time_s = [{0}, {1}, {2}]\ntorque_Nm = [[0.006, 0, 0], [0.006, 0, 0], [0, 0, 0]]",
                  0, 2e-3 * step_ms, 4e-3 * step_ms),
              100e-3 * step_ms, kPresliding, step_ms));
    ASSERT_TRUE(struck.failure.empty());
    double peak = 1e300, last = 0, before = 0;
    int peaks = 0;
    for (const Frame& frame : struck.recording.frames) {
      if (frame.time_s < 5e-3 * step_ms) continue;
      const double speed = frame.angular_velocities_rad_per_s[0].norm();
      if (last > before && last >= speed && last > 1e-6) {  // the solver's residual makes 1e-8
        EXPECT_LE(last, peak * (1 + 1e-9)) << step_ms << " ms, at " << frame.time_s;
        peak = last;
        ++peaks;
      }
      before = last;
      last = speed;
    }
    if (step_ms < 2) {
      EXPECT_GE(peaks, 2);
    }
  }
}

TEST(Presliding, IsRefusedWhereNoEllipseIsKnown) {
  EXPECT_THROW(input::parse_scene(pinch("time_s = [0]\ntorque_Nm = [[0, 0, 0]]", 1,
                                        "model = \"rigid\"\npresliding = true"),
                                  "pinch.toml"),
               InputError);
}

}  // namespace
}  // namespace softfinger::simulation
