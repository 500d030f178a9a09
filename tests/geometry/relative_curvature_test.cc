#include "softfinger/geometry/relative_curvature.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <limits>
#include <random>

#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

using Eigen::Matrix3d;
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();

RelativeCurvature exact(const Quadric& finger, const Quadric& object, double angle = 0) {
  return relative_curvature(finger, Matrix3d::Zero(), object, Matrix3d::Zero(), angle);
}

TEST(RelativeCurvature, OfCrossedEqualCylindersIsASphere) {
  const auto cylinder = quadric_from_radii(kInfinity, 0.01);
  const auto r = exact(cylinder, cylinder, kPi / 2);
  EXPECT_EQ(r.kind, ContactKind::elliptic);
  EXPECT_NEAR(r.radii.major_m, 0.01, 0.01 * kRounding);
  EXPECT_NEAR(r.radii.minor_m, 0.01, 0.01 * kRounding);
  EXPECT_EQ(r.radii.axis_rad, 0);
  EXPECT_EQ(r.radii_std_m[0], 0);
}

TEST(RelativeCurvature, OfCylindersAtAnAngleIsJohnsonsFormula) {
  // K. L. Johnson, Contact Mechanics, eq. (4.4): B - A = sqrt(k1² + k2² + 2 k1 k2 cos 2t) / 2.
  const double k1 = 1 / 0.01, k2 = 1 / 0.03;
  for (double t : {0.1, kPi / 4, 1.0, kPi / 2}) {
    const auto r =
        exact(quadric_from_radii(kInfinity, 1 / k1), quadric_from_radii(kInfinity, 1 / k2), t);
    const double difference = std::sqrt(k1 * k1 + k2 * k2 + 2 * k1 * k2 * std::cos(2 * t));
    EXPECT_NEAR(1 / r.radii.minor_m, (k1 + k2 + difference) / 2, k1 * kRounding);
    EXPECT_NEAR(1 / r.radii.major_m, (k1 + k2 - difference) / 2, k1 * kRounding);
  }
}

TEST(RelativeCurvature, TurnsCounterClockwiseWithTheObject) {
  const auto sphere = quadric_from_radii(0.05, 0.05), barrel = quadric_from_radii(0.04, 0.01);
  for (double angle : {-1.2, -kPi / 4, 0.0, 0.3, kPi / 4, kPi / 2}) {
    const auto r = exact(sphere, barrel, angle);
    EXPECT_NEAR(r.radii.axis_rad, angle, kRounding);  // the object's x axis is its flattest
    EXPECT_NEAR(1 / r.radii.major_m, 20 + 25, 45 * kRounding);
    EXPECT_NEAR(1 / r.radii.minor_m, 20 + 100, 120 * kRounding);
  }
}

TEST(RelativeCurvature, SumOfCurvaturesDoesNotDependOnTheAngle) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> k(1, 100), turn(-4, 4);
  for (int i = 0; i < 1000; ++i) {
    const Quadric f{k(random), k(random), k(random) / 100}, o{k(random), k(random), 0.3};
    const auto r = exact(f, o, turn(random));
    const double sum = 2 * (f.A_per_m + f.B_per_m + o.A_per_m + o.B_per_m);
    EXPECT_NEAR(r.curvatures_per_m[0] + r.curvatures_per_m[1], sum, sum * kRounding);
    EXPECT_GT(r.radii.axis_rad, -kPi / 2);
    EXPECT_LE(r.radii.axis_rad, kPi / 2);
  }
}

TEST(RelativeCurvature, OfRoundOnRoundHasItsRadiiInOrder) {
  // 12 mm on 7 mm and 6 mm on 33 mm came out with R' an ulp below R'', which every model refuses.
  for (int finger_mm = 1; finger_mm <= 40; ++finger_mm)
    for (int object_mm = 1; object_mm <= 40; ++object_mm) {
      const double finger_m = finger_mm * 1e-3, object_m = object_mm * 1e-3;
      const auto relative =
          exact(quadric_from_radii(finger_m, finger_m), quadric_from_radii(object_m, object_m));
      EXPECT_EQ(relative.kind, ContactKind::elliptic);
      EXPECT_GE(relative.radii.major_m, relative.radii.minor_m) << finger_mm << " " << object_mm;
    }
}

TEST(RelativeCurvature, OfAConvexInALessCurvedConcaveBodyIsElliptic) {
  const auto r = exact(quadric_from_radii(0.01, 0.01), quadric_from_radii(-0.03, -0.02));
  EXPECT_EQ(r.kind, ContactKind::elliptic);
  EXPECT_NEAR(r.radii.major_m, 1 / (100 - 50.0), 0.02 * kRounding);
  EXPECT_NEAR(r.radii.minor_m, 1 / (100 - 100.0 / 3), 0.02 * kRounding);
  EXPECT_NEAR(r.radii.axis_rad, kPi / 2, kRounding);
}

TEST(RelativeCurvature, SaysWhereThereIsNoEllipse) {
  const auto flat = Quadric{}, ball = quadric_from_radii(0.01, 0.01);
  const auto rod = quadric_from_radii(kInfinity, 0.01), socket = quadric_from_radii(-0.01, -0.01);
  EXPECT_EQ(exact(flat, flat).kind, ContactKind::conforming);
  EXPECT_EQ(exact(ball, socket).kind, ContactKind::conforming);
  EXPECT_EQ(exact(rod, flat).kind, ContactKind::line);
  EXPECT_EQ(exact(rod, rod).kind, ContactKind::line);
  EXPECT_EQ(exact(flat, quadric_from_radii(0.01, -0.1)).kind, ContactKind::saddle);
  EXPECT_EQ(exact(ball, quadric_from_radii(-0.005, -0.005)).kind, ContactKind::saddle);
  EXPECT_EQ(exact(rod, flat).radii.major_m, 0);
}

TEST(RelativeCurvature, KeepsVeryLongEllipses) {
  const auto r = exact(quadric_from_radii(1e6, 0.01), Quadric{});
  EXPECT_EQ(r.kind, ContactKind::elliptic);
  EXPECT_NEAR(r.radii.major_m / 1e6, 1, kRounding);
}

TEST(RelativeCurvature, UncertaintyAgreesWithRandomDraws) {
  Matrix3d finger_covariance, object_covariance;
  finger_covariance << 1.0, 0.3, -0.2, 0.3, 2.0, 0.1, -0.2, 0.1, 0.5;
  object_covariance << 0.8, -0.1, 0.3, -0.1, 1.5, 0.2, 0.3, 0.2, 1.1;
  // Small against the difference of the curvatures, so that first order is all there is.
  finger_covariance *= 1e-2;
  object_covariance *= 1e-2;
  const Quadric f{40, 15, 5}, o{30, 5, -4};
  const double angle = 0.7;
  const auto r = relative_curvature(f, finger_covariance, o, object_covariance, angle);

  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const Matrix3d lf = finger_covariance.llt().matrixL(), lo = object_covariance.llt().matrixL();
  const int draws = 20000;
  double sum[2] = {}, sum2[2] = {};
  for (int i = 0; i < draws; ++i) {
    const Eigen::Vector3d df = lf * Eigen::Vector3d::NullaryExpr([&] { return normal(random); });
    const Eigen::Vector3d d = lo * Eigen::Vector3d::NullaryExpr([&] { return normal(random); });
    const auto drawn = exact({f.A_per_m + df[0], f.B_per_m + df[1], f.C_per_m + df[2]},
                             {o.A_per_m + d[0], o.B_per_m + d[1], o.C_per_m + d[2]}, angle);
    const double radii[2] = {drawn.radii.major_m, drawn.radii.minor_m};
    for (int k : {0, 1}) {
      sum[k] += radii[k] / draws;
      sum2[k] += radii[k] * radii[k] / draws;
    }
  }
  for (int k : {0, 1}) {
    const double drawn_std = std::sqrt(sum2[k] - sum[k] * sum[k]);
    // 20000 draws know a standard deviation to 1/sqrt(40000) = 0.5 %: four of those, and 1 % for
    // the second order.
    EXPECT_NEAR(r.radii_std_m[k] / drawn_std, 1, 0.03);
  }
}

TEST(RelativeCurvature, WithinItsUncertaintyAFlatDirectionIsALineNotASaddle) {
  const Matrix3d uncertain = 0.25 * Matrix3d::Identity();
  const auto r = relative_curvature({-0.2, 50, 0}, uncertain, {}, Matrix3d::Zero(), 0);
  EXPECT_EQ(r.kind, ContactKind::line);
  EXPECT_EQ(exact({-0.2, 50, 0}, {}).kind, ContactKind::saddle);
}

TEST(RelativeCurvature, TwoNoisyFlatsConformAndANoisyRodIsALine) {
  const Matrix3d uncertain = 4.0 * Matrix3d::Identity();  // curvatures to 4 per metre
  const auto kind = [&](const Quadric& finger) {
    return relative_curvature(finger, uncertain, {}, Matrix3d::Zero(), 0).kind;
  };
  EXPECT_EQ(kind({1.0, -1.5, 0.5}), ContactKind::conforming);
  EXPECT_EQ(kind({0.5, 100, 0}), ContactKind::line);
  EXPECT_EQ(kind({-3, 100, 0}), ContactKind::line);
  EXPECT_EQ(kind({-30, 100, 0}), ContactKind::saddle);
  EXPECT_EQ(kind({4, 100, 0}), ContactKind::elliptic);  // its length is known badly
  // Nothing is known of the noise: the values decide.
  const Matrix3d unknown = Matrix3d::Constant(kInfinity);
  EXPECT_EQ(relative_curvature({4, 100, 0}, unknown, {}, Matrix3d::Zero(), 0).kind,
            ContactKind::elliptic);
}

TEST(RelativeCurvature, CarriesTheUncertaintyOfTheRadiiThroughToAQuantity) {
  Matrix3d covariance;
  covariance << 1.0, 0.3, -0.2, 0.3, 2.0, 0.1, -0.2, 0.1, 0.5;
  covariance *= 1e-2;
  const auto r = relative_curvature({40, 15, 5}, covariance, {}, Matrix3d::Zero(), 0);
  const Eigen::Matrix2d& s = r.log_radii_covariance;
  // A power law has constant derivatives in the logarithms.
  const double p = 0.4, q = -0.15;
  const auto power = [&](const RelativeRadii& radii) {
    return 3 * std::pow(radii.major_m, p) * std::pow(radii.minor_m, q);
  };
  const auto std_of = [](const RelativeCurvature& relative, const auto& quantity) {
    const Eigen::VectorXd std = propagated_std(
        relative, [&](const RelativeRadii& radii) { return Eigen::Vector2d(1, quantity(radii)); });
    EXPECT_EQ(std.size(), 2);
    return std[1];
  };
  const double relative = std::sqrt(p * p * s(0, 0) + 2 * p * q * s(0, 1) + q * q * s(1, 1));
  // The differences' third order, (1e-3)² / 3.
  EXPECT_NEAR(std_of(r, power) / power(r.radii) / relative, 1, 1e-6);
  // R' itself: as radii_std_m, which adds the second order, 2 std/R'.
  const double major_std = std_of(r, [](const RelativeRadii& radii) { return radii.major_m; });
  EXPECT_NEAR(r.radii_std_m[0] / major_std, 1, 4 * major_std / r.radii.major_m);

  EXPECT_EQ(std_of(exact({40, 15, 5}, {}), power), 0);
  EXPECT_TRUE(std::isnan(std_of(exact({40, -15, 5}, {}), power)));
  // At an umbilic point the radii may only part, never cross.
  const auto round = relative_curvature({15, 15, 0}, covariance, {}, Matrix3d::Zero(), 0);
  const double std = std_of(round, [](const RelativeRadii& radii) {
    EXPECT_GE(radii.major_m, radii.minor_m);
    return std::sqrt(radii.major_m * radii.minor_m);
  });
  EXPECT_GT(std, 0);
  EXPECT_LT(std, round.radii_std_m[1]);  // the mean is known better than either
}

}  // namespace
}  // namespace softfinger
