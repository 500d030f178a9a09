// The exported numbers against each simulator's published law, worked out by hand.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "comparisons/exporting/contact_curve.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/exporting/simulators/drake.h"
#include "comparisons/exporting/simulators/patch_friction.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "tests/comparisons/run_program.h"

namespace softfinger::exporting {
namespace {

/// A Hertz contact of radius a = 1 mm at P = 4 E* a³/(3 R) = 2/15 N, with E* = 1 MPa and R = 10 mm:
/// e_n = (3 pi/16) a.
constexpr double kLoad_N = 2.0 / 15, kFriction = 0.5;
const double kEccentricity_m = 3 * kPi / 16 * 1e-3;
/// dP/dd = 2 E* a.
constexpr double kHertzStiffness_N_per_m = 2 * 1e6 * 1e-3;

input::Case round_contact() {
  return input::parse_case(
      "id = \"round\"\n[geometry]\nrelative_radii_mm = [10, 10]\n"
      "[layer]\nthickness_mm = 100\nyoungs_modulus_kPa = 1000\npoisson_ratio = 0\n"
      "[contact]\nload_N = " +
          std::to_string(kLoad_N) + "\nfriction_coefficient = 0.5\n",
      "round.toml");
}

ContactCurve curve_of(const input::Case& contact_case, const char* model,
                      const LoadChoice& choice = {}) {
  return ask_contact_curve(contact_case, prediction::GeometryResolver(contact_case),
                           find_pressure_model(model), choose_loads(contact_case.loads_N, choice),
                           prediction::Demand{});
}

ContactCurve hertz_curve() { return curve_of(round_contact(), "hertz", {kLoad_N, {}}); }

double value(const Lines& lines, const std::string& name) {
  for (const auto& [known, number] : lines.values)
    if (known == name) return number;
  ADD_FAILURE() << "no value " << name;
  return 0;
}

const Simulator& mujoco() { return *find_simulator("mujoco"); }
const Simulator& bullet() { return *find_simulator("bullet"); }
const Simulator& gazebo() { return *find_simulator("gazebo"); }
const Simulator& drake() { return *find_simulator("drake"); }
const Simulator& physx() { return *find_simulator("physx"); }
const Simulator& newton() { return *find_simulator("newton"); }
const Simulator& usd() { return *find_simulator("usd"); }
const Simulator& gz_sim() { return *find_simulator("gz-sim"); }
const Simulator& genesis() { return *find_simulator("genesis"); }
const Simulator& sapien() { return *find_simulator("sapien"); }
const Simulator& isaac() { return *find_simulator("isaac"); }

Lines lines_for(const Simulator& simulator) {
  return simulator.lines(soft_contact(hertz_curve(), simulator, Fit::nominal));
}

/// Algebra on numbers of one magnitude: a few roundings.
constexpr double kRoundOff = 1e-12;

/// A pad of 10 x 10 mm, e_n = 4 mm.
SoftContact square_pad() {
  SoftContact contact;
  contact.friction_coefficient = kFriction;
  contact.load_N = 2;
  contact.eccentricity_m = 4e-3;
  contact.normal_stiffness_N_per_m = 1600;
  contact.face = PadFace{10e-3, 10e-3, 1e-4, 2e-3, 4e-3, 7.07e-3, 3.8e-3, 3.8e-3};
  contact.origin = "pad";
  return contact;
}

}  // namespace

TEST(Exporting, MujocosSpinningFrictionIsTorquePerLoad) {
  const Lines lines = lines_for(mujoco());
  EXPECT_NEAR(value(lines, "spinning_friction_m") / (0.5 * kEccentricity_m), 1, 1e-9);
  EXPECT_NE(lines.text.find("friction=\"0.5 0.000294524 0.0001\""), std::string::npos)
      << lines.text;
  EXPECT_NE(lines.text.find("condim=\"4\""), std::string::npos);
  EXPECT_NE(lines.text.find("cone=\"elliptic\""), std::string::npos);
}

TEST(Exporting, BulletsPairHasTheTorqueByItsRulesForPairs) {
  const Lines lines = lines_for(bullet());
  const double object_friction = value(lines, "object_sliding_friction");
  const double friction = value(lines, "sliding_friction");
  EXPECT_EQ(friction * object_friction, kFriction);
  // s_0 mu_1 + s_1 mu_0, the object has s_1 = 0.
  EXPECT_NEAR(value(lines, "spinning_friction_m") * object_friction / (kFriction * kEccentricity_m),
              1, 1e-9);
  EXPECT_GT(value(lines, "rolling_friction_m"), 0) << "else rigid bodies have no spinning friction";
  EXPECT_LE(value(lines, "rolling_friction_m"), 1e-3 * value(lines, "spinning_friction_m"));
}

TEST(Exporting, GazebosPatchRadiusIsThatOfARoundHertzContact) {
  const Lines lines = lines_for(gazebo());
  EXPECT_NEAR(value(lines, "patch_radius_m") / 1e-3, 1, 1e-9);
  EXPECT_EQ(value(lines, "torsional_coefficient"), kFriction);
}

TEST(Exporting, PhysxsRadiusIsTheEccentricity) {
  const Lines lines = lines_for(physx());
  EXPECT_NEAR(value(lines, "min_torsional_patch_radius_m") / kEccentricity_m, 1, 1e-9);
  EXPECT_EQ(value(lines, "torsional_patch_radius_m"), 0);
  EXPECT_NE(lines.text.find("createMaterial(0.500000f, 0.500000f, 0.0f)"), std::string::npos)
      << lines.text;
}

// rigid/collider/contact.py: the larger coefficient of the pair counts. constraint/solver.py: with
// the elliptic cone and the convex resolution, |f|²/mu² + torque²/mu_t² <= P².
TEST(Exporting, GenesissEllipsoidHasTheModelsTorque) {
  const LoadPoint nominal = hertz_curve().nominal;
  const Lines lines = lines_for(genesis());
  const double torsional_m =
      std::max(value(lines, "torsional_friction_m"), value(lines, "object_torsional_friction_m"));
  EXPECT_NEAR(torsional_m * kLoad_N / nominal.max_torque_Nm(), 1, kRoundOff);
  // Beside a force of 0.6 mu P the ellipsoid leaves 0.8 of it.
  const double force_N = 0.6 * value(lines, "sliding_friction") * kLoad_N;
  const double share = force_N / (value(lines, "sliding_friction") * kLoad_N);
  EXPECT_NEAR(torsional_m * kLoad_N * std::sqrt(1 - share * share) / nominal.max_torque_Nm(), 0.8,
              kRoundOff);
  for (const char* needed : {"enable_torsional_friction=True", "gs.friction_cone.elliptic",
                             "gs.contact_resolution.convex", "friction_torsional=0.000294524"})
    EXPECT_NE(lines.text.find(needed), std::string::npos) << lines.text;
}

// P = k D² d/((1 - D) w) with k = 1/(timeconst² D²), for 1/w = 0.25 kg.
TEST(Exporting, GenesissTimeConstantGivesTheModelsStiffness) {
  const Lines lines = lines_for(genesis());
  const double impedance = value(lines, "impedance"), mass_kg = 0.25;
  const double time_s = value(lines, "time_constant_at_1_kg_s") * std::sqrt(mass_kg);
  const double k = 1 / (time_s * time_s * impedance * impedance);
  const double stiffness_N_per_m = k * impedance * impedance / (1 - impedance) * mass_kg;
  EXPECT_NEAR(stiffness_N_per_m / hertz_curve().normal_stiffness_N_per_m, 1, kRoundOff);
}

// DyTGSContactPrep.cpp: |torque| <= mu r P, r = max(min radius, sqrt(radius penetration)). A pair's
// friction is the mean of both in SAPIEN, which sets no combine mode.
TEST(Exporting, PatchesOfPhysxHaveTheModelsTorqueAtAnyPenetration) {
  const LoadPoint nominal = hertz_curve().nominal;
  for (const Simulator* simulator : {&physx(), &sapien(), &isaac()})
    for (const double penetration_m : {-1e-3, 0.0, 1e-5, 1e-3}) {
      const Lines lines = lines_for(*simulator);
      const double radius_m =
          torsional_radius_m(value(lines, "min_torsional_patch_radius_m"),
                             value(lines, "torsional_patch_radius_m"), penetration_m);
      const double friction =
          simulator == &sapien()
              ? 0.5 * (value(lines, "sliding_friction") + value(lines, "object_sliding_friction"))
              : value(lines, "sliding_friction");
      EXPECT_NEAR(friction * radius_m * kLoad_N / nominal.max_torque_Nm(), 1, kRoundOff)
          << simulator->name;
    }
  // A radius that follows the penetration grows with its root.
  EXPECT_DOUBLE_EQ(torsional_radius_m(1e-3, 4e-3, 1e-3), 2e-3);
}

TEST(Exporting, IsaacLabHasTheSameTorqueWithNewtonAndTheModelsStiffness) {
  const Lines lines = lines_for(isaac());
  EXPECT_NEAR(
      value(lines, "newton_torsional_friction_m") * kLoad_N / hertz_curve().nominal.max_torque_Nm(),
      1, kRoundOff);
  EXPECT_NEAR(
      value(lines, "compliant_contact_stiffness_N_per_m") / hertz_curve().normal_stiffness_N_per_m,
      1, kRoundOff);
  EXPECT_LT(value(lines, "friction_correlation_distance_m"), 1e-4)
      << "beyond 0.1 mm a compliant contact has two anchors, and no torque";
  for (const char* needed :
       {"min_torsional_patch_radius=0.000589049", "condim=4", "friction_correlation_distance=1e-05",
        "compliant_contact_stiffness=2000", "torsional_friction=0.000294524"})
    EXPECT_NE(lines.text.find(needed), std::string::npos) << lines.text;
}

// bullet-featherstone/src/SDFFeatures.cc sets Bullet's spinning friction, whose rule for pairs is
// s_0 mu_1 + s_1 mu_0.
TEST(Exporting, GazeboSimsBulletHasTheTorqueByBulletsRuleForPairs) {
  const Lines lines = lines_for(gz_sim());
  const double sliding = value(lines, "bullet_sliding_friction"),
               object_sliding = value(lines, "bullet_object_sliding_friction");
  const double spinning_m = value(lines, "bullet_spinning_friction_m") * object_sliding +
                            value(lines, "bullet_object_spinning_friction_m") * sliding;
  EXPECT_NEAR(spinning_m * kLoad_N / hertz_curve().nominal.max_torque_Nm(), 1, kRoundOff);
  // The plugin also scales the friction's directions by the coefficient.
  EXPECT_NEAR(sliding * sliding * object_sliding, kFriction, kRoundOff);
  EXPECT_NE(lines.text.find("<friction>0.707107</friction>"), std::string::npos) << lines.text;
  EXPECT_NE(lines.text.find("<torsional><coefficient>0.000294524</coefficient></torsional>"),
            std::string::npos)
      << lines.text;
  EXPECT_NE(lines.text.find("<torsional><coefficient>0</coefficient></torsional>"),
            std::string::npos)
      << "an object that states no coefficient has 1 m";
  // The points of a box have their torque by their forces alone.
  EXPECT_EQ(gz_sim().box_lines(square_pad()).text.find("<coefficient>0.0"), std::string::npos);
}

TEST(Exporting, UsdWritesLengthsInTheStagesUnit) {
  SoftContact contact = square_pad();
  EXPECT_NE(usd().lines(contact).text.find("torsionalFriction = 0.002\n"), std::string::npos);
  contact.meters_per_unit = 0.01;
  const Lines point = usd().lines(contact), box = usd().box_lines(contact);
  EXPECT_NEAR(value(point, "torsional_friction_stage_units"), 0.2, kRoundOff);
  EXPECT_NEAR(value(point, "min_torsional_patch_radius_stage_units"), 0.4, kRoundOff);
  for (const char* line : {"metersPerUnit = 0.01;", "torsionalFriction = 0.2\n",
                           "minTorsionalPatchRadius = 0.4\n", "contactStiffness = 1600\n"})
    EXPECT_NE(point.text.find(line), std::string::npos) << point.text;
  // Half lengths of e_n/sqrt(2) and half the layer's thickness; N/m is mass/s², without a length.
  EXPECT_NE(box.text.find("xformOp:scale = (0.282843, 0.282843, 0.1)"), std::string::npos)
      << box.text;
  EXPECT_NE(box.text.find("contactStiffness = 400\n"), std::string::npos) << box.text;
}

TEST(Exporting, CornersOfABoxHaveThePadsTorqueAndAQuarterOfItsStiffness) {
  const SoftContact contact = square_pad();
  for (const Simulator* simulator : {&genesis(), &sapien(), &isaac()}) {
    const Lines box = simulator->box_lines(contact);
    const double corner_m =
        std::hypot(value(box, "box_half_length_x_m"), value(box, "box_half_length_y_m"));
    EXPECT_NEAR(4 * kFriction * (contact.load_N / 4) * corner_m /
                    (contact.torque_per_load_m() * contact.load_N),
                1, kRoundOff)
        << simulator->name;
  }
  EXPECT_DOUBLE_EQ(value(isaac().box_lines(contact), "compliant_contact_stiffness_N_per_m"), 400);
  const double time_s = value(genesis().box_lines(contact), "time_constant_at_1_kg_s");
  EXPECT_NEAR(1 / (time_s * time_s * 0.05), 400, 400 * kRoundOff);
}

TEST(Exporting, EveryExportNamesItsSourceAndThePlaceOfTheStiffness) {
  for (const Simulator& simulator : all_simulators()) {
    SoftContact contact = soft_contact(hertz_curve(), simulator, Fit::nominal);
    EXPECT_NE(simulator.checked_against.find_first_of("0123456789"), std::string_view::npos)
        << simulator.name << ": a version";
    const auto expect_remarks = [&](const Lines& plain, const Lines& remarked) {
      const std::string remarks = remarked.text.substr(plain.text.size());
      EXPECT_EQ(remarked.text.rfind(plain.text, 0), 0u);
      EXPECT_EQ(remarked.values, plain.values);
      EXPECT_EQ(remarks.rfind(simulator.comment.open, 0), 0u) << remarks;
      EXPECT_EQ(std::count(remarks.begin(), remarks.end(), '\n'), 2) << remarks;
      EXPECT_NE(remarks.find(simulator.checked_against), std::string::npos) << remarks;
      EXPECT_EQ(remarks.find_first_of("{}"), std::string::npos) << remarks;
    };
    expect_remarks(simulator.lines(contact), point_lines(simulator, contact));
    const std::string text = point_lines(simulator, contact).text;
    EXPECT_NE(text.find("dP/dd 2000 N/m, about the normal"), std::string::npos) << text;
    contact.torsional_stiffness_Nm_per_rad = 0;
    EXPECT_NE(point_lines(simulator, contact).text.find("dP/dd 2000 N/m; it"), std::string::npos);
    contact.face = square_pad().face;
    expect_remarks(simulator.box_lines(contact), box_lines(simulator, contact));
  }
}

TEST(Exporting, TheStiffnessAboutTheNormalIsThatOfAStuckCircle) {
  // 16/3 G a³ on a half space (Mindlin 1949), G = E/2; a layer of 100 a changes less than the
  // table.
  const double G_Pa = 1e6 / 2, a_m = 1e-3;
  EXPECT_NEAR(hertz_curve().torsional_stiffness_Nm_per_rad / (16.0 / 3 * G_Pa * a_m * a_m * a_m), 1,
              1e-3);
}

TEST(Exporting, FindsSimulatorsByEitherSpelling) {
  EXPECT_EQ(find_simulator("gz_sim"), &gz_sim());
  EXPECT_EQ(find_simulator("isaac-lab"), &isaac());
  EXPECT_EQ(find_simulator("isaac_lab"), &isaac());
  EXPECT_EQ(find_simulator(""), nullptr);
  EXPECT_EQ(find_simulator("isaacs"), nullptr);
}

TEST(Exporting, DrakesModulusGivesTheTorqueWhenItsPressureIsIntegrated) {
  const RelativeRadii radii{0.02, 0.005, 0};
  const double load_N = 3, eccentricity_m = 1.7e-3;
  const Foundation foundation = foundation_with_eccentricity(radii, load_N, eccentricity_m);
  // Midpoint rule in elliptic coordinates x = a r cos t, y = b r sin t over p = K depth.
  double force_N = 0, arm_Nm = 0;
  const int kRings = 2000, kSpokes = 400;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kSpokes; ++j) {
      const double r = (i + 0.5) / kRings, t = 2 * kPi * (j + 0.5) / kSpokes;
      const double x = foundation.a_m * r * std::cos(t), y = foundation.b_m * r * std::sin(t);
      const double depth =
          foundation.indentation_m - x * x / (2 * radii.major_m) - y * y / (2 * radii.minor_m);
      const double area = foundation.a_m * foundation.b_m * r / kRings * 2 * kPi / kSpokes;
      EXPECT_GE(depth, -1e-12);
      force_N += foundation.stiffness_Pa_per_m * depth * area;
      arm_Nm += foundation.stiffness_Pa_per_m * depth * area * std::hypot(x, y);
    }
  const double rule = 1.0 / kRings / kRings;  // the midpoint rule's error
  EXPECT_NEAR(force_N / load_N, 1, 5 * rule);
  EXPECT_NEAR(arm_Nm / load_N / eccentricity_m, 1, 5 * rule);
}

TEST(Exporting, DrakesEllipsoidHasTheGapsRadiiAndItsModulusTheStiffness) {
  // Round: a = 8/15 e_n, d = a²/(2R), K = P/(pi R d²), depth R.
  const Lines lines = lines_for(drake());
  const double a_m = 15.0 / 8 * kEccentricity_m, d_m = a_m * a_m / 0.02;
  const double stiffness = kLoad_N / (kPi * 0.01 * d_m * d_m);
  EXPECT_NEAR(value(lines, "hydroelastic_modulus_Pa") / (stiffness * 0.01), 1, 1e-8);
  EXPECT_NEAR(value(lines, "indentation_m") / d_m, 1, 1e-8);
  EXPECT_NE(lines.text.find("<radii>0.01 0.01 0.01</radii>"), std::string::npos) << lines.text;
}

TEST(Exporting, NewtonsNumbersAreMujocosAndTwoFoundations) {
  const Lines lines = lines_for(newton());
  EXPECT_NEAR(value(lines, "torsional_friction_m") / (0.5 * kEccentricity_m), 1, 1e-9);
  EXPECT_NEAR(value(lines, "contact_stiffness_N_per_m") / kHertzStiffness_N_per_m, 1, 1e-9);
  // kh for the torque: a = 15/8 e_n, d = a²/(2R), kh = P/(pi R d²).
  const double a_m = 15.0 / 8 * kEccentricity_m, d_m = a_m * a_m / 0.02;
  EXPECT_NEAR(value(lines, "kh_for_torque_N_per_m3") / (kLoad_N / (kPi * 0.01 * d_m * d_m)), 1,
              1e-9);
  // For Hertz' approach a²/R = 1e-4 m the foundation's a is sqrt(2) times Hertz'.
  EXPECT_NEAR(value(lines, "kh_for_indentation_N_per_m3") / (kLoad_N / (kPi * 0.01 * 1e-8)), 1,
              1e-9);
  EXPECT_NEAR(value(lines, "kh_for_indentation_eccentricity_m") / (8.0 / 15 * std::sqrt(2) * 1e-3),
              1, 1e-9);
}

TEST(Exporting, UsdHasTheTorqueAsALength) {
  const Lines lines = lines_for(usd());
  EXPECT_NEAR(value(lines, "torsional_friction_m") / (0.5 * kEccentricity_m), 1, 1e-9);
  EXPECT_NE(lines.text.find("float newton:torsionalFriction = 0.000294524\n"), std::string::npos)
      << lines.text;
}

TEST(Exporting, GazeboSimsDefaultEngineHasNoTorqueWhichIsAnErrorOfAllOfIt) {
  const ContactCurve curve = hertz_curve();
  const SoftContact contact = soft_contact(curve, gz_sim(), Fit::nominal);
  for (const double error : relative_errors(gz_sim(), contact, curve)) EXPECT_EQ(error, -1);
  // Three points that share the load: DART's friction pyramids give them 7.7 to 11.5 % more.
  EXPECT_NEAR(value(lines_for(gz_sim()), "three_points_radius_m") / kEccentricity_m, 0.9121, 1e-4);
}

TEST(Exporting, TheNormalStiffnessIsTheSlopeOfTheModel) {
  EXPECT_NEAR(hertz_curve().normal_stiffness_N_per_m / kHertzStiffness_N_per_m, 1, 1e-9);
  // Winkler: P ~ d², so that dP/dd = 2 P/d; Drake's foundation is one.
  const ContactCurve winkler = curve_of(round_contact(), "winkler");
  const double expected = 2 * winkler.nominal.load_N / winkler.nominal.indentation_m;
  EXPECT_NEAR(winkler.normal_stiffness_N_per_m / expected, 1, 1e-9);
  EXPECT_NEAR(value(drake().lines(soft_contact(winkler, drake(), Fit::nominal)),
                    "foundation_normal_stiffness_N_per_m") /
                  expected,
              1, 1e-9);
}

TEST(Exporting, MeasuresTheLoadsExponent) {
  EXPECT_NEAR(hertz_curve().load_exponent, 1.0 / 3, 1e-9);
  EXPECT_NEAR(curve_of(round_contact(), "winkler").load_exponent, 1.0 / 4, 1e-9);
  const double between = curve_of(round_contact(), "bonded_layer").load_exponent;
  EXPECT_GT(between, 0.24);
  EXPECT_LT(between, 0.34);
}

TEST(Exporting, AConstantIsWrongByThePowerOfTheLoad) {
  const ContactCurve curve = hertz_curve();
  const auto errors = relative_errors(mujoco(), soft_contact(curve, mujoco(), Fit::nominal), curve);
  // From P/3 to 3P, e_n ~ P^(1/3).
  EXPECT_NEAR(errors.front(), std::cbrt(3.0) - 1, 1e-9);
  EXPECT_NEAR(errors.back(), 1 / std::cbrt(3.0) - 1, 1e-9);
  const auto best = relative_errors(mujoco(), soft_contact(curve, mujoco(), Fit::range), curve);
  const double worst = std::tanh(std::log(3.0) / 3);  // (q - 1/q)/(q + 1/q), q = 3^(1/3)
  EXPECT_NEAR(best.front(), worst, 1e-9);
  EXPECT_NEAR(best.back(), -worst, 1e-9);
}

TEST(Exporting, TheBestConstantIsOffByTheSameAtBothEnds) {
  const BestConstant best = best_constant(1, 3);
  EXPECT_DOUBLE_EQ(best.value, 1.5);
  EXPECT_DOUBLE_EQ(best.worst_error, 0.5);
  EXPECT_NEAR(best.value / 1 - 1, best.worst_error, 1e-15);
  EXPECT_NEAR(1 - best.value / 3, best.worst_error, 1e-15);
  EXPECT_DOUBLE_EQ(best_constant(2, 2).value, 2);
  EXPECT_DOUBLE_EQ(best_constant(2, 2).worst_error, 0);
}

TEST(Exporting, DrakeFollowsAWinklerContactExactly) {
  const ContactCurve curve = curve_of(round_contact(), "winkler");
  for (const Fit fit : {Fit::nominal, Fit::range})
    for (const double error : relative_errors(drake(), soft_contact(curve, drake(), fit), curve))
      EXPECT_NEAR(error, 0, 1e-9);
}

// Constant stress on a Hertz circle: F/P ~ P^(-1/3), T/P does not depend on the load at all.
TEST(Exporting, ConstantShearStressOnHertzHasAConstantTorquePerLoadAndAFallingForce) {
  std::string text = round_contact().text;
  const std::string friction = "friction_coefficient = 0.5";
  text.replace(text.find(friction), friction.size(),
               "shear_law = \"shear_strength\"\nshear_strength_kPa = 20");
  const input::Case contact_case = input::parse_case(text, "round.toml");
  const ContactCurve curve =
      curve_of(contact_case, "hertz", {kLoad_N, std::vector<double>{kLoad_N / 8, kLoad_N * 8}});
  EXPECT_NEAR(curve.nominal.max_force_N() / (kPi * 1e-6 * 2e4), 1, 1e-9);
  EXPECT_NEAR(curve.nominal.max_torque_Nm() / (2 * kPi / 3 * 1e-9 * 2e4), 1, 1e-9);
  EXPECT_NEAR(curve.load_exponent, 1.0 / 3, 1e-9);
  EXPECT_NEAR(curve.friction_exponent, -1.0 / 3, 1e-9);
  for (const Fit fit : {Fit::nominal, Fit::range}) {
    const SoftContact contact = soft_contact(curve, mujoco(), fit);
    for (const double error : relative_errors(mujoco(), contact, curve))
      EXPECT_NEAR(error, 0, 1e-9);
    const std::vector<double> forces = relative_force_errors(contact, curve);
    // From 8 times lighter to 8 times heavier, F/P falls from twice to half of the nominal one.
    EXPECT_NEAR(forces.front(), fit == Fit::nominal ? -0.5 : -0.6, 1e-9);
    EXPECT_NEAR(forces.back(), fit == Fit::nominal ? 1 : 0.6, 1e-9);
  }
}

TEST(Exporting, MujocoRaisesSmallValues) {
  SoftContact contact;
  contact.friction_coefficient = 0.5;
  contact.load_N = 1;
  contact.eccentricity_m = 1e-6;
  EXPECT_DOUBLE_EQ(eccentricity_in_simulator_m(mujoco(), contact, 1), 2e-5);
  EXPECT_DOUBLE_EQ(eccentricity_in_simulator_m(bullet(), contact, 1), 1e-6);
}

TEST(Exporting, ChoosesTheMiddleLoadAndTheRange) {
  const auto expect_loads = [](const LoadRange& loads, double low, double nominal, double high) {
    EXPECT_DOUBLE_EQ(loads.lowest_N, low);
    EXPECT_DOUBLE_EQ(loads.nominal_N, nominal);
    EXPECT_DOUBLE_EQ(loads.highest_N, high);
  };
  const std::vector<double> range = {2, 8};
  expect_loads(choose_loads({10, 0.5, 2}, {}), 0.5, 2, 10);
  expect_loads(choose_loads({1, 4}, {}), 1, 2, 4);
  expect_loads(choose_loads({3}, {}), 1, 3, 9);
  expect_loads(choose_loads({3}, {6.0, {}}), 2, 6, 18);
  expect_loads(choose_loads({1, 2, 3}, {6.0, {}}), 1, 6, 6);
  expect_loads(choose_loads({3}, {{}, range}), 2, 3, 8);
  expect_loads(choose_loads({1}, {{}, range}), 2, 4, 8);
  EXPECT_THROW(choose_loads({1}, {9.0, range}), InputError);
  EXPECT_THROW(choose_loads({1}, {-1.0, {}}), InputError);
  EXPECT_THROW(choose_loads({1}, {NAN, {}}), InputError);
  for (const std::vector<double>& bad :
       {std::vector<double>{8, 2}, {2, 2}, {2}, {0, 2}, {1, INFINITY}, {NAN, 2}, {1, 2, 3}})
    EXPECT_THROW(choose_loads({1}, {{}, bad}), InputError);
}

TEST(Exporting, TheTableHasBothEndsAndTheNominalLoadOnce) {
  const ContactCurve curve = curve_of(round_contact(), "hertz", {2.0, std::vector<double>{2, 5}});
  EXPECT_EQ(curve.points.front().load_N, 2);
  EXPECT_EQ(curve.points.back().load_N, 5);
  for (std::size_t i = 1; i < curve.points.size(); ++i)
    EXPECT_LT(curve.points[i - 1].load_N, curve.points[i].load_N);
}

TEST(Exporting, NamesDoNotEndAnXmlComment) {
  input::Case contact_case = round_contact();
  contact_case.id = "a---b--";
  const ContactCurve curve = curve_of(contact_case, "hertz");
  for (const Simulator& simulator : {mujoco(), gazebo(), gz_sim(), drake()}) {
    const std::string text =
        point_lines(simulator, soft_contact(curve, simulator, Fit::range)).text;
    std::size_t comments = 0;
    for (std::size_t start = text.find("<!--"); start != std::string::npos;
         start = text.find("<!--", start + 4), ++comments) {
      const std::size_t end = text.find("-->", start);
      EXPECT_EQ(text.substr(start + 4, end - start - 4).find("--"), std::string::npos) << text;
    }
    EXPECT_GE(comments, 3u) << text;
  }
}

}  // namespace softfinger::exporting
