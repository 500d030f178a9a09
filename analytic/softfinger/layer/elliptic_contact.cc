#include "softfinger/layer/elliptic_contact.h"

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "softfinger/input/errors.h"
#include "softfinger/layer/gauss_legendre.h"
#include "softfinger/layer/layer_limits.h"
#include "softfinger/math/pi.h"

namespace softfinger {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// j_0, j_2, ..., j_2l of q into `values` (l + 1 of them).
void even_spherical_bessel(double q, int l, double* values) {
  const int order = 2 * l;
  if (q > order + 1) {  // upwards: stable where the functions oscillate
    const double s = std::sin(q), c = std::cos(q);
    double previous = s / q, value = s / (q * q) - c / q;
    values[0] = previous;
    for (int n = 1; n < order; ++n) {
      const double next = (2 * n + 1) / q * value - previous;
      previous = value;
      value = next;
      if (n % 2 == 1) values[(n + 1) / 2] = next;
    }
    return;
  }
  if (q < 1e-8) {
    values[0] = 1;
    std::fill(values + 1, values + l + 1, 0.0);
    return;
  }
  // Downwards from an order where they are negligible, then scaled to j_0 or j_1.
  const int start = order + 20 + int(std::sqrt(40.0 * (order + 1)));
  double above = 0, value = 1e-280;
  double scaled_j1 = 0;
  for (int n = start; n >= 1; --n) {
    const double below = (2 * n + 1) / q * value - above;
    above = value;
    value = below;
    if (std::abs(value) > 1e200) {
      const double shrink = 1e-250;
      value *= shrink;
      above *= shrink;
      for (int i = (n + 1) / 2; i <= l; ++i) values[i] *= shrink;
    }
    if ((n - 1) % 2 == 0 && n - 1 <= order) values[(n - 1) / 2] = value;
    if (n == 1) scaled_j1 = above;
  }
  const double j0 = std::sin(q) / q;
  const double j1 =
      q < 0.1 ? q / 3 * (1 - q * q / 10 * (1 - q * q / 28)) : (std::sin(q) / q - std::cos(q)) / q;
  const double scale = std::abs(j0) > std::abs(j1) ? j0 / values[0] : j1 / scaled_j1;
  for (int i = 0; i <= l; ++i) values[i] *= scale;
}

/// C_ll' = int_0^inf (1 - w(q g)) j_2l(q) j_2l'(q) dq.
MatrixXd layer_part(double g, const LayerKernel& kernel, int radial) {
  // One panel resolves one unit of x = q g and the 12 radians of a product of Bessel functions.
  const QuadratureRule rule =
      composite_gauss_legendre(kLargestLayerWaveNumber / g, std::min(1 / g, 6.0));
  MatrixXd bessel(radial + 1, rule.nodes.size());
  for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
    even_spherical_bessel(rule.nodes[i], radial, bessel.col(i).data());
    bessel.col(i) *= std::sqrt(rule.weights[i] * kernel.stiffening(rule.nodes[i] * g));
  }
  return bessel * bessel.transpose();
}

struct Mode {
  int l, m;
};

/// int_0^1 F_lm(r) r² dr: the radial factor of the torque.
double radial_moment(const Mode& mode) {
  const int n = mode.l - mode.m / 2;
  const double half_m = 0.5 * mode.m;
  double product = 1;
  for (int i = 0; i < n; ++i) product *= (i + half_m - 0.5) / (i + 0.5);  // includes n!/Gamma
  const double beta =
      std::exp(std::lgamma(half_m + 1.5) + std::lgamma(n + 0.5) - std::lgamma(half_m + n + 2));
  return 0.5 * (mode.m % 4 ? -1 : 1) * product * beta;
}

/// S(t) of p = K/sqrt(1 - r²) + S sqrt(1 - r²) + ... along the edge, at the angles t in (0, pi/2).
///
/// The expansion holds within one thickness of the edge. Where the edge deviates from the ellipse
/// by more (large, elongated contacts), S takes in a share of K a/h, and with it the cos 4t and
/// higher terms of K; so there its mean and cos 2t terms alone are used. It is kept within a factor
/// of two of its shapes for thick layers, constant, and for thin ones, sqrt(g(t)).
VectorXd edge_stiffness(const VectorXd& measured, const VectorXd& angle, const VectorXd& thin,
                        double a) {
  const double mean = measured.mean();
  const Eigen::ArrayXd second = (2 * angle).array().cos();
  const Eigen::ArrayXd low = mean + 2 * (measured.array() * second).mean() * second;
  const double trust = 1 / (1 + std::pow(a / 20, 4));
  const Eigen::ArrayXd smooth = low + trust * (measured.array() - low);
  const Eigen::ArrayXd expected = thin.array() * (mean / thin.mean());
  return smooth.max(0.5 * expected.min(mean)).min(2 * expected.max(mean));
}

}  // namespace

SpectralResolution sufficient_resolution(double a, double b) noexcept {
  const int radial = std::min(30, int(6 + 2.2 * std::sqrt(a)));
  const int angular = a / b < 1 + 1e-9 ? 0 : std::min(8, int(4 + 2 * std::log(a / b)));
  return {std::max(radial, angular), angular};
}

EllipticLayerContact elliptic_layer_contact(double a, double b, const LayerKernel& kernel,
                                            SpectralResolution resolution) {
  const int radial = resolution.radial, angular = std::min(resolution.angular, radial);
  std::vector<Mode> modes;
  for (int m = 0; m <= 2 * angular; m += 2)
    for (int l = m / 2; l <= radial; ++l) modes.push_back({l, m});
  const Eigen::Index count = Eigen::Index(modes.size());

  // Trapezoidal rule over a quarter of the circle of directions: it converges like
  // exp(-4 n atanh(b/a)), and has to resolve the products of the angular modes.
  const bool circle = angular == 0 && a == b;
  const int directions = circle ? 1 : angular + 10 + int(7 * a / b);
  std::vector<MatrixXd> harmonics(std::size_t(2 * angular + 1),
                                  MatrixXd::Zero(radial + 1, radial + 1));
  for (int i = 0; i <= directions; ++i) {
    if (circle && i > 0) break;
    const double psi = circle ? 0 : 0.5 * kPi * i / directions;
    const double weight =
        circle ? 2 * kPi : (i == 0 || i == directions ? 1.0 : 2.0) * kPi / directions;
    const double g = std::hypot(std::cos(psi) / a, std::sin(psi) / b);
    MatrixXd block = -layer_part(g, kernel, radial);
    for (int l = 0; l <= radial; ++l) block(l, l) += kPi / (2 * (4 * l + 1));
    for (int j = 0; j <= 2 * angular; ++j)
      harmonics[std::size_t(j)] += weight / g * std::cos(2 * j * psi) * block;
  }
  MatrixXd matrix(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j) {
      const Mode &I = modes[std::size_t(i)], &J = modes[std::size_t(j)];
      // cos m psi cos m' psi = (cos(m - m') psi + cos(m + m') psi)/2; u^ = 2 w p^/k
      matrix(i, j) = harmonics[std::size_t(std::abs(I.m - J.m) / 2)](I.l, J.l) +
                     harmonics[std::size_t((I.m + J.m) / 2)](I.l, J.l);
    }

  VectorXd angular_moment = VectorXd::Zero(angular + 1);
  const int points = 40 + int(12 * a / b);
  for (int i = 0; i < points; ++i) {
    const double t = 0.5 * kPi * (i + 0.5) / points;
    for (int j = 0; j <= angular; ++j)
      angular_moment[j] +=
          2 * kPi / points * std::cos(2 * j * t) * std::hypot(a * std::cos(t), b * std::sin(t));
  }
  // Moments of the modes with 1, x², y² and the distance from the centre.
  MatrixXd moments = MatrixXd::Zero(count, 4);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Mode& mode = modes[std::size_t(i)];
    if (mode.l == 0) moments.row(i) << 2 * kPi, 2 * kPi / 3 * a * a, 2 * kPi / 3 * b * b, 0;
    if (mode.l == 1)
      moments.row(i) << 0, -4 * kPi / 15 * a * a, (mode.m ? 4 : -4) * kPi / 15 * b * b, 0;
    moments(i, 3) = radial_moment(mode) * angular_moment[mode.m / 2];
  }
  const MatrixXd solutions = matrix.llt().solve(moments);

  // Edge: p = K(t)/sqrt(1 - r²) + S(t) sqrt(1 - r²) + ...; the true edge is at 1 + K/S.
  const int samples = 8 * (angular + 1);
  MatrixXd singular = MatrixXd::Zero(samples, 4), regular = MatrixXd::Zero(samples, 3);
  VectorXd angle(samples);
  for (int k = 0; k < samples; ++k) {
    angle[k] = 0.5 * kPi * (k + 0.5) / samples;
    for (Eigen::Index i = 0; i < count; ++i) {
      const Mode& mode = modes[std::size_t(i)];
      const double value = (mode.l % 2 ? -1 : 1) * std::cos(mode.m * angle[k]);
      singular.row(k) += value * solutions.row(i);
      regular.row(k) -=
          value * (mode.l * (2 * mode.l + 1) - 0.5 * mode.m * mode.m) * solutions.row(i).head<3>();
    }
  }
  const auto singular_part = singular.leftCols<3>();
  Eigen::Vector3d shape;  // d, -1/(2R'), -1/(2R'')
  VectorXd stiffness = VectorXd::Ones(samples);
  VectorXd thin_stiffness(samples);
  for (int k = 0; k < samples; ++k)
    thin_stiffness[k] = std::sqrt(std::hypot(std::cos(angle[k]) / a, std::sin(angle[k]) / b));
  for (int iteration = 0; iteration < (angular ? 4 : 1); ++iteration) {
    const Eigen::RowVector3d mean =
        (singular_part.array().colwise() / stiffness.array()).colwise().sum();
    const Eigen::RowVector3d second =
        angular ? Eigen::RowVector3d((singular_part.array().colwise() *
                                      ((2 * angle).array().cos() / stiffness.array()))
                                         .colwise()
                                         .sum())
                : Eigen::RowVector3d(0, 1, -1);
    shape = mean.cross(second).transpose();
    shape /= shape[0];
    stiffness = edge_stiffness(regular * shape, angle, thin_stiffness, a);
  }
  const double scale = 1 / (2 * std::sqrt(shape[1] * shape[2]));
  shape *= scale;
  stiffness *= scale;
  const VectorXd pressure = solutions.leftCols<3>() * shape;
  const VectorXd intensity = singular_part * shape;
  const VectorXd deviation = intensity.array() / stiffness.array();

  // Moving the edge outwards by e(t), scaled, changes the integral of p times a field v by
  // pi a b int K K_v e / g dt, K_v of the pressure whose displacement is v. On the way to the true
  // edge K falls to zero, which halves it: a second-order correction of the load and the torque.
  VectorXd weight(samples);
  for (int k = 0; k < samples; ++k)
    weight[k] = kPi * kPi * a * b / samples * intensity[k] * deviation[k] /
                std::hypot(std::cos(angle[k]) / a, std::sin(angle[k]) / b);

  EllipticLayerContact contact;
  contact.a = a;
  contact.b = b;
  contact.radii_ratio = shape[2] / shape[1];
  contact.indentation = shape[0];
  contact.load = 2 * kPi * a * b * pressure[0] + weight.dot(singular.col(0));
  contact.edge_deviation = 2 * (deviation.array() * (4 * angle).array().cos()).mean();
  double gamma_ratio = 1;  // l!/ (1/2)(3/2)...: sqrt(pi) l!/Gamma(l + 1/2)
  for (Eigen::Index i = 0; i < count; ++i) {
    const Mode& mode = modes[std::size_t(i)];
    if (mode.m == 0) {
      if (mode.l > 0) gamma_ratio *= mode.l / (mode.l - 0.5);
      contact.peak_pressure += gamma_ratio * pressure[i];
    }
  }
  contact.torque_arm =
      (a * b * pressure.dot(moments.col(3)) + weight.dot(singular.col(3))) / contact.load;
  return contact;
}

EllipticLayerContact elliptic_layer_contact_at_load(double load, double radii_ratio,
                                                    const LayerKernel& kernel, double a_guess,
                                                    double b_guess, double tolerance) {
  constexpr int kMaxIterations = 30;
  const bool circle = radii_ratio == 1;
  double log_size = 0.5 * std::log(a_guess * b_guess);
  double log_ratio = circle ? 0 : std::log(a_guess / b_guess);
  // Jacobian of (ln load, ln R'/R'') against (ln sqrt(ab), ln a/b): from the blend of the limits,
  // improved by Broyden's rule, since one solution costs far more than the algebra.
  const LayerBlend blend =
      layer_blend(limit_shapes(radii_ratio), std::log(load), kernel.compressibility());
  Eigen::Matrix2d jacobian;
  jacobian << 1 / blend.slope[kSize], 0, 0,
      radii_ratio > 1.001 ? std::log(radii_ratio) / blend.value[kAspect] : 1.8;
  Eigen::Vector2d residual(1, 1), step(0, 0);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const double a = std::exp(log_size + 0.5 * log_ratio);
    const double b = circle ? a : std::exp(log_size - 0.5 * log_ratio);
    const EllipticLayerContact contact =
        elliptic_layer_contact(a, b, kernel, sufficient_resolution(a, b));
    const Eigen::Vector2d now(std::log(contact.load / load),
                              circle ? 0 : std::log(contact.radii_ratio / radii_ratio));
    if (!now.allFinite()) break;
    if (iteration > 0)
      jacobian += (now - residual - jacobian * step) * step.transpose() / step.squaredNorm();
    residual = now;
    if (residual.cwiseAbs().maxCoeff() < tolerance) return contact;
    step = -jacobian.partialPivLu().solve(residual);
    if (circle) step[1] = 0;
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > 0.7) step *= 0.7 / longest;
    log_size += step[0];
    log_ratio = std::max(log_ratio + step[1], 0.0);
  }
  throw ConvergenceError(
      "elliptic contact at a given load", kMaxIterations, residual.cwiseAbs().maxCoeff(),
      "start closer to the solution: the guess was a/h = " + std::to_string(a_guess) +
          ", b/h = " + std::to_string(b_guess));
}

}  // namespace softfinger
