#include "softfinger/layer/line_contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/math/gauss_legendre.h"

namespace softfinger {
namespace {

/// J_0(z) .. J_(orders - 1)(z) by Miller's downward recurrence, normalised by
/// J_0 + 2 J_2 + 2 J_4 + .. = 1.
Eigen::VectorXd bessel_functions(int orders, double z) {
  // Above order z the functions fall by more than a factor of two per order soon after.
  const int above = std::max(orders, int(z));
  const int start = 2 * ((above + 40 + int(2 * std::sqrt(40.0 * above))) / 2);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(orders);
  if (!(z > 0)) {
    values[0] = 1;
    return values;
  }
  constexpr double kSmall = 1e-300, kLarge = 1e250;
  double next = 0, current = kSmall, sum = 0;
  for (int order = start; order >= 0; --order) {
    if (order < orders) values[order] = current;
    if (order % 2 == 0) sum += (order > 0 ? 2 : 1) * current;
    const double lower = 2 * order / z * current - next;
    next = current;
    current = lower;
    if (std::abs(current) > kLarge) {
      current /= kLarge;
      next /= kLarge;
      sum /= kLarge;
      values /= kLarge;
    }
  }
  return values / sum;
}

}  // namespace

double LineContact::pressure_over_modulus(double x_m) const noexcept {
  const double x = x_m / half_width_m;
  if (!(std::abs(x) < 1)) return 0;
  // U_0, U_1, U_2, .. by their recurrence; the even ones are summed.
  double sum = 0, before = 0, at = 1;
  for (Eigen::Index n = 0; n < pressure_coefficients.size(); ++n) {
    sum += pressure_coefficients[n] * at;
    const double odd = 2 * x * at - before;
    before = odd;
    at = 2 * x * odd - at;
  }
  return std::sqrt((1 - x) * (1 + x)) * sum;
}

LineContact line_contact(double half_width_m, double radius_m, double thickness_m,
                         const LayerKernel& kernel, int terms) {
  const double size = half_width_m / thickness_m;
  // Pressure falls to zero over a thickness at the edges of a wide contact.
  if (terms <= 0) terms = 12 + int(4 * size);
  const QuadratureRule rule =
      composite_gauss_legendre(kLargestLayerWaveNumber, std::min(1.0, 4 / size));
  const auto sign = [](int n) { return n % 2 ? -1.0 : 1.0; };
  Eigen::MatrixXd waves(rule.nodes.size(), terms);  // (-1)^n J_(2n+1)
  // d/b = sum (-1)^n c_n int w/t (J_2n + J_(2n+2)) dt, w = 1 - exp(-2t) + [exp(-2t) - (1 - w)]. The
  // first part is closed, the bracket's integral ends with the layer's waves.
  Eigen::VectorXd depths(terms), weights(rule.nodes.size());
  const double ratio = size / (std::hypot(2, size) + 2);
  const auto closed = [&](int order) {
    return order == 0 ? std::asinh(2 / size) : (1 - std::pow(ratio, order)) / order;
  };
  for (int n = 0; n < terms; ++n) depths[n] = sign(n) * (closed(2 * n) + closed(2 * n + 2));
  for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
    const double t = rule.nodes[i], stiffening = kernel.stiffening(t);
    const Eigen::VectorXd bessel = bessel_functions(2 * terms + 1, size * t);
    weights[i] = 2 * rule.weights[i] * stiffening / t;
    const double bracket = rule.weights[i] * (std::exp(-2 * t) - stiffening) / t;
    for (int n = 0; n < terms; ++n) {
      waves(i, n) = sign(n) * bessel[2 * n + 1];
      depths[n] += sign(n) * bracket * (bessel[2 * n] + bessel[2 * n + 2]);
    }
  }
  Eigen::MatrixXd matrix = -(waves.transpose() * weights.asDiagonal() * waves);
  for (int n = 0; n < terms; ++n) matrix.col(n) *= 2 * n + 1;
  matrix.diagonal().array() += 1;
  LineContact contact;
  contact.half_width_m = half_width_m;
  contact.pressure_coefficients =
      matrix.partialPivLu().solve(half_width_m / (2 * radius_m) * Eigen::VectorXd::Unit(terms, 0));
  const Eigen::VectorXd& c = contact.pressure_coefficients;
  contact.load_over_modulus_m = 0.5 * kPi * half_width_m * c[0];
  contact.indentation_m = half_width_m * depths.dot(c);
  contact.mean_square_over_square = 0.25 * (1 + c[1] / c[0]);
  contact.peak_over_modulus = contact.pressure_over_modulus(0);
  return contact;
}

LineContact line_contact_at_load(double load_over_modulus_m, double radius_m, double thickness_m,
                                 const LayerKernel& kernel) {
  // ln P' over ln b has a slope from 2 (Hertz) to 5 (thin and incompressible).
  const double goal = std::log(load_over_modulus_m);
  const double hertz_m = std::sqrt(4 / kPi * load_over_modulus_m * radius_m);
  double log_width = std::log(std::min(hertz_m, kWidestLineContact * thickness_m));
  double last_width = 0, last_load = 0;
  constexpr int kMostSteps = 60;
  for (int step = 0; step < kMostSteps; ++step) {
    const LineContact contact = line_contact(std::exp(log_width), radius_m, thickness_m, kernel);
    const double load = std::log(contact.load_over_modulus_m);
    if (std::abs(load - goal) < 1e-12) return contact;
    double slope = 3;
    if (step > 0 && log_width != last_width)
      slope = std::clamp((load - last_load) / (log_width - last_width), 1.9, 5.2);
    last_width = log_width;
    last_load = load;
    log_width += (goal - load) / slope;
    if (std::exp(log_width) > kWidestLineContact * thickness_m) return {};
  }
  return {};
}

}  // namespace softfinger
