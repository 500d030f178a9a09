#include "softfinger/layer/stuck_contact.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

#include "softfinger/input/constants.h"
#include "softfinger/layer/spherical_bessel.h"
#include "softfinger/math/dense_solvers.h"
#include "softfinger/math/gauss_legendre.h"

namespace softfinger {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

enum class Motion { shift, rotation };

/// One function of the expansion of a component of the traction. Its transform is
/// 2 pi a b j_n(q) cos(m psi) or sin(m psi), n = 2 l for a shift and 2 l + 1 for a rotation.
struct TractionMode {
  int component;  ///< 0: along x, 1: along y
  int l, m;
  bool sine;
};

/// Rows and columns l, l' of the layer at one direction of the wave vector:
/// int_0^inf j_n(q) j_n'(q) G k u^/t^ dq for tractions along the wave vector and across it.
struct RadialCompliance {
  MatrixXd along, across;

  /// g = |k|/q.
  RadialCompliance(double g, const LayerKernel& kernel, int parity, int radial) {
    const double half_space = 0.5 * (1 + kernel.compressibility());  // 1 - nu
    // One panel resolves one unit of x = q g and the 12 radians of a product of Bessel functions.
    const QuadratureRule rule =
        composite_gauss_legendre(kLargestLayerWaveNumber / g, std::min(1 / g, 6.0));
    MatrixXd bessel(radial + 1, rule.nodes.size());
    VectorXd along_weight(rule.nodes.size()), across_weight(rule.nodes.size());
    for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
      const double x = rule.nodes[i] * g;
      spherical_bessel(rule.nodes[i], parity, radial, bessel.col(i).data());
      along_weight[i] = half_space * rule.weights[i] * kernel.tangential_stiffening(x);
      across_weight[i] = rule.weights[i] * LayerKernel::antiplane_stiffening(x);
    }
    along = -bessel * along_weight.asDiagonal() * bessel.transpose();
    across = -bessel * across_weight.asDiagonal() * bessel.transpose();
    for (int l = 0; l <= radial; ++l) {
      const double diagonal = kPi / (2 * (2 * (2 * l + parity) + 1));
      along(l, l) += half_space * diagonal;
      across(l, l) += diagonal;
    }
  }
};

/// Fourier coefficients over the directions psi of the wave vector, j = 0, 1, ...: of the
/// components xx and yy of the compliance with cos(2 j psi), of xy with sin(2 j psi).
struct ComplianceHarmonics {
  std::vector<MatrixXd> xx, yy, xy;

  ComplianceHarmonics(double a, double b, const LayerKernel& kernel, int parity, int radial,
                      int count)
      : xx(std::size_t(count), MatrixXd::Zero(radial + 1, radial + 1)), yy(xx), xy(xx) {
    // Trapezoidal rule over a quarter of the circle of directions. It converges like
    // exp(-4 n atanh(b/a)), so that 7 a/b points make e^-28, and it has to resolve the harmonics.
    const int directions = count + 10 + int(7 * std::max(a / b, b / a));
    const bool circle = a == b;
    const RadialCompliance of_circle(1 / a, kernel, parity, circle ? radial : 0);
    for (int i = 0; i <= directions; ++i) {
      const double psi = 0.5 * kPi * i / directions;
      const double x = std::cos(psi) / a, y = std::sin(psi) / b, g = std::hypot(x, y);
      const double weight = (i == 0 || i == directions ? 1 : 2) * kPi / (directions * g);
      const RadialCompliance& radial_part =
          circle ? of_circle : RadialCompliance(g, kernel, parity, radial);
      const double xx_share = x * x / (g * g), xy_share = x * y / (g * g);
      for (int j = 0; j < count; ++j) {
        const double cosine = weight * std::cos(2 * j * psi), sine = weight * std::sin(2 * j * psi);
        xx[std::size_t(j)] +=
            cosine * (xx_share * radial_part.along + (1 - xx_share) * radial_part.across);
        yy[std::size_t(j)] +=
            cosine * ((1 - xx_share) * radial_part.along + xx_share * radial_part.across);
        xy[std::size_t(j)] += sine * xy_share * (radial_part.along - radial_part.across);
      }
    }
  }

  /// The displacement under one mode, weighted by the other one, over ab/G.
  double product(const TractionMode& I, const TractionMode& J) const {
    if (I.component > J.component) return product(J, I);
    const int difference = (J.m - I.m) / 2, sum = (J.m + I.m) / 2;
    if (I.component == J.component) {
      const std::vector<MatrixXd>& same = I.component == 0 ? xx : yy;
      const double sign = I.sine ? -1 : 1;  // of cos(m + m') in cos cos and in sin sin
      return 0.5 * (same[std::size_t(std::abs(difference))](I.l, J.l) +
                    sign * same[std::size_t(sum)](I.l, J.l));
    }
    // cos m sin m' = (sin(m + m') + sin(m' - m))/2 and sin m cos m' = (sin(m + m') - sin(m' - m))/2
    const double sign = (I.sine ? -1 : 1) * (difference < 0 ? -1 : 1);
    return 0.5 * (xy[std::size_t(sum)](I.l, J.l) +
                  sign * xy[std::size_t(std::abs(difference))](I.l, J.l));
  }
};

/// The modes that have the symmetry of a shift along x or y, or of a rotation.
std::vector<TractionMode> traction_modes(Motion motion, int shifted_component, int radial,
                                         int angular) {
  std::vector<TractionMode> modes;
  const int parity = motion == Motion::rotation;
  for (int component = 0; component < 2; ++component) {
    const bool sine = motion == Motion::rotation ? component == 0 : component != shifted_component;
    for (int m = parity; m <= 2 * angular + parity; m += 2) {
      if (sine && m == 0) continue;
      for (int l = m / 2; l <= radial; ++l) modes.push_back({component, l, m, sine});
    }
  }
  return modes;
}

/// Work of the traction on a unit rigid motion squared, over the work on the displacement.
double rigid_motion_stiffness(const std::vector<TractionMode>& modes,
                              const ComplianceHarmonics& harmonics, double a, double b,
                              Motion motion, int shifted_component) {
  const Eigen::Index count = Eigen::Index(modes.size());
  MatrixXd matrix(count, count);
  VectorXd work = VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const TractionMode& mode = modes[std::size_t(i)];
    for (Eigen::Index j = 0; j <= i; ++j)
      matrix(i, j) = a * b * harmonics.product(mode, modes[std::size_t(j)]);
    // Force 2 pi a b of j_0; moments 2 pi a b (a, b)/3 of j_1.
    if (mode.l > 0 || mode.m > 1) continue;
    if (motion == Motion::rotation)
      work[i] = 2 * kPi * a * b / 3 * (mode.component == 0 ? -b : a);
    else if (mode.component == shifted_component)
      work[i] = 2 * kPi * a * b;
  }
  return internal::solve_definite(matrix, work).col(0).dot(work);
}

}  // namespace

SpectralResolution sufficient_stuck_resolution(double a, double b) noexcept {
  const double longer = std::max(a, b), aspect = std::max(a / b, b / a);
  const int radial = std::min(30, int(6 + 2.2 * std::sqrt(longer)));
  const int angular = aspect < 1 + 1e-9 ? 1 : std::min(10, int(4 + 2 * std::log(aspect)));
  return {std::max(radial, angular), angular};
}

StuckLayerStiffness stuck_layer_stiffness(double a, double b, const LayerKernel& kernel,
                                          SpectralResolution resolution) {
  const int radial = resolution.radial, angular = std::min(resolution.angular, radial);
  const ComplianceHarmonics even(a, b, kernel, 0, radial, 2 * angular + 1);
  const ComplianceHarmonics odd(a, b, kernel, 1, radial, 2 * angular + 2);
  const auto along = [&](int component) {
    return rigid_motion_stiffness(traction_modes(Motion::shift, component, radial, angular), even,
                                  a, b, Motion::shift, component);
  };
  return {rigid_motion_stiffness(traction_modes(Motion::rotation, 0, radial, angular), odd, a, b,
                                 Motion::rotation, 0),
          along(0), along(1)};
}

}  // namespace softfinger
