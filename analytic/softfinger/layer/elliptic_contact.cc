#include "softfinger/layer/elliptic_contact.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/layer/layer_limits.h"
#include "softfinger/layer/spherical_bessel.h"
#include "softfinger/math/dense_solvers.h"
#include "softfinger/math/gauss_legendre.h"

namespace softfinger {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// C_ll' = int_0^inf (1 - w(q g)) j_2l(q) j_2l'(q) dq.
MatrixXd layer_part(double g, const LayerKernel& kernel, int radial) {
  // One panel resolves one unit of x = q g and the 12 radians of a product of Bessel functions.
  const QuadratureRule rule =
      composite_gauss_legendre(kLargestLayerWaveNumber / g, std::min(1 / g, 6.0));
  MatrixXd bessel(radial + 1, rule.nodes.size());
  for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
    spherical_bessel(rule.nodes[i], 0, radial, bessel.col(i).data());
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

/// S(t) of p = K/sqrt(1 - r²) + S sqrt(1 - r²) + ... along the edge, at the angles t in (0, pi/2),
/// smoothed.
///
/// The expansion holds within one thickness of the edge. The edge of large, elongated contacts
/// deviates from the ellipse by more: there the measured S contains a share of K a/h, and with it
/// the cos 4t and higher terms of K. Contacts larger than about 20 thicknesses therefore use only
/// its mean and cos 2t terms. S is also kept within a factor of two of its shapes for thick layers,
/// constant, and for thin ones, sqrt(g(t)). (20, its fourth power and the factor of two by trial;
/// tests/analytic/bonded_layer_test.cc and layer_fft_test.cc check what comes of them.)
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

/// All modes of the expansion, those of an angle together.
std::vector<Mode> expansion(int radial, int angular) {
  std::vector<Mode> modes;
  for (int m = 0; m <= 2 * angular; m += 2)
    for (int l = m / 2; l <= radial; ++l) modes.push_back({l, m});
  return modes;
}

/// Fourier coefficients over the directions psi of the wave vector, j = 0, 1, ... 2 angular, each a
/// matrix over the radial modes: the integral of cos(2 j psi) (D - layer_part(g)) / g, where D is
/// the half-space's part in closed form, a diagonal, and g(psi) = |(cos psi/a, sin psi/b)|.
std::vector<MatrixXd> harmonics_of_compliance(double a, double b, const LayerKernel& kernel,
                                              int radial, int angular) {
  // Trapezoidal rule over a quarter of the circle of directions. It converges like
  // exp(-4 n atanh(b/a)), so that 7 a/b points make e^-28, and it has to resolve the products of
  // the angular modes.
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
  return harmonics;
}

/// Galerkin's matrix: the displacement under each mode, weighted by each other one.
MatrixXd galerkin_matrix(const std::vector<Mode>& modes, const std::vector<MatrixXd>& harmonics) {
  const Eigen::Index count = Eigen::Index(modes.size());
  MatrixXd matrix(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j) {
      const Mode &I = modes[std::size_t(i)], &J = modes[std::size_t(j)];
      // cos m psi cos m' psi = (cos(m - m') psi + cos(m + m') psi)/2; u^ = 2 w p^/k
      matrix(i, j) = harmonics[std::size_t(std::abs(I.m - J.m) / 2)](I.l, J.l) +
                     harmonics[std::size_t((I.m + J.m) / 2)](I.l, J.l);
    }
  return matrix;
}

/// int_0^2pi cos(2 j t) |(a cos t, b sin t)| dt for j = 0 ... angular: the angular factor of the
/// torque. Midpoint rule, which converges like the one of the directions.
VectorXd angular_moments(double a, double b, int angular) {
  VectorXd result = VectorXd::Zero(angular + 1);
  const int points = 40 + int(12 * a / b);
  for (int i = 0; i < points; ++i) {
    const double t = 0.5 * kPi * (i + 0.5) / points;
    for (int j = 0; j <= angular; ++j)
      result[j] +=
          2 * kPi / points * std::cos(2 * j * t) * std::hypot(a * std::cos(t), b * std::sin(t));
  }
  return result;
}

/// Columns of what belongs to a displacement or is weighted with a field: 1, x², y², and the
/// distance from the centre.
constexpr int kOne = 0, kDistance = 3;

/// Integrals of the modes times these four, over ab.
MatrixXd moments_of_modes(const std::vector<Mode>& modes, double a, double b, int angular) {
  const VectorXd angular_moment = angular_moments(a, b, angular);
  const Eigen::Index count = Eigen::Index(modes.size());
  MatrixXd moments = MatrixXd::Zero(count, 4);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Mode& mode = modes[std::size_t(i)];
    if (mode.l == 0) moments.row(i) << 2 * kPi, 2 * kPi / 3 * a * a, 2 * kPi / 3 * b * b, 0;
    if (mode.l == 1)
      moments.row(i) << 0, -4 * kPi / 15 * a * a, (mode.m ? 4 : -4) * kPi / 15 * b * b, 0;
    moments(i, kDistance) = radial_moment(mode) * angular_moment[mode.m / 2];
  }
  return moments;
}

/// The pressures at the edge that belong to the displacements 1, x², y² and distance: at the angles
/// t of (0, pi/2), p = K(t)/sqrt(1 - r²) + S(t) sqrt(1 - r²) + ...
struct EdgeExpansion {
  VectorXd angle;
  MatrixXd singular;  ///< K
  MatrixXd regular;   ///< S, of the first three
  /// |(cos t/a, sin t/b)|: distance in scaled coordinates over that along the edge's normal.
  VectorXd stretch;

  EdgeExpansion(const std::vector<Mode>& modes, const MatrixXd& solutions, double a, double b,
                int angular)
      : angle(8 * (angular + 1)),  // the highest harmonic has eight points per wave
        singular(MatrixXd::Zero(angle.size(), 4)),
        regular(MatrixXd::Zero(angle.size(), 3)),
        stretch(angle.size()) {
    for (Eigen::Index k = 0; k < angle.size(); ++k) {
      angle[k] = 0.5 * kPi * (double(k) + 0.5) / double(angle.size());
      stretch[k] = std::hypot(std::cos(angle[k]) / a, std::sin(angle[k]) / b);
      for (std::size_t i = 0; i < modes.size(); ++i) {
        const Mode& mode = modes[i];
        const double value = (mode.l % 2 ? -1 : 1) * std::cos(mode.m * angle[k]);
        const auto solution = solutions.row(Eigen::Index(i));
        singular.row(k) += value * solution;
        regular.row(k) -=
            value * (mode.l * (2 * mode.l + 1) - 0.5 * mode.m * mode.m) * solution.head<3>();
      }
    }
  }
};

/// The combination (d, -1/(2R'), -1/(2R'')) of the displacements 1, x², y² whose edge, 1 + K/S, has
/// no mean and no cos 2t component: it fits the ellipse best. In units of R = 1. S depends on the
/// combination, weakly, so that it is found by iteration.
struct FittedShape {
  Eigen::Vector3d coefficients;
  VectorXd stiffness;  ///< S(t)
};
FittedShape fit_shape(const EdgeExpansion& edge, double a, int angular) {
  constexpr int kIterations = 4;  // S is of second order; a circle needs no iteration
  const auto singular = edge.singular.leftCols<3>();
  const VectorXd thin_stiffness = edge.stretch.array().sqrt();
  FittedShape fitted{{}, VectorXd::Ones(edge.angle.size())};
  Eigen::Vector3d& shape = fitted.coefficients;
  VectorXd& stiffness = fitted.stiffness;
  for (int iteration = 0; iteration < (angular ? kIterations : 1); ++iteration) {
    const Eigen::RowVector3d mean =
        (singular.array().colwise() / stiffness.array()).colwise().sum();
    Eigen::RowVector3d second(0, 1, -1);  // a circle: R' = R''
    if (angular)
      second = (singular.array().colwise() * ((2 * edge.angle).array().cos() / stiffness.array()))
                   .colwise()
                   .sum();
    shape = mean.cross(second).transpose();
    shape /= shape[0];
    stiffness = edge_stiffness(edge.regular * shape, edge.angle, thin_stiffness, a);
  }
  const double scale = 1 / (2 * std::sqrt(shape[1] * shape[2]));
  shape *= scale;
  stiffness *= scale;
  return fitted;
}

/// Pressure at the centre: of the modes with m = 0 the values there, l!/((1/2)(3/2)...(l - 1/2)).
double pressure_at_centre(const std::vector<Mode>& modes, const VectorXd& pressure) {
  double sum = 0, value = 1;
  for (std::size_t i = 0; i < modes.size() && modes[i].m == 0; ++i) {
    if (modes[i].l > 0) value *= modes[i].l / (modes[i].l - 0.5);
    sum += value * pressure[Eigen::Index(i)];
  }
  return sum;
}

}  // namespace

// Found by trial. With half as many terms more, load, torque, indentation and R'/R'' change by
// 1e-11 at a/h = 1 (round; 1e-7 at R'/R'' = 10), 2e-5 at 5 and 3e-5 up to 100.
SpectralResolution sufficient_resolution(double a, double b) noexcept {
  const int radial = std::min(30, int(6 + 2.2 * std::sqrt(a)));
  const int angular = a / b < 1 + 1e-9 ? 0 : std::min(8, int(4 + 2 * std::log(a / b)));
  return {std::max(radial, angular), angular};
}

EllipticLayerContact elliptic_layer_contact(double a, double b, const LayerKernel& kernel,
                                            SpectralResolution resolution) {
  const int radial = resolution.radial, angular = std::min(resolution.angular, radial);
  const std::vector<Mode> modes = expansion(radial, angular);
  const MatrixXd matrix =
      galerkin_matrix(modes, harmonics_of_compliance(a, b, kernel, radial, angular));
  const MatrixXd moments = moments_of_modes(modes, a, b, angular);
  const MatrixXd solutions = internal::solve_definite(matrix, moments);

  const EdgeExpansion edge(modes, solutions, a, b, angular);
  const FittedShape fitted = fit_shape(edge, a, angular);
  const Eigen::Vector3d& shape = fitted.coefficients;
  const VectorXd pressure = solutions.leftCols<3>() * shape;
  const VectorXd intensity = edge.singular.leftCols<3>() * shape;
  const VectorXd deviation = intensity.array() / fitted.stiffness.array();

  // Moving the edge outwards by e(t), scaled, changes the integral of p times a field v by
  // pi a b int K K_v e / g dt, K_v of the pressure whose displacement is v. On the way to the true
  // edge K falls to zero, which halves it: a second-order correction of the load and the torque.
  const Eigen::Index samples = edge.angle.size();
  VectorXd weight(samples);
  for (Eigen::Index k = 0; k < samples; ++k)
    weight[k] = kPi * kPi * a * b / double(samples) * intensity[k] * deviation[k] / edge.stretch[k];

  EllipticLayerContact contact;
  contact.a = a;
  contact.b = b;
  contact.radii_ratio = shape[2] / shape[1];
  contact.indentation = shape[0];
  contact.load = 2 * kPi * a * b * pressure[0] + weight.dot(edge.singular.col(kOne));
  contact.edge_deviation = 2 * (deviation.array() * (4 * edge.angle).array().cos()).mean();
  contact.peak_pressure = pressure_at_centre(modes, pressure);
  contact.torque_arm =
      (a * b * pressure.dot(moments.col(kDistance)) + weight.dot(edge.singular.col(kDistance))) /
      contact.load;
  return contact;
}

EllipticLayerContact elliptic_layer_contact_at_load(double load, double radii_ratio,
                                                    const LayerKernel& kernel, double a_guess,
                                                    double b_guess, double tolerance) {
  constexpr int kMaxIterations = 30;
  constexpr double kLongestStep = 0.7;  // of the logarithms: a factor of two
  const bool circle = radii_ratio == 1;
  double log_size = 0.5 * std::log(a_guess * b_guess);
  double log_ratio = circle ? 0 : std::log(a_guess / b_guess);
  // Jacobian of (ln load, ln R'/R'') with respect to (ln sqrt(ab), ln a/b). It starts from the
  // blend of the limits and is improved by Broyden's rule, because a solution costs far more than
  // the algebra. Near the circle the blend's ratio of logarithms is 0/0. There a
  // constant replaces it, between the derivative of Hertz, 3/2, and of a thin incompressible
  // layer, 3.
  constexpr double kAlmostRound = 1.001, kSlopeNearCircle = 1.8;
  const LimitShapes shapes = limit_shapes(radii_ratio);
  const LayerQuantities blend = layer_blend(shapes, std::log(load), kernel.compressibility());
  // d ln(size)/d ln(load), for which a difference is accurate enough.
  constexpr double kStep = 1e-3;
  const double size_slope =
      (layer_blend(shapes, std::log(load) + kStep, kernel.compressibility())[kSize] -
       blend[kSize]) /
      kStep;
  Eigen::Matrix2d jacobian;
  jacobian << 1 / size_slope, 0, 0,
      radii_ratio > kAlmostRound ? std::log(radii_ratio) / blend[kAspect] : kSlopeNearCircle;
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
    if (longest > kLongestStep) step *= kLongestStep / longest;
    log_size += step[0];
    log_ratio = std::max(log_ratio + step[1], 0.0);
  }
  throw ConvergenceError(
      "elliptic contact at a given load", kMaxIterations, residual.cwiseAbs().maxCoeff(),
      "start closer to the solution: the guess was a/h = " + std::to_string(a_guess) +
          ", b/h = " + std::to_string(b_guess));
}

}  // namespace softfinger
