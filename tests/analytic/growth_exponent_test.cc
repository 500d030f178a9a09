#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "softfinger/layer/growth_exponent.h"

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
      // Of several sizes with one exponent, which there are beyond the minimum, it is the smallest.
      if (exponent <= smallest_layer_exponent(nu) + 1e-3) continue;
      const auto found = layer_size_of_exponent(exponent, nu);
      ASSERT_TRUE(found) << "nu " << nu << ", s " << s;
      // Twenty halvings of a step of ln 1.25, and the error of 1e-6 of gamma, whose slope in ln s is
      // 0.01 at least.
      EXPECT_NEAR(std::log(*found / s), 0, 0.25 / (1 << 20) + 1e-6 / 0.01);
    }
}

TEST(GrowthExponent, HasNoSizeBeyondTheLimits) {
  EXPECT_FALSE(layer_size_of_exponent(1. / 3, 0.49));
  EXPECT_FALSE(layer_size_of_exponent(0.16, 0.5));
  EXPECT_FALSE(layer_size_of_exponent(0.22, 0.3));
}

TEST(GrowthExponent, LeadsToTheLayerThatHasIt) {
  // h, E and R scale out: the load of any layer by the fast model (within 0.5 % of a, so 2 % of E).
  const auto found = match_layer(0.26, 4e-3, 2, 0.03, 0.49);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->thickness_m * found->s, 4e-3, 1e-15);
  EXPECT_NEAR(found->s, 1.4, 0.01);
  const auto stiffer = match_layer(0.26, 4e-3, 6, 0.03, 0.49);
  EXPECT_NEAR(stiffer->youngs_modulus_Pa / found->youngs_modulus_Pa, 3, 1e-12);
  const auto flatter = match_layer(0.26, 4e-3, 2, 0.06, 0.49);
  EXPECT_NEAR(flatter->youngs_modulus_Pa / found->youngs_modulus_Pa, 2, 1e-12);
}

}  // namespace
}  // namespace softfinger
