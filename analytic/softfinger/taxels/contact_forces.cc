#include "softfinger/taxels/contact_forces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "softfinger/math/gauss_legendre.h"

namespace softfinger::taxels {
namespace {

struct Rectangle {
  double left_m, right_m, lower_m, upper_m;
};

/// Sums of p, p x², p y² and p r over an area.
struct PressureMoments {
  double force = 0, xx = 0, yy = 0, arm = 0;

  void add(double x, double y, double part) {
    force += part;
    xx += part * x * x;
    yy += part * y * y;
    arm += part * std::hypot(x, y);
  }
};

/// The pressure of a model on its ellipse.
struct EllipsePressure {
  const PressureModel& model;
  const ContactProblem& problem;
  const Prediction& prediction;

  double operator()(double x_m, double y_m) const {
    return model.pressure_Pa(problem, prediction, x_m, y_m);
  }

  double distance2(double x_m, double y_m) const {
    const double u = x_m / prediction.a_m, v = y_m / prediction.b_m;
    return u * u + v * v;
  }

  void add_inner(const Rectangle& cell, PressureMoments& moments) const {
    static const QuadratureRule rule = gauss_legendre(4);
    const double width = cell.right_m - cell.left_m, height = cell.upper_m - cell.lower_m;
    for (Eigen::Index i = 0; i < rule.nodes.size(); ++i)
      for (Eigen::Index j = 0; j < rule.nodes.size(); ++j) {
        const double x = cell.left_m + width * rule.nodes[i];
        const double y = cell.lower_m + height * rule.nodes[j];
        moments.add(x, y, width * height * rule.weights[i] * rule.weights[j] * (*this)(x, y));
      }
  }

  /// Along x = chord sin t and y = b sin s a pressure (1 - r²)^n is smooth in t, and its integrals
  /// along chords in s.
  void add_near_edge(const Rectangle& cell, PressureMoments& moments) const {
    static const QuadratureRule rule = gauss_legendre(8);
    const double a = prediction.a_m, b = prediction.b_m;
    const double low = std::clamp(cell.lower_m, -b, b), high = std::clamp(cell.upper_m, -b, b);
    // The edge crosses the cell's sides at up to four heights, where integrals along chords have a
    // kink.
    std::array<double, 6> heights{low, high, low, low, low, low};
    std::size_t count = 2;
    for (const double x : {cell.left_m, cell.right_m}) {
      const double u = x / a;
      if (!(std::abs(u) < 1)) continue;
      const double y = b * std::sqrt(1 - u * u);
      for (const double height : {y, -y})
        if (height > low && height < high) heights[count++] = height;
    }
    std::sort(heights.begin(), heights.begin() + std::ptrdiff_t(count));
    for (std::size_t k = 0; k + 1 < count; ++k) {
      const double s0 = std::asin(heights[k] / b), s1 = std::asin(heights[k + 1] / b);
      for (Eigen::Index j = 0; j < rule.nodes.size(); ++j) {
        const double s = s0 + (s1 - s0) * rule.nodes[j], y = b * std::sin(s);
        const double chord = a * std::cos(s);
        const double left = std::clamp(cell.left_m / chord, -1., 1.);
        const double right = std::clamp(cell.right_m / chord, -1., 1.);
        if (!(left < right)) continue;
        const double t0 = std::asin(left), t1 = std::asin(right);
        const double weight = (s1 - s0) * rule.weights[j] * b * std::cos(s);
        for (Eigen::Index i = 0; i < rule.nodes.size(); ++i) {
          const double t = t0 + (t1 - t0) * rule.nodes[i], x = chord * std::sin(t);
          moments.add(x, y,
                      weight * (t1 - t0) * rule.weights[i] * chord * std::cos(t) * (*this)(x, y));
        }
      }
    }
  }
};

void normalise(const PressureMoments& all, double load_N, ForceCells& cells) {
  cells.normalisation = load_N / all.force;
  for (Eigen::ArrayXXd* forces : {&cells.force_N, &cells.shear_x_N, &cells.shear_y_N})
    *forces *= cells.normalisation;
  cells.spread_x_m = std::sqrt(all.xx / all.force);
  cells.spread_y_m = std::sqrt(all.yy / all.force);
  cells.arm_m = all.arm / all.force;
}

/// Parts of an interval that lie in each of the cells along one axis: the first cell, and the
/// shares of the interval's length, which add up to 1.
struct Shares {
  int first = 0;
  std::vector<double> shares;

  Shares(double low, double high, double first_side, double step, int count) {
    first = std::clamp(int(std::floor((low - first_side) / step)), 0, count - 1);
    double reached = low;
    for (int i = first; i < count && reached < high; ++i) {
      // A part that would lie beyond the last cell by rounding belongs to it.
      const double side =
          i + 1 < count ? std::clamp(first_side + (i + 1) * step, reached, high) : high;
      shares.push_back((side - reached) / (high - low));
      reached = side;
    }
  }
};

}  // namespace

ForceCells cells_for(const TaxelGrid& grid, double half_x_m, double half_y_m) {
  const auto check = [](const char* what, int value) {
    if (value < 1 || value > TaxelGrid::kMost)
      throw InputError("taxels", what, std::to_string(value),
                       "1 to " + std::to_string(TaxelGrid::kMost));
  };
  check("columns", grid.columns);
  check("rows", grid.rows);
  if (!(grid.pitch_m > 0) || !std::isfinite(grid.pitch_m * grid.pitch_m))
    throw InputError("taxels", "pitch_m", grid.pitch_m, "a finite number > 0");
  constexpr int kAcross = 64, kMostTaxelsAcross = 256;
  const double longer_m = 2 * std::max(half_x_m, half_y_m);
  if (longer_m > kMostTaxelsAcross * grid.pitch_m)
    throw InputError("taxels", "pitch_m", grid.pitch_m, "at least a 256th of the contact's length");
  ForceCells cells;
  cells.grid = grid;
  const auto per_taxel = [&](double half_m) {
    return int(std::clamp(std::ceil(kAcross * grid.pitch_m / (2 * half_m)), 1., 64.));
  };
  cells.per_taxel_x = per_taxel(half_x_m);
  cells.per_taxel_y = per_taxel(half_y_m);
  cells.begin_x = int(std::floor((-half_x_m - grid.left_m()) / cells.step_x_m()));
  cells.begin_y = int(std::floor((-half_y_m - grid.lower_m()) / cells.step_y_m()));
  const int end_x = int(std::ceil((half_x_m - grid.left_m()) / cells.step_x_m()));
  const int end_y = int(std::ceil((half_y_m - grid.lower_m()) / cells.step_y_m()));
  cells.force_N = Eigen::ArrayXXd::Zero(end_x - cells.begin_x, end_y - cells.begin_y);
  return cells;
}

ForceCells forces_on_cells(const PressureModel& model, const ContactProblem& problem,
                           const Prediction& prediction, const TaxelGrid& grid) {
  ForceCells cells = cells_for(grid, prediction.a_m, prediction.b_m);
  const EllipsePressure pressure{model, problem, prediction};
  PressureMoments all;
  for (int j = 0; j < int(cells.force_N.cols()); ++j)
    for (int i = 0; i < int(cells.force_N.rows()); ++i) {
      const Rectangle cell{cells.x_m(i), cells.x_m(i + 1), cells.y_m(j), cells.y_m(j + 1)};
      const auto farther = [](double one, double other) {
        return std::max(std::abs(one), std::abs(other));
      };
      const double farthest = pressure.distance2(farther(cell.left_m, cell.right_m),
                                                 farther(cell.lower_m, cell.upper_m));
      // A pressure with a root at the edge is a polynomial of degree 7 to 1e-7 in a small cell
      // that keeps off it.
      constexpr double kInside = 0.8;
      PressureMoments here;
      if (farthest < kInside)
        pressure.add_inner(cell, here);
      else
        pressure.add_near_edge(cell, here);
      cells.force_N(i, j) = here.force;
      all.force += here.force;
      all.xx += here.xx;
      all.yy += here.yy;
      all.arm += here.arm;
    }
  normalise(all, problem.load.normal_force_N, cells);
  return cells;
}

ForceCells forces_on_cells(const LayerContact& contact, const TaxelGrid& grid) {
  const fft::CellGrid& from = contact.grid;
  std::vector<SpreadForce> forces;
  for (int row = 0; row < from.rows; ++row)
    for (int column = 0; column < from.columns; ++column)
      if (const double pressure = contact.pressure_Pa[row * from.columns + column]; pressure > 0)
        forces.push_back({from.x(column), from.y(row), 0.5 * from.size_x, 0.5 * from.size_y,
                          pressure * from.cell_area()});
  return forces_on_cells(forces, contact.pressure_Pa.sum() * from.cell_area(), grid);
}

ForceCells forces_on_cells(const std::vector<SpreadForce>& forces, double load_N,
                           const TaxelGrid& grid) {
  double half_x_m = 0, half_y_m = 0;
  bool has_shear = false;
  for (const SpreadForce& force : forces) {
    has_shear |= force.shear_x_N != 0 || force.shear_y_N != 0;
    half_x_m = std::max(half_x_m, std::abs(force.x_m) + force.half_x_m);
    half_y_m = std::max(half_y_m, std::abs(force.y_m) + force.half_y_m);
  }
  ForceCells cells = cells_for(grid, half_x_m, half_y_m);
  if (has_shear)
    cells.shear_x_N = cells.shear_y_N =
        Eigen::ArrayXXd::Zero(cells.force_N.rows(), cells.force_N.cols());
  PressureMoments all;
  for (const SpreadForce& force : forces) {
    all.add(force.x_m, force.y_m, force.force_N);
    all.xx += force.force_N * force.half_x_m * force.half_x_m / 3;
    all.yy += force.force_N * force.half_y_m * force.half_y_m / 3;
    const Shares x(force.x_m - force.half_x_m, force.x_m + force.half_x_m, cells.x_m(0),
                   cells.step_x_m(), int(cells.force_N.rows()));
    const Shares y(force.y_m - force.half_y_m, force.y_m + force.half_y_m, cells.y_m(0),
                   cells.step_y_m(), int(cells.force_N.cols()));
    for (std::size_t j = 0; j < y.shares.size(); ++j)
      for (std::size_t i = 0; i < x.shares.size(); ++i) {
        const int to_x = x.first + int(i), to_y = y.first + int(j);
        const double share = x.shares[i] * y.shares[j];
        cells.force_N(to_x, to_y) += force.force_N * share;
        if (!has_shear) continue;
        cells.shear_x_N(to_x, to_y) += force.shear_x_N * share;
        cells.shear_y_N(to_x, to_y) += force.shear_y_N * share;
      }
  }
  normalise(all, load_N, cells);
  return cells;
}

}  // namespace softfinger::taxels
