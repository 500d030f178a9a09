#include "softfinger/friction/sampled_pressure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

/// p ~ (1 - x²/a² - y²/b²)^n on rings of equal load, 1 N together.
std::vector<PressureSample> elliptic_samples(double a, double b, double n, int rings, double x0,
                                             double y0) {
  std::vector<PressureSample> samples;
  const int sectors = 4 * rings;
  for (int i = 0; i < rings; ++i) {
    const double s = std::sqrt(1 - std::pow((i + 0.5) / rings, 1 / (n + 1)));
    for (int j = 0; j < sectors; ++j) {
      const double t = 2 * kPi * (j + 0.5 * (i % 2)) / sectors;
      samples.push_back(
          {x0 + a * s * std::cos(t), y0 + b * s * std::sin(t), 1.0 / (double(rings) * sectors)});
    }
  }
  return samples;
}

TEST(SampledPressure, ConvergesToTheExactSurfaceOfAnEllipse) {
  const LimitSurface exact(0.003, 0.001, 1, 0.5);
  double previous = 1;
  for (const int rings : {10, 40, 160}) {
    const SampledPressure sampled(elliptic_samples(0.003, 0.001, 1, rings, 0.02, -0.01), 0.5);
    EXPECT_NEAR(sampled.normal_force_N(), 1, 1e-12);
    // Rounding of a sum of up to 1e5 terms.
    EXPECT_NEAR(sampled.center_x_m(), 0.02, 0.02 * 1e-12);
    EXPECT_NEAR(sampled.center_y_m(), -0.01, 0.02 * 1e-12);
    double worst = std::abs(sampled.max_torque_Nm() / exact.max_torque_Nm() - 1);
    for (const double omega : {-2000.0, -300.0, 0.0, 50.0, 700.0, 1e5}) {
      const Twist slip{0.3, -0.4, omega};
      worst = std::max(worst, std::abs(sampled.support(slip) / exact.support(slip) - 1));
    }
    EXPECT_LT(worst, previous / 4);  // first order at least: four times the rings
    previous = worst;
  }
  EXPECT_LT(previous, 1e-3);
}

TEST(SampledPressure, LargestTorqueIsTheMomentAboutTheReference) {
  SampledPressure pair({{-1, 0, 3}, {1, 0, 1}}, 0.5);
  EXPECT_DOUBLE_EQ(pair.center_x_m(), -0.5);
  EXPECT_DOUBLE_EQ(pair.eccentricity_m(), (3 * 0.5 + 1 * 1.5) / 4);
  EXPECT_DOUBLE_EQ(pair.max_torque_Nm(), 0.5 * 3);
  EXPECT_DOUBLE_EQ(pair.wrench_for_twist({0, 0, 2}).torque_Nm, pair.max_torque_Nm());
  pair.set_reference(0, 0);
  EXPECT_DOUBLE_EQ(pair.eccentricity_m(), 1);
  EXPECT_DOUBLE_EQ(pair.wrench_for_center_of_rotation(0, 0).torque_Nm, 0.5 * 4);
}

TEST(SampledPressure, CentreOfRotationOnASampleIsTheMiddleOfItsNeighbours) {
  const SampledPressure triple({{-1, 0, 1}, {0, 0, 1}, {1, 0, 1}}, 1);
  const LimitWrench at = triple.wrench_for_center_of_rotation(0, 0);
  const LimitWrench above = triple.wrench_for_center_of_rotation(0, 1e-9);
  const LimitWrench below = triple.wrench_for_center_of_rotation(0, -1e-9);
  EXPECT_EQ(at.force_x_N, 0);
  EXPECT_DOUBLE_EQ(at.torque_Nm, 2);
  EXPECT_NEAR(above.force_x_N, 1, 1e-8);  // the middle sample's whole friction; 1e-9 of the others
  EXPECT_NEAR(below.force_x_N, -1, 1e-8);
  // A patch of finite size goes from one to the other smoothly.
  const SampledPressure patches({{-1, 0, 1}, {0, 0, 1}, {1, 0, 1}}, 1, 0.01);
  EXPECT_NEAR(patches.wrench_for_center_of_rotation(0, 1e-9).force_x_N, 0, 1e-6);
  EXPECT_GT(patches.wrench_for_center_of_rotation(0, 0.1).force_x_N, 0.99);
}

TEST(SampledPressure, UtilisationAndProjectionAgreeWithTheExactSurface) {
  const double a = 0.002, b = 0.001;
  const LimitSurface exact(a, b, 0.5, 0.8);
  const int rings = 40;
  // A sample stands for an equal share of the load, on average of the area.
  const double radius = std::sqrt(a * b / (4 * rings * rings));
  const SampledPressure sampled(elliptic_samples(a, b, 0.5, rings, 0, 0), 0.8, radius);
  const double tolerance = 5e-3;  // of the samples: first order in 1/rings, with a small factor
  for (const double angle : {0.1, 0.5, 0.8, 1.2, 1.5}) {
    const LimitWrench wrench{0.7 * std::cos(angle), 0.5 * std::cos(angle), 0.001 * std::sin(angle)};
    EXPECT_NEAR(sampled.utilisation(wrench) / exact.utilisation(wrench), 1, tolerance);
    const LimitWrench outside{3 * wrench.force_x_N, 3 * wrench.force_y_N, 3 * wrench.torque_Nm};
    const LimitWrench one = sampled.project(outside), two = exact.project(outside);
    EXPECT_NEAR(one.force_x_N, two.force_x_N, tolerance);
    EXPECT_NEAR(one.torque_Nm, two.torque_Nm, tolerance * exact.max_torque_Nm());
    EXPECT_NEAR(sampled.utilisation(one), 1, 1e-6);  // on its own surface
  }
}

TEST(SampledPressure, IgnoresSamplesWithoutForceAndSurvivesHavingNone) {
  const SampledPressure some({{0, 0, 1}, {5, 5, 0}, {7, 7, -2}, {NAN, 0, 1}, {0, 0, INFINITY}}, 1);
  EXPECT_EQ(some.normal_force_N(), 1);
  EXPECT_EQ(some.center_x_m(), 0);
  EXPECT_EQ(some.eccentricity_m(), 0);
  EXPECT_DOUBLE_EQ(some.utilisation({0.6, 0.8, 0}), 1);
  EXPECT_TRUE(std::isinf(some.utilisation({0, 0, 1})));
  const SampledPressure none({}, 1);
  EXPECT_EQ(none.wrench_for_twist({1, 1, 1}).force_x_N, 0);
  EXPECT_EQ(none.utilisation({0, 0, 0}), 0);
  EXPECT_TRUE(std::isinf(none.utilisation({1, 0, 0})));
  EXPECT_EQ(none.project({1, 0, 0}).force_x_N, 0);
}

}  // namespace
}  // namespace softfinger
