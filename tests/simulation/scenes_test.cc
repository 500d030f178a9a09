// Whole scenes: the threshold of a pinch against its friction law, which contacts slide, and what
// the built-in scenes ask.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "comparisons/simulation/simulate.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/accuracy/error_bound.h"
#include "softfinger/friction/friction_shape.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::simulation {
namespace {

using Eigen::Vector3d;

constexpr double kGrip_N = 5, kFriction = 0.8;
const char* const kBall = "sphere_radius_mm = 10";
/// An ellipse as contact has axes; those of a circle would be any.
const char* const kEgg = "ellipsoid_semi_axes_mm = [10, 8, 10]";

/// Two soft fingertips press a plate with 5 N; the load acts on the plate from the first step on.
std::string pinch(const std::string& friction, const std::string& contact, double force_N,
                  double torque_Nm, double duration_s, const std::string& tip_shape = kBall) {
  const auto tip = [&](const char* side, double x_mm, int axis) {
    return fmt::format(
        "[[body]]\nname = \"{0}_tip\"\nmass_g = 10\nposition_mm = [{1}, 0, 0]\n"
        "shapes = [{{ {3} }}]\nlayer = \"silicone\"\n"
        "[[joint]]\nname = \"{0}_slide\"\nkind = \"prismatic\"\nparent = \"world\"\n"
        "child = \"{0}_tip\"\naxis = [{2}, 0, 0]\n"
        "[[motor]]\njoint = \"{0}_slide\"\ntime_s = [0]\neffort_N = [5]\n",
        side, x_mm, axis, tip_shape);
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

/// A pendulum of 100 g that hangs 100 mm below its joint.
std::string pendulum(const std::string& joint, const std::string& velocity) {
  return "id = \"pendulum\"\n[simulation]\ntime_step_ms = 1\nduration_s = 0.5\n"
         "[[body]]\nname = \"bob\"\nmass_g = 100\nposition_mm = [0, 0, -100]\n"
         "inertia_kg_mm2 = [10, 20, 30]\n" +
         velocity +
         "[[joint]]\nname = \"hinge\"\nparent = \"world\"\nchild = \"bob\"\n"
         "anchor_mm = [0, 0, 0]\n" +
         joint;
}

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
                      double load, double torque_part, const std::string& tip_shape = kBall) {
  const double force_limit = 2 * kFriction * kGrip_N, limit = force_limit * arm_m * torque_part;
  const Simulation holds =
      run(pinch(friction, contact, load * force_limit, 0.999999 * limit, 0.2, tip_shape));
  ASSERT_EQ(holds.failure, "");
  const Simulation slips =
      run(pinch(friction, contact, load * force_limit, 1.000001 * limit, 0.2, tip_shape));
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

/// The pinch with another effort of both motors.
std::string with_grip(std::string text, double grip_N) {
  const std::string effort = "effort_N = [5]", other = fmt::format("effort_N = [{:.17g}]", grip_N);
  for (std::size_t at = 0; (at = text.find(effort, at)) != std::string::npos; at += other.size())
    text.replace(at, effort.size(), other);
  return text;
}

// On a circle under the stress tau_0: T = 2/3 pi tau_0 a³, whatever the grip.
TEST(PinchThreshold, OfConstantShearStressFollowsTheAreaAndNotTheGrip) {
  const std::string law = "shear_law = \"shear_strength\"\nshear_strength_kPa = 20";
  for (const double grip_N : {0.5, 5.0, 40.0}) {
    const auto pinched = [&](double torque_Nm, double duration_s) {
      const Simulation result =
          run(with_grip(pinch("ellipsoid", law, 0, torque_Nm, duration_s), grip_N));
      EXPECT_EQ(result.failure, "");
      return result;
    };
    const Simulation still = pinched(0, 0.01);
    const RecordedContact& contact = still.recording.frames.back().contacts.at(0);
    const double a = contact.semi_axis_a_m;
    EXPECT_NEAR(contact.friction_coefficient * grip_N / (kPi * a * a * 2e4), 1, 1e-6);
    EXPECT_NEAR(contact.eccentricity_m / (2 * a / 3), 1, 1e-6);
    EXPECT_NEAR(contact.pressure_exponent, 0, 1e-6) << "the surface of a uniform stress";
    const double limit_Nm = 2 * (2 * kPi / 3) * 2e4 * a * a * a;
    EXPECT_LT(spin(pinched(0.999 * limit_Nm, 0.05)), 1e-9) << grip_N;
    EXPECT_GT(spin(pinched(1.001 * limit_Nm, 0.05)), 1e-6) << grip_N;
  }
}

// Limited friction between Coulomb's law, at a light grip, and its strength.
TEST(PinchThreshold, OfLimitedFrictionTurnsFromCoulombsToTheStrength) {
  const auto contact_of = [&](const std::string& law, double grip_N) {
    return run(with_grip(pinch("limit_surface", law, 0, 0, 0.01), grip_N))
        .recording.frames.back()
        .contacts.at(0);
  };
  const std::string law = "shear_law = \"limited\"\nshear_strength_kPa = 20";
  const RecordedContact light = contact_of(law, 1e-3), coulomb = contact_of("", 1e-3);
  EXPECT_NEAR(light.friction_coefficient, 0.8, 1e-9);
  EXPECT_NEAR(light.eccentricity_m / coulomb.eccentricity_m, 1, 1e-9);
  const RecordedContact heavy = contact_of(law, 200);
  EXPECT_LT(heavy.friction_coefficient, 0.3);
  EXPECT_GT(heavy.eccentricity_m, contact_of("", 200).eccentricity_m);
}

/// The laws whose limit depends on the ellipse: the exact limit surface and six patches.
class PinchThresholdOfAShape : public testing::TestWithParam<const input::FrictionLaw*> {};

TEST_P(PinchThresholdOfAShape, IsOnItsSurface) {
  const std::string law(GetParam()->name);
  // Torque that a contact of the model's pressure carries beside the load.
  const Simulation still = run(pinch(law, "", 0, 0, 0.01, kEgg));
  const RecordedContact& contact = still.recording.frames.back().contacts.at(0);
  const auto shape =
      GetParam()->shape(contact.semi_axis_b_m / contact.semi_axis_a_m, contact.pressure_exponent);
  // The load's direction as the contact's tangents see it.
  const Vector3d along = contact.axes.transpose() * Vector3d(0, 0.6, 0.8);
  for (const double load : {0., 0.6, 0.8, 0.95}) {
    double least = 0, most = 1;
    while (most - least > 1e-15) {
      const double middle = (least + most) / 2;
      const Vector3d wrench(load * along[0], load * along[1], middle);
      (friction_gauge(shape.get(), wrench) < 1 ? least : most) = middle;
    }
    if (load > 0) {
      EXPECT_LT(least, std::sqrt(1 - load * load) - 1e-3) << "inside the ellipsoid";
    }
    expect_threshold(law, "", contact.eccentricity_m, load, least, kEgg);
  }
}
INSTANTIATE_TEST_SUITE_P(Laws, PinchThresholdOfAShape,
                         testing::Values(&input::kLimitSurfaceLaw, &input::kSixPatchesLaw),
                         [](const auto& law) { return std::string(law.param->name); });

/// A soft ball on a table, which may be pushed along it and spins about the vertical. Its spin at
/// the rim of the contact is about as fast as the push, so that force and torque share the limit.
std::string ball_on_table(std::string_view law, double velocity_mm_per_s, double spin_deg_per_s) {
  return fmt::format(
      "id = \"ball\"\n[simulation]\ntime_step_ms = 0.1\nduration_s = 0.0005\n"
      "friction = \"{}\"\n"
      "[[layer]]\nname = \"foam\"\nthickness_mm = 2\nyoungs_modulus_kPa = 100\n"
      "poisson_ratio = 0.3\n"
      "[[body]]\nname = \"table\"\nfixed = true\nshapes = [{{ half_space = true }}]\n"
      "[[body]]\nname = \"ball\"\nposition_mm = [0, 0, 10]\nmass_g = 100\nlayer = \"foam\"\n"
      "velocity_mm_per_s = [{}, 0, 0]\nangular_velocity_deg_per_s = [0, 0, {}]\n"
      "shapes = [{{ sphere_radius_mm = 10 }}]\n",
      law, velocity_mm_per_s, spin_deg_per_s);
}

class StickOrSlip : public testing::TestWithParam<const input::FrictionLaw*> {
 protected:
  const input::FrictionLaw& law() const { return *GetParam(); }
  /// The ball's contact in each frame after the start.
  std::vector<RecordedContact> contacts(double velocity_mm_per_s, double spin_deg_per_s) const {
    const Simulation run = simulate(input::parse_scene(
        ball_on_table(law().name, velocity_mm_per_s, spin_deg_per_s), "ball.toml"));
    EXPECT_EQ(run.failure, "");
    std::vector<RecordedContact> result;
    for (std::size_t f = 1; f < run.recording.frames.size(); ++f)
      result.push_back(run.recording.frames[f].contacts.at(0));
    EXPECT_EQ(result.size(), 5u);
    return result;
  }
};

TEST_P(StickOrSlip, ABallThatIsPushedAndSpinsSlides) {
  for (const RecordedContact& contact : contacts(20, 500)) {
    EXPECT_TRUE(contact.slides) << "utilisation " << contact.utilisation;
    EXPECT_EQ(contact.friction->name, law().name);
    const double torque_part = std::abs(contact.torque_Nm) / contact.eccentricity_m /
                               (contact.friction_coefficient * contact.normal_force_N);
    EXPECT_GT(torque_part, 0.3) << "force and torque together: where the laws differ";
    EXPECT_LT(torque_part, 0.95);
    if (&law() == &input::kFacetsLaw) {
      EXPECT_LT(contact.utilisation, 1 + 1e-9) << "facets lie inside the ellipsoid";
      EXPECT_GT(contact.utilisation, 0.8) << "LinearisedFriction::inner_bound of 16 vertices";
    } else {
      EXPECT_NEAR(contact.utilisation, 1, 1e-6) << "by the law that holds";
    }
  }
}

TEST_P(StickOrSlip, ABallAtRestSticks) {
  for (const RecordedContact& contact : contacts(0, 0)) EXPECT_FALSE(contact.slides);
}

INSTANTIATE_TEST_SUITE_P(Laws, StickOrSlip, testing::ValuesIn(input::all_friction_laws()),
                         [](const auto& law) { return std::string(law.param->name); });

TEST(StickOrSlip, BetweenTheCornersOfFacetsAPinchSlidesBelowTheEllipsoid) {
  const double limit_N = 2 * kFriction * kGrip_N;
  const Simulation slips =
      run(pinch("facets", kGiven, 0.6 * limit_N, 0.8 * limit_N * 1.7e-3, 0.005));
  ASSERT_EQ(slips.failure, "");
  double least_use = 1;
  for (std::size_t f = 1; f < slips.recording.frames.size(); ++f)
    for (const RecordedContact& contact : slips.recording.frames[f].contacts) {
      EXPECT_TRUE(contact.slides) << "frame " << f << ", utilisation " << contact.utilisation;
      least_use = std::min(least_use, contact.utilisation);
    }
  EXPECT_LT(least_use, 0.999) << "on a facet, not on one of its corners";
  EXPECT_GT(spin(slips), 1e-3);
}

/// The ball and a second one beside it, whose contact with the table has a law of its own.
std::string with_own_law(std::string_view law, std::string_view own) {
  return ball_on_table(law, 20, 500) +
         fmt::format(
             "[[body]]\nname = \"other\"\nposition_mm = [50, 0, 10]\nmass_g = 100\n"
             "layer = \"foam\"\nvelocity_mm_per_s = [20, 0, 0]\n"
             "angular_velocity_deg_per_s = [0, 0, 500]\n"
             "shapes = [{{ sphere_radius_mm = 10 }}]\n"
             "[[contact]]\nbodies = [\"table\", \"other\"]\n{}\n",
             own);
}

TEST(FrictionLaw, OfOnePairAloneHoldsForItAlone) {
  const std::string scene = with_own_law("ellipsoid", "friction = \"six_patches\"");
  const Simulation simulation = simulate(input::parse_scene(scene, "balls.toml"));
  ASSERT_EQ(simulation.failure, "");
  const auto& contacts = simulation.recording.frames.back().contacts;
  ASSERT_EQ(contacts.size(), 2u);
  for (const RecordedContact& contact : contacts) {
    EXPECT_EQ(contact.friction->name, contact.b == 1 ? "ellipsoid" : "six_patches");
    EXPECT_TRUE(contact.slides);
    EXPECT_NEAR(contact.utilisation, 1, 1e-6);
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

/// Angle in rad by which the object of the drag scenes is turned from upright.
double object_turn_rad(const Frame& frame) {
  return Eigen::AngleAxisd(frame.poses[1].linear()).angle();
}

/// A soft ellipsoid stands tilted on the floor and is let go. It rolls, so that the contact bears
/// the moment m g d about where it would stand upright, d = |dh/dphi| of its height
/// h = sqrt(across² sin² phi + up² cos² phi): m g (R - up) phi with R = across²/up for small
/// angles. Across the longer axis that turns it upright, across the shorter one over.
TEST(RollingContact, BearsTheMomentOfItsRelativeRadius) {
  constexpr double kAlong_m = 0.03, kAcross_m = 0.02, kUp_m = 0.025, kMass_kg = 0.1, kTilt = 0.1;
  constexpr double kStep_s = 1e-5;
  constexpr int kSteps = 100;
  for (const bool about_y : {true, false}) {
    const double across = about_y ? kAlong_m : kAcross_m;
    const double s = across * std::sin(kTilt), c = kUp_m * std::cos(kTilt);
    const double height = std::hypot(s, c);
    const double arm =
        (across * across - kUp_m * kUp_m) * std::sin(kTilt) * std::cos(kTilt) / height;
    const Simulation fall = run(
        fmt::format("id = \"egg\"\n[simulation]\ntime_step_ms = {}\nduration_s = {}\n"
                    "[[layer]]\nname = \"silicone\"\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
                    "poisson_ratio = 0.49\n"
                    "[[body]]\nname = \"floor\"\nfixed = true\nshapes = [{{ half_space = true }}]\n"
                    "[[body]]\nname = \"egg\"\nmass_g = 100\nposition_mm = [0, 0, {:.17g}]\n"
                    "rotation_deg = [{:.17g}, {:.17g}, 0]\nlayer = \"silicone\"\n"
                    "shapes = [{{ ellipsoid_semi_axes_mm = [30, 20, 25] }}]\n"
                    "[[contact]]\nbodies = [\"floor\", \"egg\"]\nfriction_coefficient = 1\n",
                    1e3 * kStep_s, kStep_s * kSteps, 1e3 * height, about_y ? 0 : kTilt * 180 / kPi,
                    about_y ? kTilt * 180 / kPi : 0));
    ASSERT_EQ(fall.failure, "");
    const double inertia =
        kMass_kg * ((across * across + kUp_m * kUp_m) / 5 + height * height + arm * arm);
    const double turned = kMass_kg * 9.81 * arm / inertia * kStep_s * kSteps;
    const Vector3d spin = fall.recording.frames.back().angular_velocities_rad_per_s[1];
    // The part by which the tilt, and with it the arm, changes until the end.
    const double change = std::abs(turned) * kStep_s * kSteps / kTilt;
    EXPECT_NEAR(-spin[about_y ? 1 : 0] / turned, 1, change) << (about_y ? "y" : "x");
  }
}

TEST(BuiltinScenes, CarryTheBoxWithoutSlip) {
  const Simulation drag = simulate(input::read_scene(SOFTFINGER_SCENES "/drag_box.toml"));
  ASSERT_EQ(drag.failure, "");
  const Frame& end = drag.recording.frames.back();
  EXPECT_NEAR(end.poses[1].translation().x(), 0.3, 1e-3);
  EXPECT_GT(end.poses[1].translation().z(), 0.049) << "20 mm above where it lay, less the sag";
  for (const Frame& frame : drag.recording.frames) EXPECT_LT(object_turn_rad(frame), 1e-3);
}

TEST(BuiltinScenes, DragTheCurvedObjectUntilItFalls) {
  const Simulation drag = simulate(input::read_scene(SOFTFINGER_SCENES "/drag_curved.toml"));
  ASSERT_EQ(drag.failure, "");
  double most_rad = 0, dragged_m = 0;
  const std::vector<Frame>& frames = drag.recording.frames;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    most_rad = std::max(most_rad, object_turn_rad(frames[i]));
    const bool on_table =
        std::any_of(frames[i].contacts.begin(), frames[i].contacts.end(),
                    [](const RecordedContact& contact) { return contact.a == 0; });
    if (on_table && object_turn_rad(frames[i]) > 5 * kPi / 180)
      dragged_m += (frames[i].poses[1].translation() - frames[i - 1].poses[1].translation()).x();
  }
  EXPECT_GT(most_rad, 15 * kPi / 180) << "it turns in the grasp";
  EXPECT_GT(dragged_m, 0.02) << "turned, it drags over the table";
  EXPECT_LT(object_turn_rad(frames.back()), 0.5 * kPi / 180) << "it has fallen flat";
  EXPECT_NEAR(frames.back().poses[1].translation().z(), 0.03, 1e-4);
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

// FCL finds no nearest points of this thin plate and the tiny cylinder on it.
TEST(Collision, ThatFailsEndsTheSceneInWords) {
  const Simulation failed =
      run("id = \"thin\"\n[simulation]\ntime_step_ms = 1\nduration_s = 0.003\n"
          "[[body]]\nname = \"plate\"\nfixed = true\n"
          "shapes = [{ box_size_mm = [12864.8, 0.000130898, 0.0589423] }]\n"
          "[[body]]\nname = \"dust\"\nmass_g = 100\ninertia_kg_mm2 = [10, 10, 10]\n"
          "position_mm = [-0.0103883861, 0, 0]\nrotation_deg = [0, 58.2544243, 0.00207179358]\n"
          "shapes = [{ cylinder_radius_length_mm = [0.000101404, 0.0125083] }]\n"
          "velocity_mm_per_s = [0, 0, -1000]\n");
  EXPECT_NE(failed.failure.find("step 1 at 0 s: the library FCL finds no nearest points of "
                                "\"plate\" and \"dust\""),
            std::string::npos)
      << failed.failure;
  EXPECT_EQ(failed.steps, 0);
}

}  // namespace
TEST(Velocity, SetsBodiesOnJointsGoing) {
  // 0.5 m/s about 0.1 m: the energy m v²/2 + I (v/l)²/2 lifts it by that over m g.
  constexpr double kMass_kg = 0.1, kInertia_kg_m2 = 20e-6, kLength_m = 0.1, kSpeed_m_per_s = 0.5;
  const double spin_per_s = kSpeed_m_per_s / kLength_m;
  const double energy_J =
      (kMass_kg * kSpeed_m_per_s * kSpeed_m_per_s + kInertia_kg_m2 * spin_per_s * spin_per_s) / 2;
  const double rise_m = energy_J / (kMass_kg * 9.81);
  const std::string linear = "velocity_mm_per_s = [500, 0, 0]\n",
                    angular = "angular_velocity_deg_per_s = [0, -286.4789, 0]\n";
  for (const char* joint : {"kind = \"revolute\"\naxis = [0, 1, 0]\n", "kind = \"ball\"\n"})
    for (const std::string& velocity : {linear + angular, linear, angular}) {
      // A ball joint leaves the turn about the axis open, and takes none.
      const Simulation swings = run(pendulum(joint, velocity));
      double highest_m = -1;
      for (const Frame& frame : swings.recording.frames)
        highest_m = std::max(highest_m, frame.poses[0].translation().z() + kLength_m);
      // Error of the time step and of the typed digits.
      EXPECT_NEAR(highest_m / rise_m, 1, 2e-3) << joint << velocity;
    }
}

/// A parallelogram of two cranks of 0.1 m on the ground and a coupler on top, closed by a loop.
std::string parallelogram(const std::string& of_left, const std::string& of_coupler) {
  const auto body = [](const char* name, const char* at, const std::string& lines) {
    return fmt::format(
        "[[body]]\nname = \"{}\"\nmass_g = 100\ninertia_kg_mm2 = [20, 20, 20]\nposition_mm = "
        "{}\n{}",
        name, at, lines);
  };
  const auto joint = [](const char* parent, const char* child, const char* at) {
    return fmt::format(
        "[[joint]]\nname = \"to_{}\"\nkind = \"revolute\"\nparent = \"{}\"\nchild = \"{}\"\n"
        "anchor_mm = {}\naxis = [0, 1, 0]\n",
        child, parent, child, at);
  };
  return "id = \"parallelogram\"\n[simulation]\ntime_step_ms = 1\nduration_s = 0.01\n" +
         body("left", "[0, 0, 50]", of_left) + body("coupler", "[50, 0, 100]", of_coupler) +
         body("right", "[100, 0, 50]", "") + joint("world", "left", "[0, 0, 0]") +
         joint("left", "coupler", "[0, 0, 100]") + joint("world", "right", "[100, 0, 0]") +
         "[[loop]]\nname = \"pin\"\nkind = \"ball\"\nbodies = [\"coupler\", \"right\"]\n"
         "anchor_mm = [100, 0, 100]\n";
}

TEST(Velocity, IsPassedOnThroughLoops) {
  // The cranks turn alike, and the coupler moves without turning.
  const input::Scene scene = input::parse_scene(
      parallelogram("angular_velocity_deg_per_s = [0, 57.2957795, 0]\n", ""), "scene.toml");
  Multibody bodies(scene.descriptions, scene.joints, scene.loops);
  ASSERT_EQ(scene.start_velocity.size(), bodies.velocities());
  bodies.set_velocity(scene.start_velocity);
  EXPECT_LT((bodies.angular_velocity(2) - Eigen::Vector3d::UnitY()).norm(), 1e-8);
  EXPECT_LT(bodies.angular_velocity(1).norm(), 1e-8);
  EXPECT_LT((bodies.velocity_at(1, bodies.center_of_mass_m(1)) - Eigen::Vector3d(0.1, 0, 0)).norm(),
            1e-9);
}

TEST(Velocity, ThatALoopForbidsIsRefused) {
  const std::string turns = "angular_velocity_deg_per_s = [0, 57.2957795, 0]\n";
  try {
    input::parse_scene(parallelogram(turns, turns), "scene.toml");
    FAIL() << "the coupler of a parallelogram does not turn";
  } catch (const InputError& error) {
    const std::string line = error.what();
    EXPECT_EQ(line.find("scene.toml:"), 0u) << line;
    EXPECT_NE(line.find("angular_velocity_deg_per_s"), std::string::npos) << line;
    EXPECT_NE(line.find("and the loops let body"), std::string::npos) << line;
  }
}

/// A soft ball on a table, pressed down.
std::string pressed_ball(const std::string& ball, double force_N) {
  return fmt::format(
      "id = \"pressed\"\n[simulation]\ntime_step_ms = 1\nduration_s = 0.02\n"
      "[[layer]]\nname = \"silicone\"\nthickness_mm = 2\nyoungs_modulus_kPa = 300\n"
      "poisson_ratio = 0.49\n"
      "[[body]]\nname = \"table\"\nfixed = true\nshapes = [{{ half_space = true }}]\n"
      "[[body]]\nname = \"tip\"\nmass_g = 10\nposition_mm = [0, 0, 10]\nlayer = \"silicone\"\n"
      "shapes = [{{ {} }}]\n"
      "[[force]]\nbody = \"tip\"\ntime_s = [0]\nforce_N = [[0, 0, {}]]\n",
      ball, -force_N);
}

TEST(UnknownErrors, AreThoseThatPredictDoesNotKnow) {
  for (const double force_N : {2., 10000.}) {
    const Simulation pressed = run(pressed_ball(kBall, force_N));
    ContactProblem contact;
    contact.radii = {10e-3, 10e-3, 0};
    contact.layer = {2e-3, 300e3, 0.49};
    contact.load = {force_N + 0.01 * 9.81, 0.5};
    contact.finger_curvature = {100, 100, 0};
    const ErrorBound bound = error_bound(default_model(contact), contact);
    ASSERT_EQ(pressed.recording.unknown.empty(), bound.known) << force_N;
    if (bound.known) continue;
    const UnknownContact& unknown = pressed.recording.unknown.back();
    EXPECT_EQ(unknown.why, bound.outside);
    const Prediction there = default_model(contact).predict(contact);
    EXPECT_NEAR(unknown.slope, there.a_m / 10e-3, 1e-6 * unknown.slope);
    EXPECT_NE(in_words(unknown, pressed.recording.bodies, pressed.steps).find("table – tip"),
              std::string::npos);
  }
}

TEST(UnknownErrors, NameSoftBodiesThatAreRigidPoints) {
  // A rod touches along a line.
  const Simulation pressed =
      run(pressed_ball("cylinder_radius_length_mm = [10, 20], rotation_deg = [90, 0, 0]", 2));
  ASSERT_EQ(pressed.recording.unknown.size(), 1u);
  EXPECT_EQ(pressed.recording.unknown[0].why, "");
  EXPECT_EQ(pressed.recording.unknown[0].steps, pressed.steps);
  EXPECT_NE(in_words(pressed.recording.unknown[0], pressed.recording.bodies, pressed.steps)
                .find("rigid points"),
            std::string::npos);
}

}  // namespace softfinger::simulation
