#include "softfinger/friction/tilt_limit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

constexpr double kA = 3e-3, kB = 1e-3, kLoad_N = 2;

/// The ellipse in cells of equal area.
struct Cell {
  double x_m, y_m;
};
std::vector<Cell> cells() {
  constexpr int kCount = 400;
  std::vector<Cell> result;
  for (int i = 0; i < kCount; ++i)
    for (int j = 0; j < kCount; ++j) {
      const double x = 2 * (i + 0.5) / kCount - 1, y = 2 * (j + 0.5) / kCount - 1;
      if (x * x + y * y < 1) result.push_back({kA * x, kB * y});
    }
  return result;
}

TEST(TiltLimit, IsTheMomentOfTheBestPressureByQuadrature) {
  // All the load goes to the cells that lie farthest out, each filled up to the largest pressure.
  const std::vector<Cell> all = cells();
  const double cell_share = 1. / double(all.size());
  for (const double ratio : {1.1, 1.5, 2., 3., 10.})
    for (const double direction : {0., 0.4, 0.5 * kPi}) {
      std::vector<double> arms;
      for (const Cell& cell : all)
        arms.push_back(std::cos(direction) * cell.x_m + std::sin(direction) * cell.y_m);
      std::sort(arms.rbegin(), arms.rend());
      double left = 1, moment = 0;
      for (const double arm : arms) {
        const double share = std::min(left, ratio * cell_share);
        moment += kLoad_N * share * arm;
        left -= share;
        if (!(left > 0)) break;
      }
      const TiltLimit limit = tilt_limit(kA, kB, kLoad_N, ratio);
      // The support of the limit's ellipse; the cells of the edge are 1e-3 of the radius.
      const double support = std::hypot(std::cos(direction) * limit.about_y_Nm,
                                        std::sin(direction) * limit.about_x_Nm);
      EXPECT_NEAR(moment / support, 1, 3e-3) << ratio << ", " << direction;
    }
}

TEST(TiltLimit, HoldsForRandomPressures) {
  const std::vector<Cell> all = cells();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 50; ++trial) {
    // A smooth pressure without tension: a tilted cap, cut where it would pull.
    const double n = 0.5 + std::abs(uniform(random)), tx = 3 * uniform(random),
                 ty = 3 * uniform(random);
    double load = 0, peak = 0, x = 0, y = 0;
    for (const Cell& cell : all) {
      const double s2 = std::pow(cell.x_m / kA, 2) + std::pow(cell.y_m / kB, 2);
      const double p =
          std::pow(1 - s2, n) * std::max(0., 1 + tx * cell.x_m / kA + ty * cell.y_m / kB);
      load += p;
      peak = std::max(peak, p);
      x += p * cell.x_m;
      y += p * cell.y_m;
    }
    const double ratio = peak * double(all.size()) / load;
    EXPECT_LE(tilt_limit(kA, kB, 1, ratio).utilisation(y / load, -x / load), 1);
    EXPECT_LE(tilt_limit(kA, kB, 1).utilisation(y / load, -x / load), 1);
  }
}

TEST(TiltLimit, HasTheLimitsOfAUniformAndOfAnUnboundedPressure) {
  const TiltLimit none = tilt_limit(kA, kB, kLoad_N, 1), all = tilt_limit(kA, kB, kLoad_N);
  EXPECT_EQ(none.about_x_Nm, 0);
  EXPECT_EQ(none.about_y_Nm, 0);
  EXPECT_EQ(all.about_x_Nm, kLoad_N * kB);
  EXPECT_EQ(all.about_y_Nm, kLoad_N * kA);
  // Half a circle: 4/(3 pi) of the radius.
  EXPECT_NEAR(tilt_limit(kA, kB, kLoad_N, 2).about_y_Nm, kLoad_N * kA * 4 / (3 * kPi), 1e-15);
  double last = 0;
  for (double ratio = 1; ratio < 1e12; ratio *= 1.5) {
    const double moment = tilt_limit(kA, kB, kLoad_N, ratio).about_y_Nm;
    EXPECT_GE(moment, last);
    EXPECT_LT(moment, all.about_y_Nm);
    last = moment;
  }
  EXPECT_NEAR(last / all.about_y_Nm, 1, 1e-6);
}

}  // namespace
}  // namespace softfinger
