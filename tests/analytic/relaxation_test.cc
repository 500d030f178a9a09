#include "softfinger/time/relaxation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "softfinger/input/errors.h"
#include "softfinger/math/gauss_legendre.h"

namespace softfinger {
namespace {

const std::vector<RelaxationTerm> kSilicone = {{0.12, 0.5}, {0.06, 5}, {0.03, 60}};

TEST(Relaxation, FallsFromTheInstantaneousToTheLongTimeModulus) {
  const Relaxation silicone(kSilicone);
  EXPECT_EQ(silicone.modulus(0), 1);
  EXPECT_NEAR(silicone.modulus(5),
              1 - 0.12 * (1 - std::exp(-10.)) - 0.06 * (1 - std::exp(-1.)) -
                  0.03 * (1 - std::exp(-1. / 12)),
              1e-15);
  EXPECT_NEAR(silicone.modulus(std::numeric_limits<double>::infinity()), 0.79, 1e-15);
  EXPECT_EQ(Relaxation().modulus(3), 1);
  EXPECT_EQ(Relaxation().compliance(3), 1);
}

TEST(Relaxation, CreepsAsTheStandardLinearSolidInClosedForm) {
  for (const double share : {1e-9, 0.12, 0.5, 0.999}) {
    const double time_s = 2;
    const Relaxation solid({{share, time_s}});
    for (const double t : {0., 0.1, 2., 7., 1e4}) {
      const double rest = 1 - share;
      const double exact = 1 + share / rest * (1 - std::exp(-t * rest / time_s));
      // 1 - share has the rounding of 1.
      EXPECT_NEAR(solid.compliance(t), exact, 4 * 2.3e-16 / rest * exact) << share << " " << t;
    }
  }
}

TEST(Relaxation, CreepIsTheInverseOfRelaxationByConvolution) {
  const Relaxation silicone(kSilicone);
  const auto& rates = silicone.creep_rates_per_s();
  const auto& amounts = silicone.creep_amounts_per_s();
  for (const double t : {0.01, 0.3, 2., 30., 200.}) {
    // Panels of a fifth of the shortest time: 16 points each integrate to rounding.
    const QuadratureRule rule = composite_gauss_legendre(t, 0.1);
    double sum = silicone.modulus(t);
    for (Eigen::Index k = 0; k < rule.nodes.size(); ++k)
      sum += rule.weights[k] * silicone.modulus(t - rule.nodes[k]) *
             (amounts * (-rates * rule.nodes[k]).exp()).sum();
    EXPECT_NEAR(sum, 1, 1e-12) << t;
  }
}

TEST(Relaxation, CreepIsTheInverseInLaplacesSpaceWhereSharesAreTinyAndTimesAlike) {
  const Relaxation hard({{1e-8, 1e-6}, {0.3, 1}, {1e-7, 1.000001}, {0.2, 1.000002}, {0.4, 1e7}});
  for (double s = 1e-9; s < 1e9; s *= 3) {
    double modulus = 1, compliance = 1;
    for (const RelaxationTerm& term : hard.terms()) modulus -= term.share / (1 + s * term.time_s);
    for (Eigen::Index j = 0; j < hard.creep_rates_per_s().size(); ++j)
      compliance += hard.creep_amounts_per_s()[j] / (s + hard.creep_rates_per_s()[j]);
    EXPECT_NEAR(modulus * compliance, 1, 1e-12) << s;
  }
}

TEST(Relaxation, AddsTheSharesOfEqualTimes) {
  const Relaxation twice({{0.1, 2}, {0.05, 2}}), once({{0.15, 2}});
  EXPECT_EQ(twice.terms().size(), 1u);
  EXPECT_NEAR(twice.compliance(1), once.compliance(1), 1e-15);
}

TEST(Relaxation, RefusesWhatIsNoSolid) {
  EXPECT_THROW(Relaxation({{0.5, 1}, {0.5, 2}}), InputError);
  EXPECT_THROW(Relaxation({{0, 1}}), InputError);
  EXPECT_THROW(Relaxation({{-0.1, 1}}), InputError);
  EXPECT_THROW(Relaxation({{0.1, 0}}), InputError);
  EXPECT_THROW(Relaxation({{0.1, std::numeric_limits<double>::infinity()}}), InputError);
}

TEST(Relaxation, FollowsAPowerLawByTerms) {
  for (const double exponent : {0.02, 0.1, 0.3}) {
    const Relaxation law(power_law_relaxation(exponent, 0.01, 1e4));
    for (double t = 1e-4; t <= 1e4; t *= 2)
      EXPECT_NEAR(law.modulus(t) * std::pow(1 + t / 0.01, exponent), 1, 5e-3) << exponent << t;
  }
  EXPECT_THROW(power_law_relaxation(0.4, 1, 10), InputError);
  EXPECT_THROW(power_law_relaxation(0.1, 1, 0.5), InputError);
}

}  // namespace
}  // namespace softfinger
