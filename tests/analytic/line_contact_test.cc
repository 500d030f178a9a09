#include "softfinger/layer/line_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "softfinger/input/constants.h"
#include "softfinger/layer/line_law.h"
#include "softfinger/math/gauss_legendre.h"
#include "softfinger/pads/pad_error.h"
#include "softfinger/pads/pad_model.h"

namespace softfinger {
namespace {

/// h = R = E* = 1.
LineContact exact(double half_width, double poisson_ratio, int terms = 0) {
  return line_contact(half_width, 1, 1, LayerKernel(poisson_ratio), terms);
}

TEST(LineContact, TendsToHertzOnAThickLayer) {
  // K. L. Johnson, Contact Mechanics, section 4.2: b² = 4 P' R/(pi E*), p(0) = 2 P'/(pi b).
  for (const double nu : {0.0, 0.3, 0.5}) {
    const LineContact line = exact(0.01, nu);
    // A layer stiffens the contact by the order of (b/h)².
    EXPECT_NEAR(4 * line.load_over_modulus_m / (kPi * 1e-4), 1, 2e-4) << nu;
    EXPECT_NEAR(line.peak_over_modulus * 0.01 / line.load_over_modulus_m, 2 / kPi, 1e-4) << nu;
    EXPECT_NEAR(line.mean_square_over_square, 0.25, 1e-4) << nu;
  }
}

TEST(LineContact, TendsToTheThinLayers) {
  // Compressible: p = M (b² - x²)/(2 R h), d = b²/(2 R), with a zone of a thickness at the edges.
  const double nu = 0.3, b = 50, modulus = (1 - nu) * (1 - nu) / (1 - 2 * nu);
  const LineContact compressible = exact(b, nu);
  EXPECT_NEAR(compressible.load_over_modulus_m / (2. / 3 * modulus * b * b * b), 1, 1 / b);
  EXPECT_NEAR(compressible.indentation_m / (b * b), 0.5, 0.5 / b);
  EXPECT_NEAR(compressible.mean_square_over_square, 1. / 5, 0.1 / b);
  // Incompressible: p = E* (b² - x²)²/(32 h³ R), d = b²/(6 R).
  const LineContact thin = exact(b, 0.5);
  EXPECT_NEAR(thin.load_over_modulus_m / (std::pow(b, 5) / 30), 1, 10 / b);
  EXPECT_NEAR(thin.indentation_m / (b * b), 1. / 6, 1 / b);
  EXPECT_NEAR(thin.mean_square_over_square, 1. / 7, 1 / b);
}

TEST(LineContact, PressesTheSurfaceIntoTheCylinder) {
  // u(0) - u(x) = (2/pi) int_0^inf w(k)/k p^(k) (1 - cos kx) dk, by plain quadrature.
  // Waves to k b = 120, whose crests the places across resolve.
  const QuadratureRule across = composite_gauss_legendre(kPi / 2, 0.05);
  for (const double nu : {0.0, 0.45, 0.5})
    for (const double b : {0.3, 2.0}) {
      const LineContact line = exact(b, nu);
      const LayerKernel kernel(nu);
      const QuadratureRule waves = composite_gauss_legendre(120 / b, 0.5 / b);
      // Places, and the forces there of both halves.
      const Eigen::ArrayXd place = b * across.nodes.array().sin();
      Eigen::ArrayXd force = 2 * b * across.weights.array() * across.nodes.array().cos();
      for (Eigen::Index j = 0; j < force.size(); ++j)
        force[j] *= line.pressure_over_modulus(place[j]);
      for (const double x : {0.4 * b, 0.9 * b}) {
        double sum = 0;
        for (Eigen::Index i = 0; i < waves.nodes.size(); ++i) {
          const double k = waves.nodes[i];
          const double transform = (force * (k * place).cos()).sum();
          sum += waves.weights[i] * kernel.compliance(k) / k * transform * (1 - std::cos(k * x));
        }
        // The waves that are left out fall like k^(-5/2): (k b)^(-3/2) in the sum.
        EXPECT_NEAR(2 / kPi * sum / (x * x / 2), 1, 3 * std::pow(120, -1.5))
            << nu << " " << b << " " << x;
      }
    }
}

TEST(LineContact, NeedsNoMoreTerms) {
  for (const double nu : {0.0, 0.45, 0.5})
    for (const double b : {0.1, 1.0, 10.0}) {
      const LineContact line = exact(b, nu), finer = exact(b, nu, 2 * (12 + int(4 * b)));
      EXPECT_NEAR(line.load_over_modulus_m / finer.load_over_modulus_m, 1, 1e-8);
      EXPECT_NEAR(line.indentation_m / finer.indentation_m, 1, 1e-8);
    }
}

TEST(LineContact, FindsTheLoad) {
  const LineContact line = line_contact_at_load(0.3, 5, 0.7, LayerKernel(0.49));
  EXPECT_NEAR(line.load_over_modulus_m, 0.3, 1e-11);
}

TEST(LineLaw, FollowsTheExactSolution) {
  for (const double nu : {0.0, 0.2, 0.35, 0.45, 0.49, 0.499, 0.4999, 0.5})
    for (const double b : {0.025, 0.07, 0.3, 0.9, 3.3, 11.0, 37.0}) {
      const LineContact line = exact(b, nu);
      const double load = line.load_over_modulus_m;
      const auto law =
          line_logarithms<1>(Dual<1>::variable(std::log(load), 0), Dual<1>(1 - 2 * nu));
      // The table is laid through nodes: half of a per cent is promised between them.
      constexpr double kPromised = 5e-3;
      EXPECT_NEAR(law[kWidth].value, std::log(b), kPromised) << nu << " " << b;
      EXPECT_NEAR(law[kApproach].value, std::log(line.indentation_m / (b * b)), kPromised);
      EXPECT_NEAR(law[kCrest].value, std::log(line.peak_over_modulus * b / load), kPromised);
      EXPECT_NEAR(law[kSpread].value, std::log(line.mean_square_over_square), kPromised);
      const LineContact wider = exact(b * 1.001, nu), narrower = exact(b / 1.001, nu);
      const double slope = std::log(wider.indentation_m / narrower.indentation_m) /
                           std::log(wider.load_over_modulus_m / narrower.load_over_modulus_m);
      EXPECT_NEAR((law[kApproach].slope[0] + 2 * law[kWidth].slope[0]) / slope, 1, kPromised);
    }
}

/// A line on a layer of h = E = 1 under a cylinder of R = 10, with walls far away.
struct Line {
  PadShape shape;
  PadProblem problem;
  Line(double poisson_ratio, double half_width, double length, double load)
      : shape(ConvexOutline::rounded_rectangle(length, 2 * (1.15 * half_width + 3))) {
    problem.shape = &shape;
    problem.layer = {1, 1, poisson_ratio};
    problem.load = {load, 0.5};
    problem.pressing = PadPressing::frictionless;
    problem.cylinder = CylinderOnPad{10, 0};
  }
};

TEST(LineLayer, IsPlaneStrainAllAlongWithoutPoissonsRatio) {
  const LineContact exact_line = line_contact(1, 10, 1, LayerKernel(0.0));
  const Line line(0, 1, 10, 10 * exact_line.load_over_modulus_m);
  const PadPrediction p = line_layer().predict(line.problem);
  EXPECT_TRUE(p.valid());
  EXPECT_NEAR(p.indentation_m / exact_line.indentation_m, 1, 2e-3);
  EXPECT_NEAR(p.half_width_m, 1, 2e-3);
  // The mean distance of the points of a strip, by the exact pressure across it.
  double arm = 0;
  const QuadratureRule rule = composite_gauss_legendre(1, 0.1);
  for (Eigen::Index i = 0; i < rule.nodes.size(); ++i)
    for (Eigen::Index j = 0; j < rule.nodes.size(); ++j)
      arm += 2 * rule.weights[i] * rule.weights[j] *
             exact_line.pressure_over_modulus(rule.nodes[i]) / exact_line.load_over_modulus_m *
             std::hypot(rule.nodes[i], 5 * rule.nodes[j]);
  EXPECT_NEAR(p.eccentricity_m / arm, 1, 1e-3);
}

TEST(LineLayer, AgreesWithFiniteElementsItWasNotFittedTo) {
  // Level 2 of fem/pad, h = E = 1, R = 10: nu, b, length, load per length; d, dP/dd, arm, tilt
  // stiffness about the line's middle.
  const double runs[][8] = {{0.1, 0.098, 5.12, 0.00076631212, 0.00151092, 3.0871, 1.27908, 6.7749},
                            {0.35, 1.025, 14.58, 0.15290957, 0.0672377, 49.456, 3.60928, 821.29},
                            {0.2, 0.083, 4.48, 0.00056611119, 0.00113295, 2.6417, 1.11147, 4.3885},
                            {0.1, 0.212, 5.75, 0.0036606946, 0.00544825, 4.8553, 1.44176, 13.451},
                            {0.1, 0.998, 7.92, 0.11548431, 0.0691048, 19.2, 2.06664, 100.35},
                            {0.2, 0.087, 7.38, 0.00062226205, 0.00122255, 4.4456, 1.83495, 20.045},
                            {0.35, 0.482, 6.95, 0.024256648, 0.0194126, 12.16, 1.70598, 45.753},
                            {0.47, 0.29, 8.33, 0.0091466414, 0.00773784, 13.502, 1.96793, 67.783},
                            {0.2, 0.113, 5.41, 0.0010532547, 0.00190581, 3.586, 1.34354, 8.6631},
                            {0.2, 0.389, 6.57, 0.013533853, 0.0143766, 8.2968, 1.647, 29.297},
                            {0.1, 0.942, 9.97, 0.10000661, 0.0625783, 23.044, 2.55873, 190.73},
                            {0.35, 0.597, 11.69, 0.039788831, 0.0270504, 24.647, 2.87248, 264.01},
                            {0.35, 0.278, 8.05, 0.0073171874, 0.00798069, 9.7061, 1.96763, 49.619},
                            {0.35, 0.786, 12.36, 0.077552932, 0.0427572, 32.969, 3.04788, 387.75},
                            {0.495, 0.553, 7.88, 0.041226263, 0.0204291, 24.525, 1.81673, 96.549},
                            {0.1, 0.121, 4.56, 0.0011717168, 0.00215571, 2.9883, 1.14016, 5.2246},
                            {0.4995, 0.338, 9.9, 0.013331163, 0.00923032, 20.517, 2.31059, 137.7},
                            {0.4, 0.084, 5.9, 0.00066358179, 0.00110767, 4.2118, 1.42954, 11.458},
                            {0.4995, 0.915, 11.99, 0.15491354, 0.0427369, 74.15, 2.73999, 644.2}};
  for (const auto& run : runs) {
    const Line line(run[0], run[1], run[2], run[2] * run[3]);
    const PadPrediction p = line_layer().predict(line.problem);
    ASSERT_TRUE(p.valid()) << run[0] << " " << run[1];
    const auto bound = pad_error_bound(line_layer(), line.problem);
    ASSERT_TRUE(bound);
    EXPECT_NEAR(p.indentation_m / run[4], 1, bound->indentation);
    EXPECT_NEAR(p.normal_stiffness_N_per_m / run[5], 1, bound->indentation);
    EXPECT_NEAR(p.pressure_arm_m / run[6], 1, bound->max_torque);
    EXPECT_NEAR(p.tilt_stiffness_Nm_per_rad[1] / run[7], 1, bound->tilt_stiffness);
  }
}

TEST(LineLayer, ItsPressureCarriesTheLoadAtTheArm) {
  const Line line(0.45, 1, 12, 1.5);
  double load = 0, moment = 0;
  for (const PressureSample& sample : line_layer().slipping_pressure(line.problem)) {
    load += sample.normal_force_N;
    moment += sample.normal_force_N * std::hypot(sample.x_m, sample.y_m);
  }
  EXPECT_NEAR(load, 1.5, 1e-12);
  // The samples take the middle of each piece of the line.
  EXPECT_NEAR(moment / load / line_layer().predict(line.problem).eccentricity_m, 1, 1e-3);
}

TEST(LineLayer, SaysWhereItHolds) {
  const auto failing = [](const Line& line) {
    std::string names;
    for (const ValidityCheck& check : line_layer().predict(line.problem).validity)
      if (!check.holds()) names += std::string(check.check) + " ";
    return names;
  };
  EXPECT_EQ(failing(Line(0.45, 0.5, 10, 0.2)), "");
  EXPECT_EQ(failing(Line(0.45, 0.5, 3, 0.05)), "length ");
  Line near_wall(0.45, 0.5, 10, 0.2);
  near_wall.problem.cylinder->offset_m = 2;
  EXPECT_EQ(failing(near_wall), "to_the_side_wall ");
  EXPECT_FALSE(pad_error_bound(line_layer(), near_wall.problem));
  // A plane has no line, and a flat face's models no cylinder.
  Line plane(0.45, 0.5, 10, 0.2);
  plane.problem.cylinder.reset();
  EXPECT_FALSE(line_layer().predict(plane.problem).has_answer);
  for (const PadModel* model : all_pad_models())
    EXPECT_FALSE(model->predict(near_wall.problem).has_answer);
}

}  // namespace
}  // namespace softfinger
