#include "softfinger/math/elliptic_integrals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "quadrature.h"
#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

TEST(EllipticIntegrals, AgreeWithQuadratureFromCircleToNeedle) {
  for (const double q :
       {1.0, 1 - 1e-15, 1 - 1e-9, 0.999, 0.75, 0.25, 1e-2, 1e-4, 1e-8, 1e-12, 1e-17}) {
    const auto integral = [&](auto numerator) {
      return double(testing::integrate_quadrant(0.125L, 62, [&](long double s, long double c) {
        return numerator(s, c) / std::sqrt(c * c + q * s * s);
      }));
    };
    using Real = long double;
    const EllipticIntegrals integrals = elliptic_integrals(q);
    // Some ten roundings of positive terms.
    const double tolerance = 1e-14;
    EXPECT_NEAR(integrals.B / integral([](Real, Real c) { return c * c; }), 1, tolerance) << q;
    EXPECT_NEAR(integrals.D / integral([](Real s, Real) { return s * s; }), 1, tolerance) << q;
    EXPECT_NEAR(integrals.K() / integral([](Real, Real) { return Real(1); }), 1, tolerance) << q;
    EXPECT_NEAR(integrals.E() / integral([&](Real s, Real c) { return c * c + q * s * s; }), 1,
                tolerance)
        << q;
  }
}

TEST(EllipticIntegrals, AreQuarterPiAtTheCircle) {
  const EllipticIntegrals integrals = elliptic_integrals(1);
  EXPECT_NEAR(integrals.B, kPi / 4, 2 * kEpsilon);
  EXPECT_NEAR(integrals.D, kPi / 4, 2 * kEpsilon);
  EXPECT_EQ(integrals.K_minus_E(), 0);
  EXPECT_EQ(integrals.E_minus_qK(), 0);
}

TEST(EllipticIntegrals, SatisfyLegendresRelation) {
  for (double q = 0.01; q < 1; q += 0.01) {
    const EllipticIntegrals one = elliptic_integrals(q), other = elliptic_integrals(1 - q);
    const double sum = one.E() * other.K() + other.E() * one.K() - one.K() * other.K();
    EXPECT_NEAR(sum, kPi / 2, 50 * kEpsilon) << q;  // terms up to 6, a difference of them
  }
}

TEST(EllipticIntegrals, ApproachTheirLogarithmWhenDegenerate) {
  for (const double q : {1e-20, 1e-100, 1e-290}) {
    const double K = std::log(4.0) - 0.5 * std::log(q);  // next term: q ln(q)
    // Some twenty operations and a logarithm.
    EXPECT_NEAR(elliptic_integrals(q).K() / K, 1, 20 * kEpsilon) << q;
    EXPECT_NEAR(elliptic_integrals(q).E(), 1, 20 * kEpsilon) << q;
  }
  EXPECT_TRUE(std::isfinite(elliptic_integrals(0).K()));
  EXPECT_NEAR(elliptic_integrals(0).E(), 1, 20 * kEpsilon);
}

}  // namespace
}  // namespace softfinger
