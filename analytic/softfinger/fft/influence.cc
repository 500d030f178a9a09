#include "softfinger/fft/influence.h"

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/math/bessel_j0.h"
#include "softfinger/math/even_table.h"
#include "softfinger/math/gauss_legendre.h"

namespace softfinger::fft {
namespace {

/// Mean over two cells of 1/r by moments of their distance's distribution: relative error of order
/// (size/r)^6.
double far_mean_of_reciprocal(double x, double y, double size_x, double size_y) {
  const double r2 = x * x + y * y, r4 = r2 * r2, r = std::sqrt(r2);
  const double X = x * x / r2, Y = y * y / r2;
  const double mx = size_x * size_x / (6 * r2), my = size_y * size_y / (6 * r2);
  const double nx = std::pow(size_x, 4) / (15 * r4), ny = std::pow(size_y, 4) / (15 * r4);
  return (1 + 0.5 * (mx * (3 * X - 1) + my * (3 * Y - 1)) +
          (nx * (105 * X * X - 90 * X + 9) + ny * (105 * Y * Y - 90 * Y + 9)) / 24 +
          0.25 * mx * my * (105 * X * Y - 12)) /
         r;
}

/// Weights of a rule on the lattice -steps .. steps for the mean over the distance between two
/// points of two equal intervals (a triangular density of half-width `steps`): exact to degree 5
/// for two steps, Simpson's rule applied twice for more.
std::vector<double> triangle_rule(int steps) {
  std::vector<double> weights(static_cast<std::size_t>(2 * steps + 1), 0.0);
  if (steps == 2) return {1.0 / 60, 4.0 / 15, 13.0 / 30, 4.0 / 15, 1.0 / 60};
  std::vector<double> simpson;
  for (int i = 0; i <= steps; ++i)
    simpson.push_back((i == 0 || i == steps ? 1 : (i % 2 ? 4 : 2)) / (3.0 * steps));
  for (std::size_t i = 0; i < simpson.size(); ++i)
    for (std::size_t j = 0; j < simpson.size(); ++j) weights[i + j] += simpson[i] * simpson[j];
  return weights;
}

/// Even number of lattice steps per cell, such that the layer's function, whose singularities lie
/// at the distance of 2 h, is resolved.
int lattice_steps(double size, double thickness) {
  constexpr double kResolved = 0.25;
  return std::max(2, 2 * static_cast<int>(std::ceil(size / (2 * kResolved * thickness))));
}

}  // namespace

long double fourfold_integral(long double x, long double y) {
  const long double r = std::sqrt(x * x + y * y);
  const long double first = x > 0 ? x * x * y * std::asinh(y / x) / 2 : 0;
  const long double second = y > 0 ? y * y * x * std::asinh(x / y) / 2 : 0;
  return first + second - r * r * r / 6;
}

LayerStiffening::LayerStiffening(const StackKernel& kernel, double largest)
    : depth_(kernel.depth()) {
  constexpr double kBand = 5;  // of distances that share one rule
  const auto tabulate = [&](double step, double end) {
    std::vector<double> table;
    const int count = static_cast<int>(end / step) + 6;
    QuadratureRule rule;
    double rule_end = -1;
    for (int j = 0; j < count; ++j) {
      const double t = step * j;
      if (t > rule_end) {
        const double band = kBand * step / kStep;
        rule_end = band * (1 + std::floor(t / band));
        // About one and a half periods of J0 per panel of 16 points, and the kernel resolved.
        rule = composite_gauss_legendre(kLargestLayerWaveNumber,
                                        std::min(1.5 / depth_, 10 / rule_end));
        for (Eigen::Index i = 0; i < rule.nodes.size(); ++i)
          rule.weights[i] *= kernel.stiffening(rule.nodes[i]);
      }
      double sum = 0;
      for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
        if (rule.nodes[i] > 10 && std::abs(rule.weights[i]) < 1e-13) break;  // nothing follows
        sum += rule.weights[i] * bessel_j0(rule.nodes[i] * t);
      }
      table.push_back(sum);
    }
    return table;
  };
  near_ = tabulate(kStep, std::min(largest, kReach));
  if (depth_ > 1 && largest > kReach)
    far_ = tabulate(kStep * depth_, std::min(largest, kReach * depth_));
}

double LayerStiffening::operator()(double t) const {
  if (t >= reach()) return 1 / t;
  return t < kReach ? at_even_table(near_, t / kStep) : at_even_table(far_, t / (kStep * depth_));
}

KernelQuadrant influence_of_cells(int rows, int columns, double size_x, double size_y,
                                  double thickness, const LayerStiffening* stiffening) {
  // Nearer, the moments are not yet accurate; farther, the closed form's differences cancel.
  constexpr double kNear = 16;
  const double near = kNear * std::max(size_x, size_y), area = size_x * size_y;
  KernelQuadrant result = KernelQuadrant::Zero(rows + 1, columns + 1);
  const double cutoff = stiffening ? stiffening->reach() * thickness : 0;

  const int near_rows = static_cast<int>(std::min<double>(rows, near / size_y + 1));
  const int near_columns = static_cast<int>(std::min<double>(columns, near / size_x + 1));
  Eigen::Array<long double, Eigen::Dynamic, Eigen::Dynamic> F(near_rows + 2, near_columns + 2);
  for (int i = 0; i < F.rows(); ++i)
    for (int j = 0; j < F.cols(); ++j)
      F(i, j) = fourfold_integral(static_cast<long double>(j) * size_x,
                                  static_cast<long double>(i) * size_y);
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j <= columns; ++j) {
      if (i <= near_rows && j <= near_columns) {
        const auto row_difference = [&](int k) {
          return F(i + 1, k) - 2 * F(i, k) + F(std::abs(i - 1), k);
        };
        result(i, j) = static_cast<double>(row_difference(j + 1) - 2 * row_difference(j) +
                                           row_difference(std::abs(j - 1))) /
                       (kPi * area);
      } else {
        result(i, j) = area * far_mean_of_reciprocal(j * size_x, i * size_y, size_x, size_y) / kPi;
      }
    }
  if (!stiffening) return result;

  const int steps_x = lattice_steps(size_x, thickness), steps_y = lattice_steps(size_y, thickness);
  const std::vector<double> rule_x = triangle_rule(steps_x), rule_y = triangle_rule(steps_y);
  const double step_x = size_x / steps_x, step_y = size_y / steps_y;
  // Cells farther apart than the cutoff do not feel each other.
  const int last_row = static_cast<int>(std::min<double>(rows, cutoff / size_y + 1));
  const int last_column = static_cast<int>(std::min<double>(columns, cutoff / size_x + 1));
  KernelQuadrant along_x(last_row * steps_y + steps_y + 1, last_column + 1);
  std::vector<double> line(static_cast<std::size_t>(last_column * steps_x + steps_x + 1));
  for (Eigen::Index i = 0; i < along_x.rows(); ++i) {
    const double y = static_cast<double>(i) * step_y;
    for (std::size_t k = 0; k < line.size(); ++k) {
      const double x = static_cast<double>(k) * step_x;
      line[k] = (*stiffening)(std::sqrt(x * x + y * y) / thickness);
    }
    for (int j = 0; j <= last_column; ++j) {
      double sum = 0;
      for (int k = -steps_x; k <= steps_x; ++k)
        sum += rule_x[static_cast<std::size_t>(k + steps_x)] *
               line[static_cast<std::size_t>(std::abs(j * steps_x + k))];
      along_x(i, j) = sum;
    }
  }
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j <= columns; ++j) {
      if (i > last_row || j > last_column) {
        result(i, j) = 0;
        continue;
      }
      double sum = 0;
      for (int k = -steps_y; k <= steps_y; ++k)
        sum +=
            rule_y[static_cast<std::size_t>(k + steps_y)] * along_x(std::abs(i * steps_y + k), j);
      result(i, j) -= area * sum / (kPi * thickness);
    }
  return result;
}

}  // namespace softfinger::fft
