#include "softfinger/pressure/layer_fft.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "quadrature.h"
#include "softfinger/fft/convolution.h"
#include "softfinger/fft/influence.h"
#include "softfinger/fft/layer_contact.h"
#include "softfinger/fft/sampled_gap.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {
namespace {

using Eigen::ArrayXd;

/// E* = 1, h = 1: lengths in thicknesses.
ElasticLayer unit_layer(double poisson_ratio) {
  return {1, 1 - poisson_ratio * poisson_ratio, poisson_ratio};
}

/// sqrt(R' R'') = 1.
RelativeRadii unit_radii(double ratio) { return {std::sqrt(ratio), 1 / std::sqrt(ratio)}; }

// Exact solutions for a rigid quadric on a bonded layer, circular (Fredholm equation, 1e-8) and
// elliptic (spectral, 1e-5; a and b 1e-4), in units of h = 1, E* = 1, sqrt(R' R'') = 1.
struct Row {
  double poisson_ratio, radii_ratio, load, approach, a, b, moment, peak;
};
const Row kRows[] = {
    {0, 1, 1.599945578, 0.67338752363, 1, 1, 0.93615985309, 0.78561808685},
    {0, 1, 130332.72552, 203.67787434, 20, 20, 1402917.7946, 203.67787434},
    {0.3, 1, 0.00016667772756, 0.0024271500051, 0.05, 0.05, 4.9090642304e-06, 0.031833102677},
    {0.45, 1, 24.275870182, 2.0395224783, 2, 2, 27.301546385, 3.4518152666},
    {0.45, 1, 340712.03091, 191.25458598, 20, 20, 3579487.5876, 565.35737791},
    {0.5, 1, 1.8806668992, 0.55941548556, 1, 1, 1.0923503458, 0.95167355151},
    {0.5, 1, 1657.7171667, 8.9781172643, 5, 5, 4355.0217448, 45.617961528},
    {0.5, 1, 2391547.8814, 113.42939271, 20, 20, 23166268.089, 5041.5617649},
    {0.3, 2, 1.688350321, 0.64762231993, 1.221249476, 0.81428891168, 1.0117336696, 0.84152150587},
    {0.49, 10, 453.45493724, 6.4894176454, 6.5956890417, 2.302051376, 1133.6465721, 18.991927682},
    {0.5, 10, 134.25612263, 3.6673061439, 4.9551739129, 1.6976429667, 254.91735062, 9.7097264586},
    {0, 10, 0.55417410795, 0.35697155652, 1.3843913363, 0.33509038142, 0.30544772837,
     0.57667596523},
    {0.4, 5, 13488.663379, 49.508532889, 14.895616312, 6.7054365145, 80639.516867, 86.064514883},
};

TEST(LayerFft, EqualsExactSolutionsWithinTheStatedErrors) {
  testing::WorstError approach("layer_fft, approach"), torque("layer_fft, torque"),
      axis_a("layer_fft, a"), axis_b("layer_fft, b"), peak("layer_fft, peak");
  for (const Row& row : kRows) {
    const LayerContact contact = solve_layer_contact(unit_radii(row.radii_ratio),
                                                     unit_layer(row.poisson_ratio), {}, row.load);
    const auto where = ::testing::Message() << "nu " << row.poisson_ratio << ", R'/R'' "
                                            << row.radii_ratio << ", a/h " << row.a;
    // Required: 0.1 % in the load at given approach. The load grows at most like the cube of the
    // approach (a thin incompressible layer).
    EXPECT_LT(approach.of(contact.approach_m, row.approach), 1e-3 / 3) << where;
    EXPECT_LT(torque.of(contact.torque_arm_m * row.load, row.moment), 2e-4) << where;
    // Measured 0.07 %, a thirtieth of a cell; required 0.3 %.
    EXPECT_LT(axis_a.of(contact.edge.a, row.a), 1e-3) << where;
    EXPECT_LT(axis_b.of(contact.edge.b, row.b), 1e-3) << where;
    EXPECT_LT(peak.of(contact.peak_pressure_Pa, row.peak), 1e-3) << where;
  }
}

TEST(LayerFft, ErrorsFallAtLeastLikeTheCellSquared) {
  const Row& row = kRows[7];  // thin and incompressible, the hardest
  ASSERT_EQ(row.poisson_ratio, 0.5);
  ASSERT_EQ(row.a, 20);
  double last = 1;
  for (const int cells : {32, 64, 128}) {
    LayerContactOptions options;
    options.cells = cells;
    const LayerContact contact =
        solve_layer_contact(unit_radii(1), unit_layer(0.5), {}, row.load, options);
    const double error = std::abs(contact.approach_m / row.approach - 1);
    if (cells > 32) {
      EXPECT_LT(error, last / 4) << cells;
    }
    last = error;
  }
}

// The limits have closed forms, and the deviation from them has a known order: h/a for the
// half-space.
TEST(LayerFft, ApproachesHertzOnAThickLayer) {
  const PressureModel& hertz = *find_pressure_model("hertz");
  for (const double ratio : {1.0, 4.0, 50.0}) {
    ContactProblem problem{{0.01 * ratio, 0.01}, {1e3, 2e5, 0.4}, {0.5, 0.8}};
    const Prediction exact = hertz.predict(problem);
    const LayerContact contact =
        solve_layer_contact(problem.radii, problem.layer, {}, problem.load.normal_force_N);
    const double tolerance = 1e-4 + exact.a_m / problem.layer.thickness_m;
    EXPECT_NEAR(contact.approach_m / exact.indentation_m, 1, tolerance) << ratio;
    EXPECT_NEAR(contact.torque_arm_m / exact.torque_arm_exact_m, 1, tolerance) << ratio;
    const double edge_tolerance = 1e-3;  // a twentieth of a cell
    EXPECT_NEAR(contact.edge.a / exact.a_m, 1, tolerance + edge_tolerance) << ratio;
    EXPECT_NEAR(contact.edge.b / exact.b_m, 1, tolerance + edge_tolerance) << ratio;
  }
}

// A layer 1e15 times as thick as the contact is wide is still accepted as a layer.
TEST(LayerFft, EqualsHertzOnAnExtremelyThickLayer) {
  const PressureModel& hertz = *find_pressure_model("hertz");
  for (const double thickness_m : {1e6, 1e12}) {
    const ContactProblem problem{{0.02, 0.01}, {thickness_m, 2e5, 0.5}, {0.5, 0.8}};
    const Prediction exact = hertz.predict(problem);
    const LayerContact contact =
        solve_layer_contact(problem.radii, problem.layer, {}, problem.load.normal_force_N);
    EXPECT_NEAR(contact.approach_m / exact.indentation_m, 1, 1e-5);
    EXPECT_NEAR(contact.torque_arm_m / exact.torque_arm_exact_m, 1, 1e-5);
  }
}

TEST(LayerFft, ApproachesConfinedWinklerOnAThinCompressibleLayer) {
  const PressureModel& winkler = *find_pressure_model("winkler");
  double last = 1;
  for (const double thickness_m : {2e-4, 5e-5, 2e-5}) {
    ContactProblem problem{{0.02, 0.01}, {thickness_m, 2e5, 0.2}, {5, 0.8}};
    const Prediction limit = winkler.predict(problem);
    const LayerContact contact =
        solve_layer_contact(problem.radii, problem.layer, {}, problem.load.normal_force_N);
    // The limit neglects terms of the order of the layer's thickness over the contact's width.
    const double tolerance = 2 * thickness_m / limit.b_m;
    const double error = std::abs(contact.approach_m / limit.indentation_m - 1);
    EXPECT_LT(error, tolerance);
    EXPECT_LT(error, last);
    EXPECT_NEAR(contact.edge.a / limit.a_m, 1, tolerance + 3e-3);
    EXPECT_NEAR(contact.edge.b / limit.b_m, 1, tolerance + 3e-3);
    last = error;
  }
}

TEST(LayerFft, TurnedAndShiftedGapGivesTheTurnedAndShiftedContact) {
  const double R1 = 0.016, R2 = 0.006, load_N = 2, angle = 0.6, x0 = 4e-4, y0 = -9e-4;
  const ElasticLayer layer{0.003, 2e5, 0.49};
  const LayerContact reference = solve_layer_contact(RelativeRadii{R1, R2}, layer, {}, load_N);
  const LayerContact turned = solve_layer_contact(
      [=](double x, double y) {
        const double u = std::cos(angle) * (x - x0) + std::sin(angle) * (y - y0);
        const double v = std::cos(angle) * (y - y0) - std::sin(angle) * (x - x0);
        return u * u / (2 * R1) + v * v / (2 * R2);
      },
      GapWindow{1e-3, 0, 0.02, 0.01}, layer, {}, load_N);
  const double integral = 3e-5;  // error of both grids' integrals
  EXPECT_NEAR(turned.approach_m / reference.approach_m, 1, integral);
  EXPECT_NEAR(turned.torque_arm_m / reference.torque_arm_m, 1, integral);
  EXPECT_NEAR(turned.centre_of_pressure_x_m, x0, integral * reference.edge.a);
  EXPECT_NEAR(turned.centre_of_pressure_y_m, y0, integral * reference.edge.a);
  EXPECT_NEAR(turned.edge.a / reference.edge.a, 1, 1e-3);  // a twentieth of a cell
  EXPECT_NEAR(turned.edge.b / reference.edge.b, 1, 1e-3);
  EXPECT_NEAR(turned.edge.area / reference.edge.area, 1, 2e-3);
  EXPECT_NEAR(turned.edge.axis_rad, angle, 1e-3);
  EXPECT_NEAR(reference.edge.axis_rad, 0, 1e-12);
  // Corresponding points of both contacts have the same pressure.
  const double u = 0.3 * reference.edge.a, v = 0.4 * reference.edge.b;
  EXPECT_NEAR(turned.pressure_at_Pa(x0 + std::cos(angle) * u - std::sin(angle) * v,
                                    y0 + std::sin(angle) * u + std::cos(angle) * v) /
                  reference.pressure_at_Pa(u, v),
              1, 1e-3);
}

// A sphere's gap is larger than the paraboloid's by the factor 1 + (r/2R)² at the distance r.
TEST(LayerFft, SphereDiffersFromTheParaboloidByTheNextTermOfItsGap) {
  const double R = 0.01;
  const ElasticLayer layer{0.003, 2e5, 0.45};
  for (const double load_N : {0.05, 0.5}) {
    const LayerContact paraboloid = solve_layer_contact(RelativeRadii{R, R}, layer, {}, load_N);
    const LayerContact sphere = solve_layer_contact(
        [=](double x, double y) {
          const double r2 = x * x + y * y;
          return r2 / (R + std::sqrt(R * R - r2));
        },
        GapWindow{0, 0, 0.7 * R, 0.7 * R}, layer, {}, load_N);
    const double next_term = std::pow(paraboloid.edge.a / (2 * R), 2);
    EXPECT_GT(sphere.approach_m, paraboloid.approach_m);
    EXPECT_NEAR(sphere.approach_m / paraboloid.approach_m, 1, next_term);
    EXPECT_LT(sphere.torque_arm_m, paraboloid.torque_arm_m);
    EXPECT_NEAR(sphere.torque_arm_m / paraboloid.torque_arm_m, 1, next_term);
  }
}

TEST(LayerFft, GapNeedNotBeAQuadric) {
  // r⁴ on a half-space [Johnson, section 5.3; Galin]: with gap A r⁴ the approach is (8/3) A a⁴ and
  // the load (2 E* a / (n + 1)) n d = (8/5) E* a d for r^n, n = 4.
  const double A = 1, load = 1;
  const ElasticLayer half_space{1e5, 1, 0};
  const double a = std::pow(load * 15 / (64 * A), 0.2), d = 8 * A * std::pow(a, 4) / 3;
  const LayerContact contact =
      solve_layer_contact([=](double x, double y) { return A * std::pow(x * x + y * y, 2); },
                          GapWindow{0, 0, 3, 3}, half_space, {}, load);
  EXPECT_NEAR(contact.approach_m / d, 1, 1e-4);
  EXPECT_NEAR(contact.edge.a / a, 1, 1e-3);  // a twentieth of a cell
  EXPECT_NEAR(contact.edge.b / a, 1, 1e-3);
  EXPECT_NEAR(contact.edge.area / (kPi * a * a), 1, 2e-3);
}

TEST(LayerFft, TwoEqualLayersAreOneUnderHalfTheGap) {
  // Both displace alike, so that each sees half of gap and approach.
  const ElasticLayer layer{0.002, 3e5, 0.48};
  const double load_N = 1.5;
  const LayerContact two = solve_layer_contact(RelativeRadii{0.02, 0.01}, layer, layer, load_N);
  const LayerContact one = solve_layer_contact(RelativeRadii{0.04, 0.02}, layer, {}, load_N);
  const double solver = 1e-5;  // its tolerance
  EXPECT_NEAR(two.approach_m / (2 * one.approach_m), 1, solver);
  EXPECT_NEAR(two.torque_arm_m / one.torque_arm_m, 1, solver);
  EXPECT_NEAR(two.edge.a / one.edge.a, 1, 10 * solver);
  EXPECT_NEAR(two.edge.b / one.edge.b, 1, 10 * solver);
  // The cell of the largest pressure lies beside the centre, where the gap is not quite zero: by
  // about the square of half a cell over the semi-axis.
  const double beside_centre = 2e-4;
  EXPECT_NEAR(two.layer_displacement_m / two.approach_m, 0.5, beside_centre);
  EXPECT_NEAR(two.object_displacement_m / two.layer_displacement_m, 1, beside_centre);
  // A rigid object is the limit of a stiff one.
  const LayerContact stiff =
      solve_layer_contact(RelativeRadii{0.04, 0.02}, layer, ElasticLayer{0.002, 3e9, 0.48}, load_N);
  EXPECT_NEAR(stiff.approach_m / one.approach_m, 1, 2e-4);
}

TEST(LayerFft, CellsBalanceTheLoadAndAreComplementary) {
  const double load_N = 2;
  const LayerContact contact =
      solve_layer_contact(RelativeRadii{0.03, 0.01}, ElasticLayer{0.003, 2e5, 0.49}, {}, load_N);
  EXPECT_NEAR(contact.pressure_Pa.sum() * contact.grid.cell_area() / load_N, 1, 1e-12);
  EXPECT_GE(contact.pressure_Pa.minCoeff(), 0);
  EXPECT_LE(contact.residual, LayerContactOptions{}.tolerance);
  EXPECT_LE(contact.penetration, 10 * LayerContactOptions{}.tolerance);
  for (Eigen::Index k = 0; k < contact.pressure_Pa.size(); ++k)
    if (contact.pressure_Pa[k] > 0) {
      // The mean is below the tolerance; single cells at the edge may be worse.
      ASSERT_LT(std::abs(contact.gap_m[k]), 1e-3 * contact.approach_m);
    } else {
      ASSERT_GT(contact.gap_m[k], -1e-4 * contact.approach_m);
    }
  // Even in x and y.
  for (int i = 0; i < contact.grid.rows; ++i)
    for (int j = 0; j < contact.grid.columns; ++j) {
      const int mirror_i = contact.grid.rows - 1 - i, mirror_j = contact.grid.columns - 1 - j;
      ASSERT_EQ(contact.pressure_Pa[i * contact.grid.columns + j],
                contact.pressure_Pa[mirror_i * contact.grid.columns + mirror_j]);
    }
}

TEST(LayerFft, AnswerOfAQuadricDoesNotDependOnTheUnits) {
  const RelativeRadii radii{0.017, 0.009};
  const ElasticLayer layer{0.0031, 2.3e5, 0.47};
  const LayerContact one = solve_layer_contact(radii, layer, {}, 1.7);
  for (const double length : {1e-3, 7.0, 1e3})
    for (const double force : {1e-3, 1e3}) {
      const LayerContact other = solve_layer_contact(
          RelativeRadii{radii.major_m * length, radii.minor_m * length},
          ElasticLayer{layer.thickness_m * length,
                       layer.youngs_modulus_Pa * force / (length * length), layer.poisson_ratio},
          {}, 1.7 * force);
      const double tolerance = 1e-12;
      EXPECT_NEAR(other.edge.a / (length * one.edge.a), 1, tolerance);
      EXPECT_NEAR(other.approach_m / (length * one.approach_m), 1, tolerance);
      EXPECT_NEAR(other.torque_arm_m / (length * one.torque_arm_m), 1, tolerance);
    }
}

TEST(LayerFft, ModelsPressureBalancesLoadAndTorqueAsStated) {
  const PressureModel& model = *find_pressure_model("layer_fft");
  for (const double ratio : {1.0, 3.0, 50.0})
    for (const double nu : {0.0, 0.49, 0.5}) {
      const ContactProblem problem{{0.008 * ratio, 0.008}, {0.003, 2e5, nu}, {0.3, 0.8}};
      const Prediction prediction = model.predict(problem);
      ASSERT_TRUE(prediction.has_answer);
      // The edge is not quite the ellipse: integrate over a larger one.
      const double beyond = 1.05;
      double load_N = 0, moment_Nm = 0;
      constexpr int kSteps = 100;
      for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
          const double r = beyond * std::sin(kPi / 2 * (i + 0.5) / kSteps);
          const double slope = beyond * std::cos(kPi / 2 * (i + 0.5) / kSteps);
          const double angle = 2 * kPi * (j + 0.5) / kSteps;
          const double x = r * prediction.a_m * std::cos(angle);
          const double y = r * prediction.b_m * std::sin(angle);
          const double force = model.pressure_Pa(problem, prediction, x, y) * r * slope *
                               prediction.a_m * prediction.b_m * kPi * kPi / (kSteps * kSteps);
          load_N += force;
          moment_Nm += force * std::hypot(x, y);
        }
      EXPECT_NEAR(load_N / 0.3, 1, 2e-3) << ratio << " " << nu;
      EXPECT_NEAR(moment_Nm / 0.3 / prediction.torque_arm_exact_m, 1, 5e-3) << ratio << " " << nu;
      EXPECT_NEAR(model.pressure_Pa(problem, prediction, 0, 0) / prediction.peak_pressure_Pa, 1,
                  5e-3);
      EXPECT_EQ(model.pressure_Pa(problem, prediction, 1.05 * prediction.a_m, 0), 0);
      EXPECT_GE(prediction.torque_arm_exact_m, prediction.torque_arm_paper_m * (1 - 1e-15));
    }
}

TEST(LayerFft, ModelSaysWhatItCannotDo) {
  const PressureModel& model = *find_pressure_model("layer_fft");
  const auto first_check = [&](const ContactProblem& problem) {
    const Prediction prediction = model.predict(problem);
    EXPECT_FALSE(prediction.has_answer);
    EXPECT_FALSE(prediction.validity.holds());
    return std::string(prediction.validity.begin()->check);
  };
  EXPECT_EQ(first_check({{2, 0.01}, {0.003, 2e5, 0.49}, {1, 0.8}}), "radii_ratio");
  EXPECT_EQ(first_check({{0.01, 0.01}, {1e-9, 2e5, 0.3}, {1, 0.8}}), "solved");
  const auto fails = [&](const ContactProblem& problem, const char* name) {
    const Prediction prediction = model.predict(problem);
    EXPECT_TRUE(prediction.has_answer);
    for (const ValidityCheck& check : prediction.validity)
      if (std::string(check.check) == name) return !check.holds();
    return false;
  };
  EXPECT_TRUE(fails({{0.01, 0.01}, {2e-5, 2e5, 0.3}, {1, 0.8}}, "grid_resolves_layer"));
  EXPECT_TRUE(fails({{0.01, 0.01}, {0.002, 2e5, 0.3}, {20, 0.8}}, "small_strain"));
  EXPECT_TRUE(fails({{0.01, 0.01}, {0.02, 2e5, 0.3}, {50, 0.8}}, "small_slope"));
  EXPECT_FALSE(fails({{0.01, 0.01}, {0.002, 2e5, 0.3}, {0.1, 0.8}}, "small_strain"));
}

SampledGap::Grid square_grid(double half_width_m, int side) {
  const double spacing_m = 2 * half_width_m / (side - 1);
  return {-half_width_m, -half_width_m, spacing_m, spacing_m, side, side};
}

ArrayXd samples_of(const SampledGap::Grid& grid, const GapFunction& gap_m) {
  ArrayXd samples_m(grid.rows * grid.columns);
  for (int i = 0, k = 0; i < grid.rows; ++i)
    for (int j = 0; j < grid.columns; ++j, ++k)
      samples_m[k] =
          gap_m(grid.first_x_m + j * grid.spacing_x_m, grid.first_y_m + i * grid.spacing_y_m);
  return samples_m;
}

TEST(SampledGap, IsExactForQuadricsAndOfThirdOrder) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-1, 1);
  const auto worst = [&](const GapFunction& truth, int side) {
    const SampledGap::Grid grid = square_grid(1.5, side);
    const SampledGap gap(grid, samples_of(grid, truth) + 7);  // a constant does not matter
    double largest = 0;
    for (int i = 0; i < 1000; ++i) {
      const double x = place(random), y = place(random);
      largest = std::max(largest, std::abs(gap(x, y) - truth(x, y)));
    }
    return largest;
  };
  // The origin is a sample, where both gaps are zero.
  EXPECT_LT(worst([](double x, double y) { return 2 * x * x + y * y + 0.5 * x * y; }, 31), 1e-14);
  const GapFunction wavy = [](double x, double y) {
    return x * x + y * y + 0.1 * std::sin(3 * x) * x;
  };
  EXPECT_GT(worst(wavy, 31) / worst(wavy, 61), 7);
}

TEST(SampledGap, GivesTheContactOfTheFunctionThatItSamples) {
  const double R1 = 0.016, R2 = 0.006, load_N = 2;
  const ElasticLayer layer{0.003, 2e5, 0.49};
  const GapFunction egg = [=](double x, double y) {
    return x * x / (2 * R1) * (1 + 20 * x) + y * y / (2 * R2);
  };
  const LayerContact truth =
      solve_layer_contact(egg, GapWindow{0, 0, 0.01, 0.01}, layer, {}, load_N);
  const SampledGap::Grid grid = square_grid(0.01, 101);
  const SampledGap gap(grid, samples_of(grid, egg));
  ContactProblem problem;
  problem.layer = layer;
  problem.load = {load_N, 0.8};
  const GapPrediction sampled = predict_layer_fft(gap, gap.window(), problem);
  // Interpolation of the cubic: spacing³ times its third derivative, over the approach.
  const double interpolation = std::pow(grid.spacing_x_m, 3) * 60 / R1 / truth.approach_m;
  EXPECT_NEAR(sampled.contact.approach_m / truth.approach_m, 1, 1e-5 + interpolation);
  EXPECT_NEAR(sampled.contact.torque_arm_m / truth.torque_arm_m, 1, 1e-4 + interpolation);
  EXPECT_NEAR(sampled.prediction.a_m / truth.edge.a, 1, 1e-3);  // a twentieth of a cell
  EXPECT_NEAR(sampled.prediction.b_m / truth.edge.b, 1, 1e-3);
  EXPECT_TRUE(sampled.prediction.has_answer);
  // The check takes the gap's steepest place: the end of the long axis or of the short one.
  double slope = 0;
  for (const auto& check : sampled.prediction.validity)
    if (std::string(check.check) == "small_slope") slope = check.value;
  EXPECT_NEAR(slope, truth.edge.b / R2, 0.05 * slope);
}

TEST(SampledGap, RefusesHolesAndPlacesOutside) {
  const SampledGap::Grid grid = square_grid(0.01, 11);
  ArrayXd samples_m = ArrayXd::Zero(121);
  const SampledGap gap(grid, samples_m);
  EXPECT_NEAR(gap.window().half_width_x_m, 0.008, 1e-15);
  EXPECT_EQ(gap(0.008, -0.008), 0);
  EXPECT_THROW(gap(0.0081, 0), InputError);
  EXPECT_THROW(gap(0, std::nan("")), InputError);
  samples_m[5 * 11 + 6] = std::nan("");
  try {
    SampledGap(grid, samples_m);
    ADD_FAILURE() << "a hole was accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("x 2.000000 mm, y 0.000000 mm"), std::string::npos)
        << error.what();
  }
  EXPECT_THROW(SampledGap(grid, ArrayXd::Zero(120)), InputError);
  EXPECT_THROW(SampledGap(square_grid(0.01, 4), ArrayXd::Zero(16)), InputError);
  EXPECT_THROW(SampledGap(square_grid(0, 11), ArrayXd::Zero(121)), InputError);
}

TEST(LayerFft, SaysWhenTheContactReachesTheWindow) {
  const ElasticLayer layer{0.003, 2e5, 0.49};
  const auto gap = [](double x, double y) { return (x * x + y * y) / 0.02; };
  EXPECT_THROW(solve_layer_contact(gap, GapWindow{0, 0, 1e-3, 1e-3}, layer, {}, 5),
               ContactReachesBorder);
}

TEST(LayerFft, RefusesWhatItCannotSolve) {
  const ElasticLayer layer{0.002, 2e5, 0.3};
  const RelativeRadii radii{0.01, 0.01};
  LayerContactOptions options;
  options.cells = 100;
  EXPECT_THROW(solve_layer_contact(radii, layer, {}, 1, options), InputError);
  EXPECT_THROW(solve_layer_contact(radii, layer, {}, -1), InputError);
  EXPECT_THROW(solve_layer_contact(radii, ElasticLayer{0.002, 2e5, 0.6}, {}, 1), InputError);
  const auto gap_m = [](double x, double y) { return (x * x + y * y) / 0.02; };
  // A contact larger than the window in which the gap is known.
  EXPECT_THROW(solve_layer_contact(gap_m, {0, 0, 1e-4, 1e-4}, layer, {}, 1), ConvergenceError);
  EXPECT_THROW(solve_layer_contact(gap_m, {0, 0, 0, 1e-4}, layer, {}, 1), InputError);
  options = {};
  options.max_iterations = 2;
  EXPECT_THROW(solve_layer_contact(radii, layer, {}, 1, options), ConvergenceError);
}

// The convolution is compared with the sums that it abbreviates.
TEST(Convolution, EqualsTheDirectSum) {
  const int rows = 16, columns = 8;
  std::mt19937 random(7);
  const auto uniform = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  fft::KernelQuadrant kernel(rows + 1, columns + 1);
  for (Eigen::Index k = 0; k < kernel.size(); ++k) kernel.data()[k] = uniform();
  Eigen::ArrayXd quarter(rows * columns / 4), field(rows * columns), even(rows * columns), result;
  for (double& value : quarter) value = uniform();
  const auto mirrored = [](int i, int n) { return i < n / 2 ? n / 2 - 1 - i : i - n / 2; };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      field[i * columns + j] = uniform();
      even[i * columns + j] = quarter[mirrored(i, rows) * (columns / 2) + mirrored(j, columns)];
    }
  const auto direct = [&](const Eigen::ArrayXd& values, int i, int j) {
    double sum = 0;
    for (int k = 0; k < rows; ++k)
      for (int l = 0; l < columns; ++l)
        sum += kernel(std::abs(i - k), std::abs(j - l)) * values[k * columns + l];
    return sum;
  };
  const double rounding = 1e-13;  // of sums of 128 numbers up to one
  fft::make_convolution(kernel)->apply(field, result);
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j)
      EXPECT_NEAR(result[i * columns + j], direct(field, i, j), rounding);
  fft::make_even_convolution(kernel)->apply(quarter, result);
  for (int i = 0; i < rows / 2; ++i)
    for (int j = 0; j < columns / 2; ++j)
      EXPECT_NEAR(result[i * (columns / 2) + j], direct(even, i + rows / 2, j + columns / 2),
                  rounding);
}

TEST(Influence, OfAllCellsTogetherIsTheConfinedCompression) {
  // A uniform pressure compresses the layer by h/M; far cells do not matter.
  for (const double nu : {0.0, 0.3, 0.49, 0.5}) {
    const fft::LayerStiffening stiffening{StackKernel(LayerKernel(nu), 1), 100};
    for (const double size : {0.4, 2.0}) {
      const fft::KernelQuadrant kernel =
          fft::influence_of_cells(128, 128, size, 0.8 * size, 1, &stiffening);
      double sum = 0;
      for (int i = 0; i < 128; ++i)
        for (int j = 0; j < 128; ++j) sum += kernel(i, j) * (i ? 2 : 1) * (j ? 2 : 1);
      // E*/M
      EXPECT_NEAR(sum, (1 - 2 * nu) / ((1 - nu) * (1 - nu)), 2e-7) << nu << " " << size;
    }
  }
}

TEST(Influence, OfDistantCellsIsThatOfAPointForce) {
  const fft::KernelQuadrant kernel = fft::influence_of_cells(128, 128, 1, 0.6, 1, nullptr);
  // Closed form near and moments far agree; both approach 1/(pi r) like the cell over r squared.
  for (int n = 8; n < 128; ++n) {
    const double r = n * std::hypot(1, 0.6);
    EXPECT_NEAR(kernel(n, n) * kPi * r / 0.6, 1, 0.1 / (n * n));
    EXPECT_NEAR(kernel(0, n) * kPi * n / 0.6, 1, 0.3 / (n * n));
  }
  // Continuous where one passes into the other (17 cells along x).
  const auto scaled = [&](int n) { return (kernel(0, n) * kPi * n / 0.6 - 1) * n * n; };
  EXPECT_NEAR(scaled(18) - scaled(17), scaled(17) - scaled(16), 1e-3 * scaled(17));
}

}  // namespace
}  // namespace softfinger
