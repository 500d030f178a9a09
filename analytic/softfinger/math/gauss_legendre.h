#pragma once

#include <Eigen/Core>
#include <cmath>

#include "softfinger/input/constants.h"

namespace softfinger {

struct QuadratureRule {
  Eigen::VectorXd nodes;
  Eigen::VectorXd weights;
};

/// Gauss-Legendre rule of `count` >= 1 points on [0, 1], nodes increasing: exact for polynomials
/// of degree 2 count - 1. Newton's method on the Legendre polynomial; O(count²), error a few
/// epsilon.
inline QuadratureRule gauss_legendre(int count) {
  QuadratureRule rule{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  for (int i = 0; i < count; ++i) {
    double x = std::cos(kPi * (i + 0.75) / (count + 0.5)), derivative = 1;
    for (int iteration = 0; iteration < 100; ++iteration) {
      double previous = 1, value = x;
      for (int n = 2; n <= count; ++n) {
        const double next = ((2 * n - 1) * x * value - (n - 1) * previous) / n;
        previous = value;
        value = next;
      }
      derivative = count * (previous - x * value) / (1 - x * x);
      const double step = value / derivative;
      x -= step;
      if (std::abs(step) < 1e-15) break;
    }
    rule.nodes[i] = 0.5 * (1 - x);
    rule.weights[i] = 1 / ((1 - x * x) * derivative * derivative);
  }
  return rule;
}

/// Composite rule on [0, length]: equal panels of at most `panel_length`, 16 points each.
inline QuadratureRule composite_gauss_legendre(double length, double panel_length) {
  constexpr int kPoints = 16;
  static const QuadratureRule panel = gauss_legendre(kPoints);
  const int panels = std::max(1, int(std::ceil(length / panel_length)));
  const double width = length / panels;
  QuadratureRule rule{Eigen::VectorXd(panels * kPoints), Eigen::VectorXd(panels * kPoints)};
  for (int i = 0; i < panels; ++i) {
    rule.nodes.segment(i * kPoints, kPoints) = width * (panel.nodes.array() + i);
    rule.weights.segment(i * kPoints, kPoints) = width * panel.weights;
  }
  return rule;
}

}  // namespace softfinger
