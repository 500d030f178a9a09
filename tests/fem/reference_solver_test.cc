#include "fem/program/reference_solver.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "fem/linear/model_cache.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

const Progress quiet = [](const std::string&) {};

/// Published or independently computed answers for a rigid paraboloid on a bonded layer, from the
/// integral equation of the axisymmetric layer (relative 1e-8): s = a/h, P R/(E* a³), d R/a²,
/// torque/(mu P a).
struct CircularLayer {
  double nu, s, load, approach, torque;
};
constexpr CircularLayer circular_layers[] = {
    {0.3, 0.1, 1.334034453628609, 0.9421665312728182, 0.5890483916744661},
    {0.3, 1, 1.6786246034995, 0.647622319927407, 0.5837357455760828},
    {0.3, 20, 19.71731504372716, 0.506293310575086, 0.5368029653983252},
    {0.3, 5, 5.312512985441616, 0.5270904137743812, 0.5484496662813931},
    {0.45, 0.5, 1.4250498728312297, 0.7197071451791668, 0.5884053456945273},
    {0.45, 2, 3.0344837727895513, 0.5098806195754721, 0.5623185941390921},
};

struct Expected {
  double a_m, indentation_m, max_torque_Nm;
};

Problem circular_problem(const CircularLayer& layer, Expected& expected) {
  const double h = 2e-3, E = 3e5, mu = 0.7;
  const double modulus = E / (1 - layer.nu * layer.nu), a = layer.s * h, R = 60 * a;
  const double load = layer.load * modulus * a * a * a / R;
  expected = {a, layer.approach * a * a / R, mu * load * a * layer.torque};
  Problem problem;
  problem.contact = {{R, R, 0}, {h, E, layer.nu}, {load, mu}};
  return problem;
}

/// Asserts that the true error lies inside the stated one, and prints both: this is the accuracy
/// table of docs/measurements/finite_elements.md.
void expect_inside(double value, double truth, double stated, const char* what) {
  std::printf("  %-8s error %+8.4f %%   stated %7.4f %%\n", what, 100 * (value / truth - 1),
              100 * stated);
  EXPECT_NEAR(value / truth, 1, stated) << what;
}

class CircularLayerTest : public testing::TestWithParam<CircularLayer> {};

TEST_P(CircularLayerTest, AgreesWithTheIntegralEquationInsideItsStatedError) {
  Expected expected{};
  const Result result = solve(circular_problem(GetParam(), expected), quiet);
  std::printf("  nu %.2f, a/h %.2f: %ld unknowns, %.1f s, %.0f MB\n", GetParam().nu, GetParam().s,
              result.finest.unknowns, result.wall_s, result.peak_memory_MB);
  expect_inside(result.finest.a_m, expected.a_m, result.error.a, "a");
  expect_inside(result.finest.b_m, expected.a_m, result.error.b, "b");
  expect_inside(result.finest.indentation_m, expected.indentation_m, result.error.indentation, "d");
  expect_inside(result.finest.max_torque_Nm, expected.max_torque_Nm, result.error.max_torque,
                "torque");
  // A stated error that excuses everything would be worth nothing.
  EXPECT_LT(result.error.a, 1e-2);
  EXPECT_LT(result.error.indentation, 2e-3);
  EXPECT_LT(result.error.max_torque, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Reference, CircularLayerTest, testing::ValuesIn(circular_layers),
                         [](const auto& test) {
                           return "Nu" + std::to_string(std::lround(100 * test.param.nu)) + "S" +
                                  std::to_string(std::lround(100 * test.param.s));
                         });

TEST(ReferenceSolver, AgreesWithTheSpectralSolutionOfAnEllipticContact) {
  // nu = 0.3, R'/R'' = 5, units h = E* = sqrt(R'R'') = mu = 1: load, approach, a, b, torque (1e-4).
  const double nu = 0.3, load = 7.085952539084279, approach = 1.3470837151797446;
  const double a = 2.317539048781546, b = 0.948360340848445, torque = 6.911504668711859;
  const double h = 2e-3, E = 3e5, R = 0.1, mu = 0.7, modulus = E / (1 - nu * nu);
  Problem problem;
  problem.contact = {
      {R * std::sqrt(5), R / std::sqrt(5), 0}, {h, E, nu}, {load * modulus * h * h * h / R, mu}};
  const Result result = solve(problem, quiet);
  const double reference = 1e-4;
  expect_inside(result.finest.a_m, a * h, result.error.a + reference, "a");
  expect_inside(result.finest.b_m, b * h, result.error.b + reference, "b");
  expect_inside(result.finest.indentation_m, approach * h * h / R,
                result.error.indentation + reference, "d");
  expect_inside(result.finest.max_torque_Nm, torque * mu * modulus * std::pow(h, 4) / R,
                result.error.max_torque + reference, "torque");
}

TEST(ReferenceSolver, ApproachesHertzOnAThickLayer) {
  const double E = 1e6, nu = 0.3, R = 0.02, h = 0.1, P = 0.05, mu = 0.5;
  Problem problem;
  problem.contact = {{R, R, 0}, {h, E, nu}, {P, mu}};
  const Result result = solve(problem, quiet);
  const double a = std::cbrt(3 * P * R * (1 - nu * nu) / (4 * E));
  // A layer's a differs from the half-space's in the third order of a/h, its d in the first: not
  // compared.
  const double layer = std::pow(a / h, 3);
  EXPECT_LT(layer, 1e-4);
  expect_inside(result.finest.a_m, a, result.error.a + layer, "a");
  expect_inside(result.finest.peak_pressure_Pa, 1.5 * P / (M_PI * a * a),
                result.error.peak_pressure + layer, "p0");
  expect_inside(result.finest.max_torque_Nm, 3 * M_PI / 16 * mu * P * a,
                result.error.max_torque + layer, "torque");
  EXPECT_NEAR(result.pressure_exponent, 0.5,
              1.5 * (2 * result.error.a + result.error.peak_pressure));
}

TEST(ReferenceSolver, DoesNotLockNearIncompressibility) {
  // Same integral equation, at nu = 1/2 exactly.
  Expected expected{};
  const CircularLayer limit{0.5, 1, 1.8806668991706834, 0.5594154855629028, 0.5808313775752972};
  const Result result = solve(circular_problem(limit, expected), quiet);
  expect_inside(result.finest.indentation_m, expected.indentation_m, result.error.indentation, "d");
  expect_inside(result.finest.max_torque_Nm, expected.max_torque_Nm, result.error.max_torque,
                "torque");
  expect_inside(result.finest.a_m, expected.a_m, result.error.a, "a");
}

TEST(ReferenceSolver, AnswersWideContactsOfThinIncompressibleLayers) {
  // A bonded film under a smooth object squeezes out like a viscous one: h³ lap p = -3 G (d -
  // r²/2R), with p and its slope zero at the edge. Then P = pi G a⁶ / (32 R h³), d = a²/(4 R).
  const double h = 1e-3, E = 3e5, R = 1, G = E / 3;
  for (const double s : {35.0, 45.0}) {
    const double a = s * h, load = M_PI * G * std::pow(a, 6) / (32 * R * h * h * h);
    Problem problem;
    problem.level = 1;
    problem.contact = {{R, R, 0}, {h, E, 0.5}, {load, 0.5}};
    const Result result = solve(problem, quiet);
    // The film's edge is not known to better than the thickness.
    EXPECT_NEAR(result.finest.a_m / a, 1, 1.2 / s + result.error.a);
    EXPECT_NEAR(result.finest.indentation_m / (a * a / (4 * R)), 1, 1.2 / s);
  }
}

TEST(ReferenceSolver, GivesFrictionTheRoomItMovesTheContactTo) {
  // Shear moves the pressure of a thin incompressible layer by more than the usual patch holds.
  Problem problem;
  problem.level = 1;
  problem.friction.limit_surface = 6;
  problem.contact = {{0.2, 0.03, 0}, {2e-3, 3e5, 0.499}, {80, 0.8}};
  bool moved = false;
  const Result result = solve(problem, [&](const std::string& line) {
    moved = moved || line.find("times the room") != std::string::npos;
  });
  EXPECT_TRUE(moved);
  ASSERT_EQ(result.limit_surface.size(), 6u);
  const double limit = 0.8 * 80;
  for (const LimitPoint& point : result.limit_surface)
    EXPECT_LE(std::hypot(point.wrench.force_x_N, point.wrench.force_y_N), limit * (1 + 1e-6));
}

TEST(ReferenceSolver, TellsTheAreaOnTheObjectsSlope) {
  // A spherical cap of radius a is 2 pi R (R - sqrt(R² - a²)) large.
  Problem problem;
  problem.level = 1;
  const double R = 8e-3;
  problem.contact = {{R, R, 0}, {2e-3, 3e5, 0.3}, {3, 0.8}};
  problem.sphere_radius_m = R;
  const LevelResult found = solve(problem, quiet).finest;
  const double square = found.area_projected_m2 / M_PI;
  const double cap = 2 * M_PI * R * (R - std::sqrt(R * R - square));
  EXPECT_GT(cap, 1.02 * found.area_projected_m2);
  // Nodes make no perfect circle; the quadrature is exact up to slopes cubed.
  EXPECT_NEAR(found.area_m2 / cap, 1, 1e-3);
}

TEST(ReferenceSolver, IsIndifferentToUnits) {
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.02, 0.01, 0}, {2e-3, 3e5, 0.4}, {1, 0.8}};
  const Result plain = solve(problem, quiet);
  for (const double length : {1e-3, 1e3})
    for (const double stress : {1e-3, 1e3}) {
      Problem scaled = problem;
      scaled.contact.radii = {0.02 * length, 0.01 * length, 0};
      scaled.contact.layer = {2e-3 * length, 3e5 * stress, 0.4};
      scaled.contact.load.normal_force_N = stress * length * length;
      const Result result = solve(scaled, quiet);
      // Round-off of the scaling, amplified by the stiffness's condition (about 1e4).
      const double tolerance = 1e-9;
      EXPECT_NEAR(result.finest.a_m / (length * plain.finest.a_m), 1, tolerance);
      EXPECT_NEAR(result.finest.indentation_m / (length * plain.finest.indentation_m), 1,
                  tolerance);
      EXPECT_NEAR(
          result.finest.max_torque_Nm / (stress * std::pow(length, 3) * plain.finest.max_torque_Nm),
          1, tolerance);
    }
}

TEST(ReferenceSolver, BalancesTheLoadAndIsComplementary) {
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.03, 0.005, 0}, {3e-3, 3e5, 0.49}, {3, 0.8}};
  const Result result = solve(problem, quiet);
  for (const auto& level : result.levels) {
    EXPECT_LT(level.load_residual, 1e-12);
    EXPECT_LT(level.complementarity_residual, 1e-10);
  }
  EXPECT_GT(result.finest.a_m, result.finest.b_m);
}

TEST(ReferenceSolver, TakesTheExactSphere) {
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.01, 0.01, 0}, {3e-3, 3e5, 0.4}, {3, 0.8}};
  const Result paraboloid = solve(problem, quiet);
  problem.sphere_radius_m = 0.01;
  const Result sphere = solve(problem, quiet);
  // The sphere's gap exceeds the paraboloid's by r⁴/(8 R³): less contact, a relative change of
  // order a²/R².
  const double slope2 = std::pow(paraboloid.finest.a_m / 0.01, 2);
  EXPECT_GT(sphere.finest.indentation_m, paraboloid.finest.indentation_m);
  EXPECT_LT(sphere.finest.a_m, paraboloid.finest.a_m);
  EXPECT_GT(sphere.finest.a_m, paraboloid.finest.a_m * (1 - slope2));
}

TEST(ReferenceSolver, LoadAndApproachAreTwoWaysToTheSameContact) {
  Problem by_load;
  by_load.level = 1;
  by_load.contact = {{0.03, 0.01, 0}, {2e-3, 3e5, 0.45}, {1, 0.8}};
  const Result loaded = solve(by_load, quiet);
  Problem by_approach = by_load;
  by_approach.contact.load.normal_force_N = 0;
  by_approach.approach_m = loaded.finest.indentation_m;
  const Result approached = solve(by_approach, quiet);
  // Their trial meshes differ, and so may the final ones, by less than the stated errors.
  EXPECT_NEAR(approached.finest.load_N, 1, loaded.error.indentation * 2 + approached.error.load);
  EXPECT_NEAR(approached.finest.a_m / loaded.finest.a_m, 1, loaded.error.a + approached.error.a);
  EXPECT_NEAR(approached.finest.max_torque_Nm / loaded.finest.max_torque_Nm, 1,
              2 * loaded.error.max_torque + approached.error.max_torque);
  EXPECT_EQ(approached.finest.indentation_m, by_approach.approach_m);
  EXPECT_EQ(approached.error.indentation, 0);
  EXPECT_GT(approached.error.load, 0);
}

class SharedMeshes : public testing::Test {
 protected:
  SharedMeshes() {
    problem.level = 1;
    problem.contact = {{0.02, 0.02, 0}, {2e-3, 3e5, 0.4}, {1, 0.8}};
  }
  Result solve_in_run(const Problem& one) {
    return solve(
        one, quiet, [] { return false; }, &models);
  }
  Problem problem;
  ModelCache models;
};

TEST_F(SharedMeshes, ServeContactsOfOneSizeAsIfTheyWereTheirOwn) {
  const Result alone = solve(problem, quiet), first = solve_in_run(problem);
  EXPECT_EQ(models.hits(), 0);
  EXPECT_EQ(first.finest.a_m, alone.finest.a_m);
  Problem stiffer = problem;  // by a power of two: not a bit of the scaled problem changes
  stiffer.contact.layer.youngs_modulus_Pa *= 4;
  stiffer.contact.load.normal_force_N *= 4;
  stiffer.contact.load.friction_coefficient = 0.2;
  const Result second = solve_in_run(stiffer);
  EXPECT_EQ(models.hits(), 1);
  EXPECT_EQ(second.finest.a_m, first.finest.a_m);
  EXPECT_EQ(second.error.a, first.error.a);
  EXPECT_NEAR(second.finest.max_torque_Nm, first.finest.max_torque_Nm,
              1e-12 * first.finest.max_torque_Nm);
}

TEST_F(SharedMeshes, ServeTwistsOfAnyFrictionCoefficient) {
  problem.friction.torsion = true;
  problem.friction.increments = 4;
  const Result first = solve_in_run(problem);
  Problem slippery = problem;
  slippery.contact.load.friction_coefficient = 0.25 * problem.contact.load.friction_coefficient;
  const Result shared = solve_in_run(slippery), own = solve(slippery, quiet);
  EXPECT_EQ(models.hits(), 1);
  // Settled to 1e-6 of the load, on two levels, from compliances of other round-off.
  EXPECT_NEAR(shared.torsion->full_slip_Nm / own.torsion->full_slip_Nm, 1, 1e-5);
  EXPECT_NEAR(shared.torsion->stiffness_Nm_per_rad / own.torsion->stiffness_Nm_per_rad, 1, 1e-8);
  EXPECT_NEAR(shared.torsion->stiffness_Nm_per_rad / first.torsion->stiffness_Nm_per_rad, 1, 1e-8)
      << "the stuck contact knows no coefficient";
}

TEST_F(SharedMeshes, ServeOtherContactsInsideTheirStatedErrors) {
  problem.level = 2;
  solve_in_run(problem);
  for (const double load_N : {0.85, 0.7}) {
    Problem smaller = problem;
    smaller.contact.load.normal_force_N = load_N;
    smaller.contact.radii = {0.02, 0.019, 0};
    const int before = models.hits();
    const Result shared = solve_in_run(smaller);
    if (models.hits() == before) continue;  // the error that it would have stated was too large
    EXPECT_GT(shared.finest.oversize, 1.02);
    EXPECT_GT(shared.error.a, 2.5e-3) << "the edge across cells";
    const Result alone = solve(smaller, quiet);
    EXPECT_EQ(alone.finest.oversize, 1);
    const auto agree = [&](double LevelResult::*quantity, double RelativeError::*error) {
      EXPECT_NEAR(shared.finest.*quantity / (alone.finest.*quantity), 1,
                  shared.error.*error + alone.error.*error);
    };
    agree(&LevelResult::a_m, &RelativeError::a);
    agree(&LevelResult::b_m, &RelativeError::b);
    agree(&LevelResult::indentation_m, &RelativeError::indentation);
    agree(&LevelResult::max_torque_Nm, &RelativeError::max_torque);
    agree(&LevelResult::peak_pressure_Pa, &RelativeError::peak_pressure);
  }
  EXPECT_GE(models.hits(), 1);
}

TEST_F(SharedMeshes, DoNotServeWhatTheyDoNotSuit) {
  solve_in_run(problem);
  const auto needs_its_own = [&](const Problem& other) {
    const Result shared = solve_in_run(other), alone = solve(other, quiet);
    EXPECT_EQ(models.hits(), 0);
    EXPECT_EQ(shared.finest.a_m, alone.finest.a_m);
  };
  Problem other = problem;
  other.contact.radii = {0.1, 0.1, 0};  // too large for the patch
  needs_its_own(other);
  other = problem;
  other.contact.load.normal_force_N = 0.05;  // too small for the cells
  needs_its_own(other);
  other = problem;
  other.contact.layer.poisson_ratio = 0.3;
  needs_its_own(other);
  other = problem;
  other.contact.layer.thickness_m *= 4;  // too small against the layer
  needs_its_own(other);
  other = problem;
  other.contact.radii = {0.08, 0.005, 0};  // longer and narrower
  needs_its_own(other);
}

TEST_F(SharedMeshes, WithFrictionServeContactsOfOneSizeOnly) {
  problem.friction.torsion = true;
  problem.friction.increments = 2;
  const Result first = solve_in_run(problem);
  Problem rougher = problem;
  rougher.contact.load.friction_coefficient *= 2;
  const Result second = solve_in_run(rougher);
  EXPECT_EQ(models.hits(), 1);
  EXPECT_EQ(second.torsion->stiffness_Nm_per_rad, first.torsion->stiffness_Nm_per_rad);
  Problem smaller = problem;
  smaller.contact.load.normal_force_N = 0.7;
  EXPECT_EQ(solve_in_run(smaller).torsion->stiffness_Nm_per_rad,
            solve(smaller, quiet).torsion->stiffness_Nm_per_rad);
  EXPECT_EQ(models.hits(), 1);
}

TEST(ReferenceSolver, ReportsProgress) {
  Problem problem;
  problem.level = 1;
  problem.contact = {{0.02, 0.02, 0}, {2e-3, 3e5, 0.4}, {1, 0.8}};
  int lines = 0;
  solve(problem, [&](const std::string& line) { lines += !line.empty(); });
  EXPECT_GE(lines, 3);
}

TEST(ReferenceSolver, TellsTheLoadThatPressesALayerThrough) {
  Problem problem;
  problem.contact = {{0.02, 0.01, 0}, {1e-3, 1e5, 0.3}, {8, 0.8}};
  double largest_N = 0;
  try {
    solve(problem, quiet);
  } catch (const InputError& error) {
    const std::string text = error.what(), before = "about ";
    ASSERT_NE(text.find(before), std::string::npos) << text;
    largest_N = std::stod(text.substr(text.find(before) + before.size()));
    EXPECT_NE(text.find("or finite strain"), std::string::npos) << text;
  }
  ASSERT_GT(largest_N, 0);
  // The message states two digits.
  const double rounding = 0.05;
  problem.contact.load.normal_force_N = largest_N * (1 - rounding);
  const double indentation_m = solve(problem, quiet).finest.indentation_m;
  EXPECT_LT(indentation_m, problem.contact.layer.thickness_m);
  // In a thin layer d grows at most as the load.
  EXPECT_GT(indentation_m, (1 - 2 * rounding) * problem.contact.layer.thickness_m);
  problem.contact.load.normal_force_N = largest_N * (1 + rounding);
  EXPECT_THROW(solve(problem, quiet), InputError);
  // Loads that small strain refuses are answered at finite strain.
  problem.contact.load.normal_force_N = 8;
  problem.finite_strain = MaterialChoice();
  EXPECT_LT(solve(problem, quiet).finest.indentation_m, problem.contact.layer.thickness_m);
}

TEST(ReferenceSolver, RefusesWhatItCannotAnswer) {
  Problem good;
  good.contact = {{0.02, 0.02, 0}, {2e-3, 3e5, 0.4}, {1, 0.8}};
  const auto refuses = [&](auto change) {
    Problem bad = good;
    change(bad);
    EXPECT_THROW(solve(bad, quiet), InputError);
  };
  refuses([](Problem& p) { p.contact.layer.poisson_ratio = 0.51; });
  refuses([](Problem& p) { p.contact.layer.poisson_ratio = -0.1; });
  refuses([](Problem& p) { p.contact.load.normal_force_N = 0; });
  refuses([](Problem& p) { p.contact.load.normal_force_N = NAN; });
  refuses([](Problem& p) { p.contact.load.friction_coefficient = -1; });
  refuses([](Problem& p) { p.contact.radii.minor_m = 0.03; });
  refuses([](Problem& p) { p.contact.radii.major_m = INFINITY; });
  refuses([](Problem& p) { p.contact.radii.major_m = 100; });
  refuses([](Problem& p) { p.level = 0; });
  // So large a load that linear elasticity would press the indenter through the layer.
  refuses([](Problem& p) { p.contact.load.normal_force_N = 1e9; });
  refuses([](Problem& p) { p.contact.load.normal_force_N = 1e-15; });
}

}  // namespace
}  // namespace softfinger::fem
