#include "softfinger/layer/stuck_contact.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "layer_reference.h"
#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

using Three = std::array<double, 3>;

/// A layer of thickness 1 with G = 1, solved numerically.
Three solved(double a, double b, double poisson_ratio) {
  const StuckLayerStiffness stiffness =
      stuck_layer_stiffness(a, b, LayerKernel(poisson_ratio), sufficient_stuck_resolution(a, b));
  return {stiffness.torsional, stiffness.tangential_x, stiffness.tangential_y};
}

TEST(LayerKernel, TangentialComplianceSolvesThePlaneStrainProblem) {
  for (const double nu : {0.0, 0.3, 0.45})
    for (const double k : {0.2, 1.0, 3.0, 6.0}) {
      // u_x = U(z) cos kx, u_z = W(z) sin kx with (U, W) = (1, s) exp(s k z) and
      // (z, s z - kappa/k) exp(s k z), s = 1 or -1. Fixed at z = 0; at z = 1 no normal stress and
      // the shear stress G.
      const double kappa = 3 - 4 * nu, lame = 2 * nu / (1 - 2 * nu);  // lambda/G
      Eigen::Matrix4d conditions;
      Eigen::RowVector4d surface;
      for (int i = 0; i < 4; ++i) {
        const double s = i % 2 ? -1 : 1, e = std::exp(s * k);
        const bool linear = i >= 2;
        const double U = e, W = linear ? (s - kappa / k) * e : s * e;
        const double dU = s * k * U + (linear ? e : 0), dW = s * k * W + (linear ? s * e : 0);
        conditions.col(i) << (linear ? 0 : 1), (linear ? -kappa / k : s), dU + k * W,
            lame * (dW - k * U) + 2 * dW;
        surface[i] = U;
      }
      const double u = surface * conditions.lu().solve(Eigen::Vector4d(0, 0, 1, 0));
      const double of_half_space = (1 - nu) / k;
      // exp(2 k) = 2e5 is what the elimination may lose.
      EXPECT_NEAR(1 - u / of_half_space, LayerKernel(nu).tangential_stiffening(k), 1e-10)
          << nu << " " << k;
    }
  // A thin layer is sheared by h/G, the half-space by (1 - nu)/(G k).
  EXPECT_NEAR((1 - LayerKernel(0.5).tangential_stiffening(1e-4)) * 0.5 / 1e-4, 1, 1e-7);
  EXPECT_NEAR(LayerKernel::antiplane_stiffening(0.7), 1 - std::tanh(0.7), 1e-15);
}

TEST(StuckContact, EqualsPublishedTorsionOfTheDisc) {
  double worst = 0;
  for (const testing::TorsionRow& row : testing::kTorsionRows)
    for (const double nu : {0.0, 0.5}) {
      const double scale = 16.0 / 3 * std::pow(row.s, 3) * row.stiffness;
      worst = std::max(worst, std::abs(solved(row.s, row.s, nu)[0] / scale - 1));
    }
  std::printf("stuck_layer_stiffness: torsion of the disc, largest relative error %.1e\n", worst);
  EXPECT_LT(worst, 2e-7);  // the published precision is 1e-7
}

TEST(StuckContact, HasTheExpansionsOfThickAndThinLayers) {
  // Thick: k_t/(16 G a³/3) = 1 + zeta(3)/(4 pi) s³ + O(s^5).
  const double zeta3 = 1.2020569031595943, s = 0.05;
  EXPECT_NEAR((solved(s, s, 0.3)[0] / (16.0 / 3 * s * s * s) - 1) / (zeta3 / (4 * kPi) * s * s * s),
              1, 2 * s * s);
  // Thin: the layer beside the edge carries as much as a strip of that width that is sheared along
  // the edge (Wiener-Hopf), (2 ln 2/pi) h, or across it,
  //   -(h/pi) int_0^inf ln[(1 - nu) w_t(x)/x]/x² dx,
  // by quadrature 0.49855 (nu = 0) and 0.99539 (1/2).
  const double along = 2 * std::log(2) / kPi;
  for (const auto& [nu, across] : {std::pair{0.0, 0.49855}, std::pair{0.5, 0.99539}}) {
    const double a = 100;
    const Three stiffness = solved(a, a, nu);
    EXPECT_NEAR(stiffness[1] / (kPi * a * a), 1 + (along + across) / a, 0.5 / (a * a));
    EXPECT_NEAR(stiffness[0] / (kPi / 2 * std::pow(a, 4)), 1 + 4 * along / a, 1.5 / (a * a));
  }
}

TEST(StuckContact, HasConvergedAtTheSufficientResolution) {
  double worst = 0;
  for (const double aspect : {1.0, 4.0, 20.0})
    for (const double size : {0.5, 5.0, 30.0}) {
      const double a = size * std::sqrt(aspect), b = size / std::sqrt(aspect);
      const SpectralResolution resolution = sufficient_stuck_resolution(a, b);
      const StuckLayerStiffness finer = stuck_layer_stiffness(
          a, b, LayerKernel(0.45), {3 * resolution.radial / 2, 3 * resolution.angular / 2});
      const Three coarse = solved(a, b, 0.45);
      worst = std::max({worst, std::abs(coarse[0] / finer.torsional - 1),
                        std::abs(coarse[1] / finer.tangential_x - 1),
                        std::abs(coarse[2] / finer.tangential_y - 1)});
    }
  std::printf("stuck_layer_stiffness: change with half as many terms more %.1e\n", worst);
  EXPECT_LT(worst, 1e-5);
}

}  // namespace
}  // namespace softfinger
