// Whole scenes: the threshold of a pinch against the friction ellipsoid and the exact limit
// surface, and what the built-in scenes ask.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "comparisons/simulation/simulate.h"
#include "softfinger/friction/friction_shape.h"
#include "softfinger/math/pi.h"

namespace softfinger::simulation {
namespace {

using Eigen::Vector3d;

constexpr double kGrip_N = 5, kFriction = 0.8;

/// Two soft fingertips press a plate with 5 N; the load acts on the plate from the first step on.
std::string pinch(const std::string& friction, const std::string& contact, double force_N,
                  double torque_Nm, double duration_s) {
  const auto tip = [](const char* side, double x_mm, int axis) {
    return fmt::format(
        "[[body]]\nname = \"{0}_tip\"\nmass_g = 10\nposition_mm = [{1}, 0, 0]\n"
        "shapes = [{{ sphere_radius_mm = 10 }}]\nlayer = \"silicone\"\n"
        "[[joint]]\nname = \"{0}_slide\"\nkind = \"prismatic\"\nparent = \"world\"\n"
        "child = \"{0}_tip\"\naxis = [{2}, 0, 0]\n"
        "[[motor]]\njoint = \"{0}_slide\"\ntime_s = [0]\neffort_N = [5]\n",
        side, x_mm, axis);
  };
  return fmt::format(
             "id = \"pinch\"\n[simulation]\ntime_step_ms = 1\nduration_s = {}\n"
             "gravity_m_per_s2 = [0, 0, 0]\nfriction = \"{}\"\n"
             "[[layer]]\nname = \"silicone\"\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
             "poisson_ratio = 0.49\n"
             "[[body]]\nname = \"plate\"\nmass_g = 50\n"
             "shapes = [{{ box_size_mm = [10, 40, 40] }}]\n",
             duration_s, friction) +
         tip("left", -15, 1) + tip("right", 15, -1) +
         fmt::format(
             "[[force]]\nbody = \"plate\"\ntime_s = [0]\nforce_N = [[0, {0:.17g}, {1:.17g}]]\n"
             "torque_Nm = [[{2:.17g}, 0, 0]]\n"
             "[[contact]]\nbodies = [\"*\", \"plate\"]\nfriction_coefficient = 0.8\n{3}\n",
             0.6 * force_N, 0.8 * force_N, torque_Nm, contact);
}

const char* const kGiven = "model = \"given\"\neccentricity_mm = 1.7";

Simulation run(const std::string& text) { return simulate(input::parse_scene(text, "pinch.toml")); }

/// Angular velocity of the plate at the end.
double spin(const Simulation& run) {
  return run.recording.frames.back().angular_velocities_rad_per_s[0].norm();
}
double speed(const Simulation& run) {
  return run.recording.frames.back().velocities_m_per_s[0].norm();
}

/// e_n of the soft fingertips under their grip, as the simulation says it.
double soft_arm_m(const std::string& friction) {
  const Simulation still = run(pinch(friction, "", 0, 0, 0.01));
  const auto& contacts = still.recording.frames.back().contacts;
  EXPECT_EQ(contacts.size(), 2u);
  EXPECT_NEAR(contacts.at(0).normal_force_N, kGrip_N, 1e-9 * kGrip_N);
  return contacts.at(0).eccentricity_m;
}

void expect_threshold(const std::string& friction, const std::string& contact, double arm_m,
                      double load, double torque_part) {
  const double force_limit = 2 * kFriction * kGrip_N, limit = force_limit * arm_m * torque_part;
  const Simulation holds = run(pinch(friction, contact, load * force_limit, 0.999999 * limit, 0.2));
  ASSERT_EQ(holds.failure, "");
  const Simulation slips = run(pinch(friction, contact, load * force_limit, 1.000001 * limit, 0.2));
  ASSERT_EQ(slips.failure, "");
  std::printf(
      "pinch, %s%s, %.2f of mu P: below the limit creeps at %.1e rad/s and %.1e m/s; above, %.1e "
      "rad/s after 0.2 s\n",
      friction.c_str(), contact.empty() ? ", soft" : "", load, spin(holds), speed(holds),
      spin(slips));
  EXPECT_LT(spin(holds), 1e-10);
  EXPECT_LT(speed(holds), 1e-10);
  // The rest of the torque alone turns the plate: 1e-6 of the limit for 0.2 s, at least a tenth of
  // it, for the slip takes part of the force too.
  const double inertia = 0.05 * 2 * 0.04 * 0.04 / 12;
  EXPECT_GT(spin(slips), 0.1 * 1e-6 * limit / inertia * 0.2);
}

TEST(PinchThreshold, OfTheEllipsoidInPureTorsionAndWithTangentialLoad) {
  for (const double load : {0., 0.6, 0.8, 0.95})
    expect_threshold("ellipsoid", kGiven, 1.7e-3, load, std::sqrt(1 - load * load));
}

TEST(PinchThreshold, OfSoftFingertipsWhoseArmDependsOnTheGrip) {
  const double arm = soft_arm_m("ellipsoid");
  EXPECT_GT(arm, 5e-4);
  EXPECT_LT(arm, 5e-3);
  for (const double load : {0., 0.6, 0.8, 0.95})
    expect_threshold("ellipsoid", "", arm, load, std::sqrt(1 - load * load));
}

TEST(PinchThreshold, OfTheExactLimitSurface) {
  // Torque that a circular contact of the model's pressure carries beside the load.
  const Simulation still = run(pinch("limit_surface", "", 0, 0, 0.01));
  const RecordedContact& contact = still.recording.frames.back().contacts.at(0);
  const LimitSurfaceShape shape(contact.semi_axis_b_m / contact.semi_axis_a_m,
                                contact.pressure_exponent);
  for (const double load : {0., 0.6, 0.8, 0.95}) {
    double least = 0, most = 1;
    while (most - least > 1e-15) {
      const double middle = (least + most) / 2;
      // The load's own direction, as the contact's tangents see it, is any for a circle.
      (friction_gauge(&shape, Vector3d(load, 0, middle)) < 1 ? least : most) = middle;
    }
    if (load > 0) {
      EXPECT_LT(least, std::sqrt(1 - load * load) - 1e-3) << "inside the ellipsoid";
    }
    expect_threshold("limit_surface", "", contact.eccentricity_m, load, least);
  }
}

TEST(BuiltinScenes, LiftTheBoxUpright) {
  const Simulation lift = simulate(input::read_scene(SOFTFINGER_SCENES "/lift_box.toml"));
  EXPECT_EQ(lift.failure, "");
  EXPECT_EQ(lift.steps, 2000);
  const Frame &first = lift.recording.frames.front(), &last = lift.recording.frames.back();
  const double turned =
      Eigen::AngleAxisd(last.poses[1].linear() * first.poses[1].linear().transpose()).angle();
  const double lifted = last.poses[1].translation().z() - first.poses[1].translation().z();
  std::printf("lift_box: lifted %.4f mm, turned %.1e rad\n", 1e3 * lifted, turned);
  // The hand sags by the weight over the motor's stiffness.
  EXPECT_NEAR(lifted, 0.04 - 0.64 * 9.81 / 20000, 2e-4);
  // Below the limit nothing slips: what turns is round-off, 1e-10 rad/s over 2 s.
  EXPECT_LT(turned, 2e-10);
}

TEST(BuiltinScenes, LetTheCurvedObjectTurnInTheGrasp) {
  const Simulation lift = simulate(input::read_scene(SOFTFINGER_SCENES "/lift_curved.toml"));
  EXPECT_EQ(lift.failure, "");
  EXPECT_EQ(lift.steps, 2000);
  const Frame &first = lift.recording.frames.front(), &last = lift.recording.frames.back();
  const Eigen::AngleAxisd turned(last.poses[1].linear() * first.poses[1].linear().transpose());
  std::printf("lift_curved: turned %.2f degrees\n", turned.angle() * 180 / kPi);
  EXPECT_GT(turned.angle(), 10 * kPi / 180);
  EXPECT_GT(std::abs(turned.axis().y()), 0.99) << "about the line of the fingers";
  int drags = 0;
  for (const Frame& frame : lift.recording.frames) {
    const Eigen::AngleAxisd now(frame.poses[1].linear() * first.poses[1].linear().transpose());
    for (const RecordedContact& contact : frame.contacts)
      drags += (contact.a == 0 || contact.b == 0) && now.angle() > 1 * kPi / 180;
  }
  EXPECT_GT(drags, 100) << "and drags on the table while it turns";
}

TEST(BuiltinScenes, HundredContactsAreHundred) {
  input::Scene scene = input::read_scene(SOFTFINGER_SCENES "/hundred_contacts.toml");
  scene.duration_s = 0.02;
  const Simulation simulation = simulate(scene);
  EXPECT_EQ(simulation.failure, "");
  EXPECT_EQ(simulation.steps, 20);
  EXPECT_EQ(simulation.most_contacts, 100);
  double weight = 0, carried = 0;
  for (const BodyDescription& body : scene.descriptions)
    if (!body.fixed) weight += body.mass.mass_kg * 9.81;
  for (const RecordedContact& contact : simulation.recording.frames.back().contacts)
    if (contact.a == 0) carried += contact.normal_force_N;
  EXPECT_NEAR(carried / weight, 1, 1e-8);
}

}  // namespace
}  // namespace softfinger::simulation
