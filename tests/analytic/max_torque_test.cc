#include "softfinger/friction/max_torque.h"

#include <gtest/gtest.h>

#include <cmath>

#include "quadrature.h"
#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

TEST(MaxTorque, EqualsTwoThirdsForCircularUniformPressure) {
  EXPECT_NEAR(torque_arm_exact_m(1, 1, 0), 2.0 / 3, 1e-15);
  EXPECT_NEAR(torque_arm_paper_m(1, 1, 0), 2.0 / 3, 1e-15);
}

TEST(MaxTorque, EqualsThreeSixteenthsPiForCircularHertz) {
  EXPECT_NEAR(torque_arm_exact_m(1, 1, 0.5), 3 * kPi / 16, 1e-15);
  EXPECT_NEAR(torque_arm_paper_m(1, 1, 0.5), 3 * kPi / 16, 1e-15);
}

TEST(MaxTorque, EqualsEightFifteenthsForCircularWinkler) {
  EXPECT_NEAR(torque_arm_exact_m(1, 1, 1), 8.0 / 15, 1e-15);
  EXPECT_NEAR(torque_arm_paper_m(1, 1, 1), 8.0 / 15, 1e-15);
}

TEST(MaxTorque, EqualsSixteenThirtyFifthsForCircularThinIncompressible) {
  EXPECT_NEAR(torque_arm_exact_m(1, 1, 2), 16.0 / 35, 1e-15);
  EXPECT_NEAR(torque_arm_paper_m(1, 1, 2), 16.0 / 35, 1e-15);
}

TEST(MaxTorque, IsContinuousWhereTheNamedExponentsAreWrittenOut) {
  for (const double exponent : {0.0, 0.5, 1.0, 2.0, 98.0})
    for (const double side : {-1e-12, 1e-12})
      // |d ln(arm)/dn| < 1/2; the gamma functions carry a few roundings each.
      EXPECT_NEAR(torque_arm_exact_m(2, 1, exponent + side) / torque_arm_exact_m(2, 1, exponent), 1,
                  6e-13)
          << exponent;
}

TEST(MaxTorque, EqualsQuadratureOverTheEllipseToAspectTenThousand) {
  testing::WorstError worst("torque arm against quadrature, a/b to 1e4");
  for (const double exponent : {-0.5, 0.0, 0.5, 0.7, 1.0, 2.0, 3.0})
    for (const double aspect : {1.0, 1 + 1e-9, 1.01, 2.0, 10.0, 1e2, 1e3, 1e4}) {
      using Real = long double;
      const Real q = 1 / (Real(aspect) * aspect);
      const Real step = 0.18L, reach = 42;
      // p = (1 - s²)^n with x = a s cos t, y = b s sin t, a = 1, dA = a b s ds dt, s = sin(angle).
      const auto integral = [&](auto f) {
        return testing::integrate_quadrant(step, reach, [&](Real s, Real c) {
          const Real pressure_ds = std::pow(c, 2 * Real(exponent) + 1);
          if (pressure_ds * s < 1e-22L) return Real(0);  // most of the range: saves time
          return pressure_ds * s *
                 testing::integrate_quadrant(step, reach, [&](Real sine, Real cosine) {
                   return f(s * std::sqrt(cosine * cosine + q * sine * sine));
                 });
        });
      };
      const Real moment = integral([](Real r) { return r; });
      const Real load = integral([](Real) { return Real(1); });
      EXPECT_LT(worst.of(torque_arm_exact_m(1, 1 / aspect, exponent), double(moment / load)), 1e-14)
          << "n = " << exponent << ", a/b = " << aspect;
    }
}

// Published to 20 digits: torque / (mu P b).
TEST(MaxTorque, EqualsPublishedNumbers) {
  struct Row {
    double exponent, aspect, arm_over_b;
  };
  testing::WorstError worst("torque arm against published numbers");
  for (const Row& row : {Row{0, 10, 4.3120105290726004533}, Row{0.5, 2, 0.9082920206763446436},
                         Row{0.5, 10, 3.8099757938445897586}, Row{1, 10, 3.4496084232580803626},
                         Row{1.5, 2, 0.756910017230287203}, Row{2, 2, 0.70489802294401830238},
                         Row{3, 10, 2.6282730843871088477}})
    EXPECT_LT(worst.of(torque_arm_exact_m(row.aspect, 1, row.exponent), row.arm_over_b), 1e-14);
}

TEST(MaxTorque, ExceedsThePaperRuleByTheSameFactorForEveryExponent) {
  struct Row {
    double aspect, factor;
  };
  for (const Row& row : {Row{1.5, 1.031}, Row{2, 1.090}, Row{5, 1.495}, Row{10, 2.045}})
    for (const double exponent : {0.5, 1.0, 1.7})
      EXPECT_NEAR(
          torque_arm_exact_m(row.aspect, 1, exponent) / torque_arm_paper_m(row.aspect, 1, exponent),
          row.factor, 5.1e-4);  // the factors are stated to three decimals
}

TEST(MaxTorque, SatisfiesTheRecurrenceOfTheGammaFunction) {
  // Across z = 100, where the gamma functions give way to their asymptotic series.
  for (double exponent = 0.25; exponent < 1000; exponent += 0.25)
    EXPECT_NEAR(torque_arm_exact_m(1, 1, exponent + 1) / torque_arm_exact_m(1, 1, exponent),
                (exponent + 2) / (exponent + 2.5), 1e-14)
        << exponent;
}

TEST(MaxTorque, FallsLikeTheRootOfLargeExponents) {
  // Gamma(3/2) Gamma(n+2)/Gamma(n+5/2) -> sqrt(pi/n)/2 (1 + O(1/n)); pressure becomes a Gaussian.
  for (const double exponent : {1e4, 1e8, 1e12})
    EXPECT_NEAR(torque_arm_exact_m(1, 1, exponent) / (0.5 * std::sqrt(kPi / exponent)), 1,
                2 / exponent + 1e-15);
}

}  // namespace
}  // namespace softfinger
