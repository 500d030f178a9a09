#include "softfinger/layer/circular_contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/input/constants.h"
#include "softfinger/math/gauss_legendre.h"

namespace softfinger {
namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// sum c_k T_k(2x - 1), 0 <= x <= 1, by Clenshaw's recurrence.
double chebyshev_sum(const VectorXd& coefficients, double x) noexcept {
  const double y = 2 * (2 * x - 1);
  double b1 = 0, b2 = 0;
  for (Eigen::Index k = coefficients.size() - 1; k > 0; --k) {
    const double b0 = coefficients[k] + y * b1 - b2;
    b2 = b1;
    b1 = b0;
  }
  return coefficients[0] + 0.5 * y * b1 - b2;
}

/// Coefficients of the interpolant of `function` at `count` Chebyshev points of [0, 1].
template <typename Function>
VectorXd chebyshev_fit(int count, const Function& function) {
  VectorXd coefficients = VectorXd::Zero(count);
  for (int i = 0; i < count; ++i) {
    const double angle = kPi * (i + 0.5) / count;
    const double value = function(0.5 + 0.5 * std::cos(angle)) * 2 / count;
    for (int k = 0; k < count; ++k) coefficients[k] += value * std::cos(k * angle);
  }
  coefficients[0] *= 0.5;
  return coefficients;
}

/// The waves k a of the layers and the weights of int (1 - w) ... dk a over them.
QuadratureRule wave_rule(double a_m, const std::vector<CompliantLayer>& layers) {
  std::vector<QuadratureRule> rules;
  Eigen::Index count = 0;
  for (const CompliantLayer& layer : layers) {
    const double s = a_m / layer.kernel.thickness_m();
    // One panel resolves one unit of k times the depth and the 12 radians of a product of two
    // cosines.
    QuadratureRule rule = composite_gauss_legendre(kLargestLayerWaveNumber * s,
                                                   std::min(s / layer.kernel.depth(), 6.0));
    for (Eigen::Index i = 0; i < rule.nodes.size(); ++i)
      rule.weights[i] *= layer.share * layer.kernel.stiffening(rule.nodes[i] / s);
    count += rule.nodes.size();
    rules.push_back(rule);
  }
  QuadratureRule all{VectorXd(count), VectorXd(count)};
  Eigen::Index first = 0;
  for (const QuadratureRule& rule : rules) {
    all.nodes.segment(first, rule.nodes.size()) = rule.nodes;
    all.weights.segment(first, rule.nodes.size()) = rule.weights;
    first += rule.nodes.size();
  }
  return all;
}

double thinnest(const std::vector<CompliantLayer>& layers) {
  double thickness_m = layers.front().kernel.thickness_m();
  for (const CompliantLayer& layer : layers)
    thickness_m = std::min(thickness_m, layer.kernel.thickness_m());
  return thickness_m;
}

/// The solution in units of the contact radius: phi over (E*/pi) a²/R, d over a²/R.
struct Density {
  QuadratureRule rule;  ///< on (0, 1)
  VectorXd phi;         ///< at its nodes
  double indentation;
  QuadratureRule waves;
  VectorXd spectrum;  ///< int phi cos(k t) dt of each wave

  double integral() const { return rule.weights.dot(phi); }
  double moment() const { return rule.weights.dot(rule.nodes.cwiseProduct(phi)); }
};

Density solve(double a_m, const std::vector<CompliantLayer>& layers) {
  const int count = 32 + int(3 * a_m / thinnest(layers));
  Density density{gauss_legendre(count), {}, 0, wave_rule(a_m, layers), {}};
  const VectorXd& t = density.rule.nodes;
  // cos(k t) at the nodes t and, in the last row, at the edge t = 1.
  MatrixXd cosines(count + 1, density.waves.nodes.size());
  for (Eigen::Index k = 0; k < cosines.cols(); ++k) {
    cosines.col(k).head(count) = (density.waves.nodes[k] * t.array()).cos();
    cosines(count, k) = std::cos(density.waves.nodes[k]);
  }
  const MatrixXd weighted =
      density.rule.weights.asDiagonal() * cosines.topRows(count);  // of int phi cos(k t) dt
  const MatrixXd kernel =
      (2 / kPi) * (cosines * density.waves.weights.asDiagonal()) * weighted.transpose();
  MatrixXd right(count, 2);
  right.col(0).setOnes();
  right.col(1) = -t.array().square();
  const MatrixXd solution =
      (MatrixXd::Identity(count, count) - kernel.topRows(count)).partialPivLu().solve(right);
  // phi(1) = d (1 + int K phi_1) + (-1 + int K phi_2) = 0
  const Eigen::RowVector2d edge = kernel.row(count) * solution;
  density.indentation = (1 - edge[1]) / (1 + edge[0]);
  density.phi = density.indentation * solution.col(0) + solution.col(1);
  density.spectrum = weighted.transpose() * density.phi;
  return density;
}

CircularLayerContact contact_of(double a_m, double radius_m, const Density& density) {
  CircularLayerContact contact;
  const double slope = a_m / radius_m;
  contact.a_m = a_m;
  contact.load_over_modulus_m2 = 2 * slope * density.integral() * a_m * a_m;
  contact.indentation_m = slope * density.indentation * a_m;
  contact.torque_arm_m = 0.5 * kPi * a_m * density.moment() / density.integral();
  contact.pressure_scale = slope / kPi;
  return contact;
}

/// -phi'(t)/t is smooth in t²; Abel's integral with t² = r² + (1 - r²) u² is sqrt(1 - r²) times a
/// smooth function of r².
void add_pressure(const Density& density, CircularLayerContact* contact) {
  const int count = int(density.rule.nodes.size());
  const ArrayXd k = density.waves.nodes;
  const ArrayXd amplitude =
      (2 / kPi) * density.waves.weights.array() * density.spectrum.array() * k * k;
  const VectorXd slope = chebyshev_fit(count, [&](double t2) {
    const ArrayXd kt = k * std::sqrt(t2);
    return 2 + (amplitude * (kt < 1e-4).select(1 - kt * kt / 6, kt.sin() / kt)).sum();
  });
  contact->pressure_coefficients = chebyshev_fit(count, [&](double r2) {
    double sum = 0;
    for (int i = 0; i < count; ++i) {
      const double u = density.rule.nodes[i];
      sum += density.rule.weights[i] * chebyshev_sum(slope, r2 + (1 - r2) * u * u);
    }
    return sum;
  });
}

}  // namespace

double CircularLayerContact::pressure_over_modulus(double r_m) const noexcept {
  const double x = (r_m / a_m) * (r_m / a_m);
  if (!(x < 1) || pressure_coefficients.size() == 0) return 0;
  return pressure_scale * std::sqrt(1 - x) * chebyshev_sum(pressure_coefficients, x);
}

CircularLayerContact circular_layer_contact(double a_m, double radius_m,
                                            const std::vector<CompliantLayer>& layers) {
  const Density density = solve(a_m, layers);
  CircularLayerContact contact = contact_of(a_m, radius_m, density);
  add_pressure(density, &contact);
  return contact;
}

CircularLayerContact circular_layer_contact_at_load(double load_over_modulus_m2, double radius_m,
                                                    const std::vector<CompliantLayer>& layers) {
  constexpr int kMaxIterations = 60;
  constexpr double kTolerance = 1e-13;
  double softest = 0;
  for (const CompliantLayer& layer : layers) softest += layer.share * layer.kernel.softest();
  // The half-space's contact is larger than any layer's, and that of the softest sublayer's
  // material larger than any stack's.
  const double hertz = std::log(std::cbrt(0.75 * load_over_modulus_m2 * radius_m));
  const double limit = std::log(kLargestCircularContact * thinnest(layers));
  double lower = -std::numeric_limits<double>::infinity(), upper = hertz + std::log(softest) / 3;
  // The slope dlnP/dlna is 3 to 7, less where a contact outgrows a firm skin: from a start at two
  // thicknesses (where solutions are cheap), a secant kept inside the bracket.
  const double smallest_slope = softest > 1 ? 1 : 2.9;
  constexpr double kLargestSlope = 8;
  double log_a = std::min(hertz, limit - std::log(kLargestCircularContact / 2));
  double previous = 0, previous_residual = 0, slope = 4;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const double a_m = std::exp(log_a);
    const double residual = std::log(
        contact_of(a_m, radius_m, solve(a_m, layers)).load_over_modulus_m2 / load_over_modulus_m2);
    if (!std::isfinite(residual)) return {};
    if (iteration > 0 && log_a != previous)
      slope = std::clamp((residual - previous_residual) / (log_a - previous), smallest_slope,
                         kLargestSlope);
    const double step = -residual / slope;
    // Done when the load is met to rounding, or to the rounding of the logarithm of a tiny radius.
    if (std::abs(residual) < kTolerance || std::abs(step) < 4e-16 * std::abs(log_a))
      return circular_layer_contact(a_m, radius_m, layers);
    if (log_a - residual / kLargestSlope > limit) return {};
    (residual > 0 ? upper : lower) = log_a;
    previous = log_a;
    previous_residual = residual;
    log_a = std::min(log_a + step, limit);
    if (log_a >= upper) log_a = previous < upper ? 0.5 * (previous + upper) : upper;
    if (log_a <= lower) log_a = 0.5 * (lower + upper);
  }
  // Beyond a/h ~ 50 rounding errors may keep the residual above its tolerance.
  if (std::abs(previous_residual) > 1e-9) return {};
  return circular_layer_contact(std::exp(previous), radius_m, layers);
}

}  // namespace softfinger
