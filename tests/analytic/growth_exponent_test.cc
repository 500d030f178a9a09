#include "softfinger/layer/growth_exponent.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "softfinger/layer/bonded_layer.h"

namespace softfinger {
namespace {

// An independent Fredholm solution, to three decimals.
TEST(GrowthExponent, EqualsThePublishedFingerprintToItsLastDigit) {
  constexpr std::array<double, 10> kSizes = {0.1, 0.3, 0.5, 0.7, 1, 1.4, 2, 3, 4, 6};
  struct Row {
    double poisson_ratio;
    std::array<double, 10> exponents;
  };
  constexpr std::array<Row, 4> kRows = {
      {{0.3, {0.333, 0.329, 0.320, 0.308, 0.292, 0.279, 0.269, 0.262, 0.259, 0.255}},
       {0.45, {0.333, 0.328, 0.316, 0.301, 0.282, 0.267, 0.254, 0.244, 0.240, 0.237}},
       {0.49, {0.333, 0.328, 0.314, 0.298, 0.277, 0.260, 0.245, 0.231, 0.222, 0.214}},
       {0.5, {0.333, 0.327, 0.313, 0.297, 0.276, 0.258, 0.242, 0.226, 0.216, 0.203}}}};
  int compared = 0;
  for (const Row& row : kRows)
    for (std::size_t i = 0; i < kSizes.size(); ++i) {
      const double exponent = layer_growth_exponent(kSizes[i], row.poisson_ratio);
      EXPECT_EQ(std::lround(1000 * exponent), std::lround(1000 * row.exponents[i]))
          << "nu " << row.poisson_ratio << ", s " << kSizes[i] << ": " << exponent;
      ++compared;
    }
  EXPECT_EQ(compared, 40);
}

TEST(GrowthExponent, IsInvertedByTheSize) {
  for (const double nu : {0., 0.3, 0.45, 0.49, 0.5})
    for (const double s : {0.2, 0.7, 1.5, 3.}) {
      const double exponent = layer_growth_exponent(s, nu);
      // Beyond the minimum several sizes have one exponent, and the smallest is found: not this s.
      if (exponent <= smallest_layer_exponent(nu) + 1e-3) continue;
      const auto found = layer_size_of_exponent(exponent, nu);
      ASSERT_TRUE(found) << "nu " << nu << ", s " << s;
      // gamma is known to 1e-6, and its slope over ln s is 0.01 at least.
      EXPECT_NEAR(std::log(*found / s), 0, 2e-6 / 0.01);
    }
}

TEST(GrowthExponent, OfTheTorqueArmIsThatOfTheRadiusInTheLimits) {
  // In the limits the pressure keeps its shape; the correction of a thick layer is of the order of
  // s³.
  EXPECT_NEAR(layer_growth_exponent(0.05, 0.49, Growing::torque_arm), 1. / 3, std::pow(0.05, 3));
  // In between the pressure flattens the less, the larger s is.
  const double arm = layer_growth_exponent(1.5, 0.49, Growing::torque_arm);
  EXPECT_LT(arm, layer_growth_exponent(1.5, 0.49));
  EXPECT_NEAR(std::log(layer_size_of_exponent(arm, 0.49, Growing::torque_arm).value_or(1) / 1.5), 0,
              2e-6 / 0.01);
}

TEST(GrowthExponent, HasNoSizeBeyondTheLimits) {
  EXPECT_FALSE(layer_size_of_exponent(1. / 3, 0.49));
  EXPECT_FALSE(layer_size_of_exponent(0.16, 0.5));
  EXPECT_FALSE(layer_size_of_exponent(0.22, 0.3));
}

TEST(GrowthExponent, LeadsToTheLayerThatHasIt) {
  constexpr double kSize = 1.4, kContact_m = 4e-3, kLoad_N = 2, kSphere_m = 0.03, kRubber = 0.49;
  const MatchedLayer found = match_layer(kSize, kContact_m, kLoad_N, kSphere_m, kRubber);
  EXPECT_NEAR(found.thickness_m * kSize, kContact_m, 1e-15 * kContact_m);
  // The fast model knows a, and with it the torque arm, within 0.5 %.
  const BondedLayerContact contact = bonded_layer_contact(
      {kSphere_m, kSphere_m, 0}, {found.thickness_m, found.youngs_modulus_Pa, kRubber}, kLoad_N);
  EXPECT_NEAR(contact.a_m, kContact_m, 0.005 * kContact_m);
  EXPECT_NEAR(contact.torque_arm_exact_m, found.torque_arm_over_a * kContact_m, 0.005 * kContact_m);
  // E grows with the load and the sphere's radius.
  EXPECT_NEAR(match_layer(kSize, kContact_m, 3 * kLoad_N, kSphere_m, kRubber).youngs_modulus_Pa,
              3 * found.youngs_modulus_Pa, 1e-12 * found.youngs_modulus_Pa);
  EXPECT_NEAR(match_layer(kSize, kContact_m, kLoad_N, 2 * kSphere_m, kRubber).youngs_modulus_Pa,
              2 * found.youngs_modulus_Pa, 1e-12 * found.youngs_modulus_Pa);
}

}  // namespace
}  // namespace softfinger
