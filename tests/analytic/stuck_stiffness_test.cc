#include "softfinger/layer/stuck_stiffness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "layer_reference.h"
#include "softfinger/input/constants.h"
#include "softfinger/layer/stuck_contact.h"
#include "tests/allocation_counter.h"

namespace softfinger {
namespace {

/// The stated accuracy; 7.1e-4 was measured when the table was made (some 3,000 points).
constexpr double kStated = 1e-3;

using Three = std::array<double, 3>;

Three three(const StuckStiffness& stiffness) {
  return {stiffness.torsional_Nm_per_rad, stiffness.tangential_x_N_per_m,
          stiffness.tangential_y_N_per_m};
}

/// A layer of thickness 1 with G = 1, solved numerically.
Three exact(double a, double b, double poisson_ratio) {
  const StuckLayerStiffness stiffness =
      stuck_layer_stiffness(a, b, LayerKernel(poisson_ratio), sufficient_stuck_resolution(a, b));
  return {stiffness.torsional, stiffness.tangential_x, stiffness.tangential_y};
}

/// Stiffnesses of this layer from the table.
Three tabulated(double a, double b, double poisson_ratio) {
  return three(stuck_stiffness(a, b, 1.0, 2 * (1 + poisson_ratio), poisson_ratio));
}

// The half-space's closed forms are not part of the numerical solution.
TEST(StuckStiffness, TendsToWhatTheSpectralSolutionTendsToOnAHalfSpace) {
  for (const double aspect : {1.0, 1.001, 2.0, 20.0, 100.0})
    for (const double nu : {0.0, 0.3, 0.5}) {
      const double b = 1e-6, a = aspect * b;
      const Three numerical = exact(a, b, nu),
                  closed = three(half_space_stuck_stiffness(a, b, 1.0, nu));
      EXPECT_NEAR(numerical[0] / closed[0], 1, 1e-11) << aspect << " " << nu;
      for (const int i : {1, 2})  // the base is felt to first order in a/h
        EXPECT_NEAR(numerical[std::size_t(i)] / closed[std::size_t(i)], 1, a) << aspect;
    }
}

TEST(StuckStiffness, EqualsMindlinsCircleAndTheDiscOnAHalfSpace) {
  for (const double nu : {0.0, 0.3, 0.5}) {
    const double a_m = 0.002, shear_modulus_Pa = 1e5;
    const StuckStiffness stiffness = half_space_stuck_stiffness(a_m, a_m, shear_modulus_Pa, nu);
    const double shift = 8 * shear_modulus_Pa * a_m / (2 - nu);
    EXPECT_NEAR(stiffness.tangential_x_N_per_m / shift, 1, 4e-15);
    EXPECT_NEAR(stiffness.tangential_y_N_per_m / shift, 1, 4e-15);
    EXPECT_NEAR(stiffness.torsional_Nm_per_rad / (16.0 / 3 * shear_modulus_Pa * std::pow(a_m, 3)),
                1, 4e-15);
  }
}

TEST(StuckStiffness, EqualsPublishedTorsionOfTheDisc) {
  double worst = 0;
  for (const testing::TorsionRow& row : testing::kTorsionRows)
    worst = std::max(worst, std::abs(tabulated(row.s, row.s, 0.3)[0] /
                                         (16.0 / 3 * std::pow(row.s, 3) * row.stiffness) -
                                     1));
  std::printf("stuck_stiffness: published torsion of the disc, largest relative error %.1e\n",
              worst);
  EXPECT_LT(worst, kStated);
}

TEST(StuckStiffness, KeepsItsStatedErrorAtRandomPoints) {
  std::mt19937_64 random(20070322);
  std::uniform_real_distribution<double> uniform(0, 1);
  Three worst{};
  for (int i = 0; i < 300; ++i) {
    const double size = std::exp(std::log(0.005) + std::log(100 / 0.005) * uniform(random));
    const double aspect = std::exp(std::log(20) * uniform(random));
    // Also close to 1/2 and to 0.
    const double nu = i % 3 ? 0.5 * uniform(random) : (i % 2 ? 0.5 - 0.02 * uniform(random) : 0);
    const double a = size * std::sqrt(aspect), b = size / std::sqrt(aspect);
    const Three truth = exact(a, b, nu), stiffness = tabulated(a, b, nu);
    for (std::size_t k = 0; k < 3; ++k)
      worst[k] = std::max(worst[k], std::abs(stiffness[k] / truth[k] - 1));
  }
  std::printf("stuck_stiffness: random points, largest relative error k_t %.1e k_x %.1e k_y %.1e\n",
              worst[0], worst[1], worst[2]);
  for (const double error : worst) EXPECT_LT(error, kStated);
}

TEST(StuckStiffness, TendsToBothLimitsExactly) {
  for (const double aspect : {1.0, 3.0, 20.0, 1000.0})
    for (const double nu : {0.0, 0.49, 0.5}) {
      const double b = 1e-3, a = aspect * b, E = 2 * (1 + nu);
      const Three thick = three(stuck_stiffness(a, b, 1e9 * a, E, nu)),
                  half_space = three(half_space_stuck_stiffness(a, b, 1.0, nu));
      const Three thin = three(stuck_stiffness(a, b, 1e-9 * b, E, nu)),
                  sheared = three(thin_layer_stuck_stiffness(a, b, 1e-9 * b, 1.0));
      for (std::size_t k = 0; k < 3; ++k) {
        // The remaining difference is of first order in s or 1/s, with factors of a few.
        EXPECT_NEAR(thick[k] / half_space[k], 1, 1e-8) << aspect << " " << nu;
        EXPECT_NEAR(thin[k] / sheared[k], 1, 1e-8 * aspect) << aspect << " " << nu;
      }
    }
}

TEST(StuckStiffness, ExchangesItsAxesWithTheSemiAxes) {
  for (const double nu : {0.0, 0.3, 0.5})
    for (const double size : {0.01, 1.0, 30.0}) {
      const Three circle = tabulated(size, size, nu);
      EXPECT_EQ(circle[1], circle[2]);
      const Three along = tabulated(3 * size, size, nu), across = tabulated(size, 3 * size, nu);
      // Round-off of the integrals, of which a few digits cancel.
      EXPECT_NEAR(along[0] / across[0], 1, 1e-13);
      EXPECT_NEAR(along[1] / across[2], 1, 1e-13);
      EXPECT_NEAR(along[2] / across[1], 1, 1e-13);
    }
}

TEST(StuckStiffness, DoesNotDependOnTheUnits) {
  const StuckStiffness in_m = stuck_stiffness(0.003, 0.001, 0.002, 3e5, 0.45),
                       in_mm = stuck_stiffness(3.0, 1.0, 2.0, 0.3, 0.45);  // N/mm, N mm
  EXPECT_NEAR(in_m.torsional_Nm_per_rad / (1e-3 * in_mm.torsional_Nm_per_rad), 1, 1e-14);
  EXPECT_NEAR(in_m.tangential_x_N_per_m / (1e3 * in_mm.tangential_x_N_per_m), 1, 1e-14);
  EXPECT_NEAR(in_m.tangential_y_N_per_m / (1e3 * in_mm.tangential_y_N_per_m), 1, 1e-14);
}

// A larger stuck ellipse constrains more of the surface, and a thinner layer or a larger nu at
// given G yields less.
TEST(StuckStiffness, GrowsWithTheContactAndWithPoissonsRatioAndFallsWithThickness) {
  for (double log_size = std::log(1e-4); log_size < std::log(1e4); log_size += 0.05)
    for (double log_aspect = 0; log_aspect < std::log(20); log_aspect += 0.1)
      for (const double nu : {0.0, 0.1, 0.2, 0.3, 0.4, 0.45, 0.49}) {
        const double a = std::exp(log_size + 0.5 * log_aspect),
                     b = std::exp(log_size - 0.5 * log_aspect);
        const Three here = tabulated(a, b, nu), longer = tabulated(1.02 * a, b, nu),
                    wider = tabulated(a, 1.02 * b, nu), firmer = tabulated(a, b, nu + 0.01),
                    thinner = three(stuck_stiffness(a, b, 0.98, 2 * (1 + nu), nu));
        for (std::size_t k = 0; k < 3; ++k) {
          ASSERT_GT(longer[k], here[k]) << k << " " << a << " " << b << " " << nu;
          ASSERT_GT(wider[k], here[k]) << k << " " << a << " " << b << " " << nu;
          ASSERT_GT(thinner[k], here[k]) << k << " " << a << " " << b << " " << nu;
          // The torsion of a disc and the stiffness of thin layers depend on nu by less than the
          // table's error.
          ASSERT_GT(firmer[k], here[k] * (1 - 1e-4)) << k << " " << a << " " << b << " " << nu;
        }
      }
}

TEST(StuckStiffness, StaysFiniteAndPositiveFarOutsideOfItsTable) {
  for (double a_m = 1e-12; a_m < 1e13; a_m *= 10)
    for (double b_m = 1e-12; b_m < 1e13; b_m *= 10)
      for (double thickness_m = 1e-12; thickness_m < 1e13; thickness_m *= 10)
        for (const double nu : {0.0, 0.3, 0.5}) {
          const Three stiffness = three(stuck_stiffness(a_m, b_m, thickness_m, 1e5, nu));
          const Three limit = three(half_space_stuck_stiffness(a_m, b_m, 0.5e5 / (1 + nu), nu));
          for (std::size_t k = 0; k < 3; ++k) {
            ASSERT_TRUE(std::isfinite(stiffness[k])) << a_m << " " << b_m << " " << thickness_m;
            ASSERT_GT(stiffness[k], 0.7 * limit[k]) << a_m << " " << b_m << " " << thickness_m;
          }
        }
}

/// The least of a number with a derivative that the formula asks for.
struct Slope {
  double value = 0, slope = 0;
};
Slope operator+(Slope x, Slope y) { return {x.value + y.value, x.slope + y.slope}; }
Slope operator-(Slope x, Slope y) { return {x.value - y.value, x.slope - y.slope}; }
Slope operator*(Slope x, Slope y) {
  return {x.value * y.value, x.slope * y.value + x.value * y.slope};
}
Slope operator/(Slope x, Slope y) {
  return {x.value / y.value, (x.slope - x.value / y.value * y.slope) / y.value};
}
Slope operator+(Slope x, double y) { return x + Slope{y}; }
Slope operator+(double x, Slope y) { return Slope{x} + y; }
Slope operator-(double x, Slope y) { return Slope{x} - y; }
Slope operator*(Slope x, double y) { return x * Slope{y}; }
Slope operator*(double x, Slope y) { return Slope{x} * y; }
Slope operator/(double x, Slope y) { return Slope{x} / y; }
Slope sqrt(Slope x) {
  const double root = std::sqrt(x.value);
  return {root, 0.5 * x.slope / root};
}

/// d ln k/d ln(argument i), for nu d ln k/d nu.
Three carried_slope(const std::array<double, 5>& at, std::size_t i) {
  std::array<Slope, 5> x;
  for (std::size_t j = 0; j < 5; ++j) x[j].value = at[j];
  x[i].slope = i == 4 ? 1 : at[i];
  const auto stiffness = stuck_stiffness(x[0], x[1], x[2], x[3], x[4]);
  const auto relative = [](Slope k) { return k.slope / k.value; };
  return {relative(stiffness.torsional_Nm_per_rad), relative(stiffness.tangential_x_N_per_m),
          relative(stiffness.tangential_y_N_per_m)};
}

/// Relative slopes by central differences of sixth order.
Three difference_slope(const std::array<double, 5>& at, std::size_t i) {
  constexpr double kStep = 4e-3;
  const auto moved = [&](double by) {
    std::array<double, 5> x = at;
    x[i] = i == 4 ? at[i] + by : at[i] * std::exp(by);
    Three result = three(stuck_stiffness(x[0], x[1], x[2], x[3], x[4]));
    for (double& k : result) k = std::log(k);
    return result;
  };
  Three result{};
  constexpr double kWeight[] = {45, -9, 1};
  for (int n = 1; n <= 3; ++n) {
    const Three upper = moved(n * kStep), lower = moved(-n * kStep);
    for (std::size_t k = 0; k < 3; ++k)
      result[k] += kWeight[n - 1] * (upper[k] - lower[k]) / (60 * kStep);
  }
  return result;
}

TEST(StuckStiffness, CarriesExactDerivatives) {
  double worst = 0;
  for (const double size : {1e-4, 0.005, 0.3, 1.5, 7.0, 100.0, 1e4})
    for (const double aspect : {1.0, 1.0001, 1.7, 20.0, 500.0})
      for (const double nu : {0.0, 0.3, 0.49, 0.5}) {
        const double h_m = 0.002;
        const std::array<double, 5> at = {size * h_m * std::sqrt(aspect),
                                          size * h_m / std::sqrt(aspect), h_m, 3e5, nu};
        for (std::size_t i = 0; i < 5; ++i) {
          const Three carried = carried_slope(at, i), difference = difference_slope(at, i);
          for (std::size_t k = 0; k < 3; ++k)
            worst = std::max(worst, std::abs(carried[k] - difference[k]));
        }
      }
  std::printf("stuck_stiffness: derivatives of ln k against differences %.1e\n", worst);
  EXPECT_LT(worst, 1e-9);  // step^6 and round-off over the step
}

TEST(StuckStiffness, DoesNotAllocate) {
  const std::size_t before = testing::allocations();
  double sum = 0;
  for (const double b_m : {1e-3, 5e-5})
    sum += stuck_stiffness(1e-3, b_m, 2e-3, 3e5, 0.45).torsional_Nm_per_rad;
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_GT(sum, 0);
}

}  // namespace
}  // namespace softfinger
