#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "fem/pad/solve_pad.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

FlatShape disc(double radius_m) {
  FlatShape shape;
  shape.radius_m = radius_m;
  return shape;
}

FlatShape rectangle(double length_x_m, double length_y_m, double corner_radius_m = 0) {
  FlatShape shape;
  shape.kind = FlatShape::Kind::rectangle;
  shape.lengths_m = {length_x_m, length_y_m};
  shape.corner_radius_m = corner_radius_m;
  return shape;
}

FlatShape polygon(std::vector<std::array<double, 2>> points_m) {
  FlatShape shape;
  shape.kind = FlatShape::Kind::polygon;
  shape.points_m = std::move(points_m);
  return shape;
}

/// A pad with h = E = P = mu = 1, so that numbers are those of the references.
PadProblem pad(const FlatShape& outline, double poisson_ratio, PadPressing pressing,
               int level = 1) {
  PadProblem problem;
  problem.outline = outline;
  problem.thickness_m = problem.youngs_modulus_Pa = problem.load_N = 1;
  problem.friction_coefficient = 1;
  problem.poisson_ratio = poisson_ratio;
  problem.pressing = pressing;
  problem.level = level;
  return problem;
}

PadResult solved(const PadProblem& problem) {
  return solve_pad(problem, [](const std::string&) {});
}

double stiffness_of(const PadResult& result) {  // k = P h / (d E A) with h = E = 1
  return result.finest.normal_stiffness_N_per_m / result.finest.area_m2;
}

double arm_ratio(const PadResult& result) {
  return result.finest.pressure_arm_m / result.uniform_arm_m;
}

double load_of(const PadPressure& pressure) {
  double sum = 0;
  for (std::size_t i = 0; i < pressure.pressure_Pa.size(); ++i)
    sum += pressure.pressure_Pa[i] * pressure.weight_m2[i];
  return sum;
}

std::string refusal_of(const PadProblem& problem) {
  try {
    solved(problem);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Without lateral strain nothing depends on the face, and pressure is uniform.
TEST(Pad, IsUniformWithoutPoissonsRatio) {
  for (const FlatShape& shape :
       {disc(1.5), rectangle(3, 1), rectangle(3, 2, 0.4), polygon({{0, 0}, {2, 0}, {0.5, 1.5}})})
    for (const PadPressing pressing : {PadPressing::frictionless, PadPressing::stuck}) {
      const PadResult result = solved(pad(shape, 0, pressing));
      // Quadratic cells leave a circle by 1e-5 of its area on this level, and the distance from the
      // centre is integrated to as much.
      constexpr double of_mesh = 2e-5;
      EXPECT_NEAR(stiffness_of(result), 1, of_mesh);
      EXPECT_NEAR(arm_ratio(result), 1, of_mesh);
      EXPECT_NEAR(result.finest.peak_pressure_Pa * result.finest.area_m2, 1, 1e-6);
      EXPECT_NEAR(load_of(result.pressure), 1, 1e-9);
    }
}

// The mid-plane of a stuck pad of 2 h is a frictionless face of a pad of h.
TEST(Pad, FrictionlessIsHalfOfStuckOfTwiceTheThickness) {
  PadProblem whole = pad(rectangle(4, 2), 0.45, PadPressing::stuck);
  PadProblem half = pad(rectangle(4, 2), 0.45, PadPressing::frictionless);
  half.thickness_m = 0.5;
  const PadResult of_whole = solved(whole), of_half = solved(half);
  const PadLevel &stuck = of_whole.finest, &frictionless = of_half.finest;
  const auto share = [](double one, double other) { return std::abs(one / other - 1); };
  EXPECT_LT(share(2 * stuck.normal_stiffness_N_per_m, frictionless.normal_stiffness_N_per_m),
            of_whole.error.normal_stiffness + of_half.error.normal_stiffness);
  for (const std::size_t i : {0, 1})
    EXPECT_LT(share(2 * stuck.free_tilt_stiffness_Nm_per_rad[i],
                    frictionless.tilt_stiffness_Nm_per_rad[i]),
              of_whole.error.free_tilt_stiffness[i] + of_half.error.tilt_stiffness[i]);
}

// Numbers of mixed finite elements on three meshes, to 1e-4: pads of R = 2 h and 4 h x 2 h, flat
// punches of R = h on a wide layer.
TEST(Pad, AgreesWithReferencesWithinItsStatedErrors) {
  struct Row {
    FlatShape shape;
    double poisson_ratio;
    PadPressing pressing;
    double stiffness, arm, tilt;
  };
  for (const Row& row :
       {Row{disc(2), 0.3, PadPressing::frictionless, 1.118576, 0.96690284, 1.0837033},
        Row{disc(2), 0.49, PadPressing::stuck, 2.6337282, 0.93170712, 1.755086},
        Row{rectangle(4, 2), 0.49, PadPressing::stuck, 1.968136, 0.96330978, 1.5540481}}) {
    const PadResult result = solved(pad(row.shape, row.poisson_ratio, row.pressing));
    EXPECT_NEAR(stiffness_of(result) / row.stiffness, 1, result.error.normal_stiffness + 1e-4);
    EXPECT_NEAR(arm_ratio(result) / row.arm, 1, result.error.pressure_arm + 1e-4);
    const double inertia_m4 =
        row.shape.kind == FlatShape::Kind::disc ? kPi * 16 / 4 : 64.0 * 2 / 12;
    const auto& tilt = row.pressing == PadPressing::stuck
                           ? result.finest.free_tilt_stiffness_Nm_per_rad
                           : result.finest.tilt_stiffness_Nm_per_rad;
    EXPECT_NEAR(tilt[1] / inertia_m4 / row.tilt, 1, result.error.tilt_stiffness[1] + 1e-4);
  }
  PadProblem punch = pad(disc(9), 0.3, PadPressing::frictionless);
  punch.face = ObjectFace{disc(1)};
  const PadResult result = solved(punch);
  EXPECT_NEAR(result.finest.normal_stiffness_N_per_m * (1 - 0.3 * 0.3) / 2 / 2.483557, 1,
              result.error.normal_stiffness);
  EXPECT_NEAR(result.finest.pressure_arm_m / 0.7501488, 1, result.error.pressure_arm);
}

TEST(Pad, ConvergesToAFinerLevelWithinItsStatedErrors) {
  const PadResult coarse = solved(pad(disc(0.5), 0.499, PadPressing::stuck, 1)),
                  fine = solved(pad(disc(0.5), 0.499, PadPressing::stuck, 2));
  EXPECT_LT(fine.error.normal_stiffness, coarse.error.normal_stiffness);
  EXPECT_NEAR(stiffness_of(coarse) / stiffness_of(fine), 1,
              coarse.error.normal_stiffness + fine.error.normal_stiffness);
  EXPECT_NEAR(arm_ratio(coarse) / arm_ratio(fine), 1,
              coarse.error.pressure_arm + fine.error.pressure_arm);
}

// A polygon has the whole meshed by other blocks than a rectangle's quarter.
TEST(Pad, PolygonThatIsARectangleAgreesWithIt) {
  const PadResult quarter = solved(pad(rectangle(3, 2), 0.45, PadPressing::stuck, 1)),
                  whole = solved(
                      pad(polygon({{1, 1}, {1, 3}, {4, 3}, {4, 1}}), 0.45, PadPressing::stuck, 1));
  EXPECT_TRUE(quarter.planes.both());
  EXPECT_FALSE(whole.planes.any());
  EXPECT_NEAR(whole.stiffness_centre_m[0], 2.5, 1e-6);
  EXPECT_NEAR(whole.stiffness_centre_m[1], 2, 1e-6);
  EXPECT_NEAR(stiffness_of(quarter) / stiffness_of(whole), 1,
              quarter.error.normal_stiffness + whole.error.normal_stiffness);
  EXPECT_NEAR(
      quarter.finest.torsional_stiffness_Nm_per_rad / whole.finest.torsional_stiffness_Nm_per_rad,
      1, quarter.error.torsional_stiffness + whole.error.torsional_stiffness);
}

// A column of springs lifts off where the load leaves the kernel of the section: beyond L/6.
TEST(Pad, LiftsOffUnderAnEccentricLoad) {
  PadProblem problem = pad(rectangle(3, 2), 0, PadPressing::frictionless);
  problem.load_point_m = {{0.45, 0}};
  EXPECT_EQ(solved(problem).lifted_share, 0);
  EXPECT_NEAR(solved(problem).finest.tilt_limit_Nm[1], 0.5, 1e-3);
  problem.load_point_m = {{0.8, 0.1}};
  const PadResult lifted = solved(problem);
  EXPECT_GT(lifted.lifted_share, 0.1);
  EXPECT_NEAR(load_of(lifted.pressure), 1, 1e-9);
  EXPECT_NEAR(lifted.centre_of_pressure_m[0], 0.8, 1e-9);
  EXPECT_NEAR(lifted.centre_of_pressure_m[1], 0.1, 1e-9);
  for (const double pressure_Pa : lifted.pressure.pressure_Pa) EXPECT_GE(pressure_Pa, 0);
}

// The quarter's four problems, put together, know the signs of all of its images.
TEST(Pad, LiftOffIsMirroredWithTheLoad) {
  PadProblem problem = pad(disc(1), 0.49, PadPressing::frictionless);
  problem.load_point_m = {{0.45, 0.2}};
  const PadResult one = solved(problem);
  problem.load_point_m = {{-0.45, -0.2}};
  const PadResult other = solved(problem);
  EXPECT_GT(one.lifted_share, 0);
  EXPECT_NEAR(one.finest.indentation_m, other.finest.indentation_m, 1e-9);
  EXPECT_NEAR(one.tilt_rad[0], -other.tilt_rad[0], 1e-9);
  EXPECT_NEAR(one.tilt_rad[1], -other.tilt_rad[1], 1e-9);
}

TEST(Pad, LimitSurfaceEndsAtTheLargestTorqueAndForce) {
  PadProblem problem = pad(rectangle(2, 1), 0.45, PadPressing::stuck);
  problem.friction_coefficient = 0.8;
  problem.load_N = 3;
  problem.limit_surface = 40;
  const PadResult result = solved(problem);
  ASSERT_EQ(result.limit_surface.size(), 40u);
  for (const Wrench& wrench : result.limit_surface) {
    EXPECT_LE(std::hypot(wrench.force_x_N, wrench.force_y_N), 0.8 * 3 * (1 + 1e-9));
    EXPECT_LE(std::abs(wrench.torque_Nm), result.finest.max_torque_Nm * (1 + 1e-2));
  }
}

// Rescaling lengths and stress changes the numbers by their units alone.
TEST(Pad, HasNoUnitsOfItsOwn) {
  PadProblem problem = pad(disc(1), 0.4, PadPressing::stuck);
  const PadLevel one = solved(problem).finest;
  problem.outline.radius_m = problem.thickness_m = 1e-3;
  problem.youngs_modulus_Pa = 2e5;
  const PadLevel other = solved(problem).finest;
  EXPECT_NEAR(other.normal_stiffness_N_per_m / (2e5 * 1e-3 * one.normal_stiffness_N_per_m), 1,
              1e-9);
  EXPECT_NEAR(other.pressure_arm_m / (1e-3 * one.pressure_arm_m), 1, 1e-9);
  EXPECT_NEAR(
      other.torsional_stiffness_Nm_per_rad / (2e5 * 1e-9 * one.torsional_stiffness_Nm_per_rad), 1,
      1e-9);
}

TEST(Pad, RefusesWhatItCannotSolveByName) {
  const auto refused = [](const PadProblem& problem, const std::string& part) {
    const std::string message = refusal_of(problem);
    EXPECT_NE(message.find(part), std::string::npos) << part << ": " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
  };
  const PadPressing frictionless = PadPressing::frictionless;
  refused(pad(polygon({{0, 0}, {2, 0}, {0.5, 0.5}, {0, 2}}), 0.3, frictionless), "not convex");
  refused(pad(polygon({{0, 0}, {2, 2}, {2, 0}, {0, 2}}), 0.3, frictionless), "convex");
  refused(pad(polygon({{0, 0}, {1, 0}, {2, 0}}), 0.3, frictionless), "no area");
  refused(pad(rectangle(2, 1, 0.6), 0.3, frictionless), "corner_radius_m = 0.6");
  refused(pad(rectangle(2, 0.1), 0.3, frictionless), "at least 0.2");
  PadProblem outside = pad(disc(1), 0.3, frictionless);
  outside.load_point_m = {{1.2, 0}};
  refused(outside, "tips");
  outside.load_point_m = {{std::nan(""), 0}};
  refused(outside, "tips");
  PadProblem pulled = pad(disc(1), 0.3, PadPressing::stuck);
  pulled.load_point_m = {{0.6, 0}};
  refused(pulled, "a frictionless one lifts off");
  PadProblem apart = pad(disc(1), 0.3, frictionless);
  apart.face = ObjectFace{disc(0.5), {3, 0}, 0};
  refused(apart, "face");
}

// Rubber around the face helps to carry it: less than a block does that is larger all over.
TEST(Pad, BearsMoreWithAFillet) {
  for (const double nu : {0.3, 0.49}) {
    PadProblem problem = pad(rectangle(4, 3), nu, PadPressing::frictionless);
    const PadResult plain = solved(problem);
    problem.edge_radius_m = 0.04;  // too small to count
    EXPECT_EQ(solved(problem).finest.normal_stiffness_N_per_m,
              plain.finest.normal_stiffness_N_per_m);
    double below = plain.finest.normal_stiffness_N_per_m, arm_below = plain.finest.eccentricity_m;
    for (const double radius : {0.1, 0.3, 0.6}) {
      problem.edge_radius_m = radius;
      const PadResult result = solved(problem);
      EXPECT_NEAR(result.finest.area_m2, 12, 1e-9);
      EXPECT_NEAR(load_of(result.pressure), 1, 1e-9);
      EXPECT_GT(result.finest.normal_stiffness_N_per_m, below);
      EXPECT_GT(result.finest.eccentricity_m, arm_below);
      below = result.finest.normal_stiffness_N_per_m;
      arm_below = result.finest.eccentricity_m;
      // A block that reaches as far out, with straight walls.
      PadProblem larger =
          pad(rectangle(4 + 2 * radius, 3 + 2 * radius, radius), nu, PadPressing::frictionless);
      larger.face = ObjectFace{rectangle(4, 3), {}, 0};
      const PadResult block = solved(larger);
      EXPECT_LT(below, block.finest.normal_stiffness_N_per_m * (1 + block.error.normal_stiffness));
      EXPECT_LT(arm_below, block.finest.eccentricity_m * (1 + block.error.eccentricity));
    }
  }
  PadProblem wrong = pad(rectangle(4, 3), 0.3, PadPressing::frictionless);
  wrong.edge_radius_m = 0.95;
  EXPECT_NE(refusal_of(wrong).find("edge_radius_m = 0.95"), std::string::npos);
}

// The edge of a box within a pad: the grid lies between the blocks around a face that stays inside,
// and those of a pad that reaches a little further on.
TEST(Pad, TakesRectanglesThatCrossItsOutline) {
  PadProblem problem = pad(rectangle(6, 4), 0.45, PadPressing::frictionless);
  problem.face = ObjectFace{rectangle(3, 40), {}, 0};
  const PadResult strip = solved(problem);
  EXPECT_NEAR(strip.finest.area_m2, 12, 1e-9);
  EXPECT_NEAR(load_of(strip.pressure), 1, 1e-9);
  PadProblem inside = problem;
  inside.face = ObjectFace{rectangle(3, 3.6), {}, 0};
  PadProblem longer = pad(rectangle(6, 4.4), 0.45, PadPressing::frictionless);
  longer.face = ObjectFace{rectangle(3, 4), {}, 0};
  const PadResult shorter = solved(inside), wider = solved(longer);
  EXPECT_LT(shorter.finest.normal_stiffness_N_per_m, strip.finest.normal_stiffness_N_per_m);
  EXPECT_LT(strip.finest.normal_stiffness_N_per_m, wider.finest.normal_stiffness_N_per_m);
  EXPECT_LT(shorter.finest.eccentricity_m, strip.finest.eccentricity_m);
  EXPECT_LT(strip.finest.eccentricity_m, wider.finest.eccentricity_m);
  // A corner of the pad is covered; the same corner by another turn of everything.
  problem.face = ObjectFace{rectangle(6, 4), {2, 1}, 0};
  const PadResult corner = solved(problem);
  EXPECT_NEAR(corner.finest.area_m2, 4 * 3, 1e-9);
  PadProblem turned = pad(rectangle(4, 6), 0.45, PadPressing::frictionless);
  turned.face = ObjectFace{rectangle(6, 4), {-1, 2}, kPi / 2};
  const PadResult other = solved(turned);
  EXPECT_NEAR(other.finest.normal_stiffness_N_per_m / corner.finest.normal_stiffness_N_per_m, 1,
              1e-8);
  EXPECT_NEAR(other.finest.eccentricity_m / corner.finest.eccentricity_m, 1, 1e-8);
  EXPECT_NEAR(other.centre_of_pressure_m[1], corner.centre_of_pressure_m[0], 1e-8);
  // Finer meshes stay within the stated errors.
  problem.level = 2;
  const PadResult finer = solved(problem);
  EXPECT_NEAR(finer.finest.normal_stiffness_N_per_m / corner.finest.normal_stiffness_N_per_m, 1,
              corner.error.normal_stiffness);
  EXPECT_NEAR(finer.finest.eccentricity_m / corner.finest.eccentricity_m, 1,
              corner.error.eccentricity);
  problem.face->angle_rad = 0.1;
  EXPECT_NE(refusal_of(problem).find("crosses the pad's"), std::string::npos);
  problem.face = ObjectFace{rectangle(6, 40), {0.02, 0}, 0};
  EXPECT_NE(refusal_of(problem).find("within 0.02 m"), std::string::npos);
}

/// A rigid object on a pad, h = E = 1, without friction.
PadProblem under_object(double length_x, double length_y, std::array<double, 2> radii,
                        double poisson_ratio, double load) {
  PadProblem problem = pad(rectangle(length_x, length_y), poisson_ratio, PadPressing::frictionless);
  problem.object = CurvedObject{radii, {}};
  problem.load_N = load;
  return problem;
}

TEST(CurvedObject, ASphereFarFromTheWallsIsThatOfALayerWithoutAnEnd) {
  const PadResult result = solved(under_object(12, 12, {5, 5}, 0.45, 1));
  // The exact layer's: circular_layer_contact_at_load (analytic).
  EXPECT_NEAR(result.finest.indentation_m / 0.174668, 1, 2e-3);
  EXPECT_NEAR(result.finest.pressure_arm_m / 0.718653, 1, 3e-3);
  EXPECT_NEAR(result.finest.normal_stiffness_N_per_m / 11.976, 1, 1e-2);
  EXPECT_NEAR(result.finest.peak_pressure_Pa / 0.335078, 1, 1e-2);
  EXPECT_NEAR(load_of(result.pressure), 1, 1e-9);
  // The stated errors cover the actual ones.
  EXPECT_LT(std::abs(result.finest.indentation_m / 0.174668 - 1), result.error.indentation);
  EXPECT_LT(std::abs(result.finest.pressure_arm_m / 0.718653 - 1), result.error.pressure_arm);
}

TEST(CurvedObject, ACylinderIsInPlaneStrainAllAlongWithoutPoissonsRatio) {
  const PadResult result = solved(under_object(6, 8, {kInfinity, 5}, 0, 1));
  // line_contact_at_load (analytic) at P' = 1/6.
  EXPECT_NEAR(result.finest.indentation_m / 0.112336, 1, 2e-3);
  EXPECT_NEAR(result.finest.normal_stiffness_N_per_m / (6 * 2.13802), 1, 1e-2);
  EXPECT_NEAR(result.finest.contact_half_lengths_m[0], 3, 1e-12);
  EXPECT_NEAR(result.finest.contact_half_lengths_m[1] / 0.8826, 1, 0.05);
  // Tilted about its middle, each piece of the line resists by itself.
  EXPECT_NEAR(result.finest.tilt_stiffness_Nm_per_rad[1] / (2.13802 * 6 * 36 / 12), 1, 2e-2);
}

TEST(CurvedObject, FreeEndsTakeLoadFromALineOfRubber) {
  // Plane strain all along would bear 9 P'; P' has this approach by line_contact (analytic).
  const double per_length = 0.2142857142857, exact_m = 0.067570;
  const PadResult result = solved(under_object(9, 8, {kInfinity, 14 / 3.0}, 0.49, 9 * per_length));
  EXPECT_GT(result.finest.indentation_m, 1.02 * exact_m);
  EXPECT_LT(result.finest.indentation_m, 1.4 * exact_m);
  EXPECT_LT(result.finest.pressure_arm_m, 9 / 4.0);
}

TEST(CurvedObject, LiesBesideTheMiddle) {
  PadProblem problem = under_object(5, 5, {4, 4}, 0.4, 0.1);
  const double centred_m = solved(problem).finest.indentation_m;
  problem.object->offset_m = {0, 1.8};
  const PadResult beside = solved(problem);
  EXPECT_GT(beside.finest.indentation_m, 1.005 * centred_m);
  EXPECT_FALSE(beside.planes.y);
  EXPECT_TRUE(beside.planes.x);
  // The pressure leaves the wall.
  EXPECT_LT(beside.centre_of_pressure_m[1], 1.8);
  EXPECT_GT(beside.centre_of_pressure_m[1], 1.6);
}

TEST(CurvedObject, RefusesWhatItDoesNotSolve) {
  const PadProblem good = under_object(5, 5, {4, 4}, 0.4, 0.1);
  const auto refuses = [&](const auto& change, const char* field) {
    PadProblem problem = good;
    change(problem);
    try {
      solved(problem);
      ADD_FAILURE() << field;
    } catch (const InputError& error) {
      EXPECT_EQ(error.field(), field);
    }
  };
  refuses([](PadProblem& p) { p.pressing = PadPressing::stuck; }, "pressing");
  refuses([](PadProblem& p) { p.outline = disc(2); }, "pad.outline.shape");
  refuses([](PadProblem& p) { p.object->radii_m = {-4, 4}; }, "object.radii_m");
  refuses([](PadProblem& p) { p.object->radii_m = {kInfinity, kInfinity}; }, "object.radii_m");
  refuses([](PadProblem& p) { p.object->offset_m = {3, 0}; }, "object.offset_m");
  refuses([](PadProblem& p) { p.load_point_m = {{0, 0}}; }, "load_point_m");
}

}  // namespace
}  // namespace softfinger::fem
