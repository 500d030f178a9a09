#include "softfinger/fft/layer_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "softfinger/fft/convolution.h"
#include "softfinger/fft/influence.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

using Eigen::ArrayXd;

constexpr int kCoarseCells = 32;
constexpr double kMargin = 1.15;  // of the final grid around the contact

/// Lengths in a unit L, heights in P/(E* L), pressures in P/L²: the load is 1.
struct DimensionlessLayer {
  double thickness = 0;   // of the surface's sublayer
  double compliance = 1;  // E* of the first layer's surface over that of this one's
  StackKernel kernel;
};

struct Box {
  double x = 0, y = 0;  // middle
  double half_x = 0, half_y = 0;
};

struct Problem {
  GapFunction gap;
  bool even = false;
  Box window;  // of an even problem only a first guess
  std::vector<DimensionlessLayer> layers;
  double compliance() const {
    double sum = 0;
    for (const auto& layer : layers) sum += layer.compliance;
    return sum;
  }
};

/// Kernels of the layers for any grid. The tables are kept from grid to grid.
class Kernels {
 public:
  explicit Kernels(const std::vector<DimensionlessLayer>& layers)
      : layers_(layers), tables_(layers.size()), reach_(layers.size(), -1.0) {}

  fft::KernelQuadrant operator()(int cells, double size_x, double size_y) {
    fft::KernelQuadrant sum = of_layer(0, cells, size_x, size_y);
    for (std::size_t i = 1; i < layers_.size(); ++i) sum += of_layer(i, cells, size_x, size_y);
    return sum;
  }

  fft::KernelQuadrant of_layer(std::size_t i, int cells, double size_x, double size_y) {
    constexpr double kThickestCell = 64;
    const double h = layers_[i].thickness;
    if (!(std::max(size_x, size_y) <= kThickestCell * h))
      throw ConvergenceError("layer contact", 0, std::max(size_x, size_y) / h,
                             "the layer is so thin that no grid resolves it: use the limit of a "
                             "thin layer");
    const double farthest = std::min(std::hypot(size_x, size_y) * (cells + 2) / h,
                                     fft::LayerStiffening::reach(layers_[i].kernel));
    if (farthest > reach_[i]) {
      tables_[i] = std::make_unique<fft::LayerStiffening>(layers_[i].kernel, farthest);
      reach_[i] = farthest;
    }
    return layers_[i].compliance *
           fft::influence_of_cells(cells, cells, size_x, size_y, h, tables_[i].get());
  }

 private:
  const std::vector<DimensionlessLayer>& layers_;
  std::vector<std::unique_ptr<fft::LayerStiffening>> tables_;
  std::vector<double> reach_;
};

fft::CellGrid make_grid(const Box& box, int cells, bool even) {
  fft::CellGrid grid;
  grid.size_x = 2 * box.half_x / cells;
  grid.size_y = 2 * box.half_y / cells;
  grid.rows = grid.columns = even ? cells / 2 : cells;
  grid.first_x = even ? grid.size_x / 2 : box.x - box.half_x + grid.size_x / 2;
  grid.first_y = even ? grid.size_y / 2 : box.y - box.half_y + grid.size_y / 2;
  return grid;
}

/// Mean of the gap over each cell, by four points: exact for cubics.
ArrayXd mean_gap(const GapFunction& gap, const fft::CellGrid& grid) {
  const double dx = grid.size_x / std::sqrt(12.0), dy = grid.size_y / std::sqrt(12.0);
  ArrayXd result(grid.rows * grid.columns);
  for (int i = 0, k = 0; i < grid.rows; ++i)
    for (int j = 0; j < grid.columns; ++j, ++k) {
      const double x = grid.x(j), y = grid.y(i);
      result[k] = 0.25 * (gap(x - dx, y - dy) + gap(x + dx, y - dy) + gap(x - dx, y + dy) +
                          gap(x + dx, y + dy));
    }
  return result;
}

struct GridSolution {
  fft::CellGrid grid;
  ArrayXd pressure, gap;
  double approach = 0, residual = 0, penetration = 0;
  int iterations = 0, convolutions = 0;
};

/// Conjugate gradients of Polonsky and Keer. Gradients are those of the cells with pressure. A
/// pressure that a step would make negative becomes zero, and cells outside the contact that
/// overlap are given pressure; after either the search direction starts anew. While neither happens
/// the displacement is updated instead of computed, which saves every second convolution.
GridSolution solve_on_grid(const fft::CellGrid& grid, const ArrayXd& undeformed, bool even,
                           const fft::KernelQuadrant& kernel, ArrayXd pressure, double tolerance,
                           int max_iterations) {
  const auto convolution =
      even ? fft::make_even_convolution(kernel) : fft::make_convolution(kernel);
  const double total = 1 / (grid.cell_area() * (even ? 4 : 1));  // sum of all pressures
  const double lowest = undeformed.minCoeff();
  pressure *= total / pressure.sum();
  GridSolution solution;
  solution.grid = grid;
  ArrayXd displacement, response, inside;
  ArrayXd direction = ArrayXd::Zero(pressure.size());
  double last_norm = 1, momentum = 0;
  bool stale = true;
  for (int iteration = 1;; ++iteration) {
    if (stale) {
      convolution->apply(pressure, displacement);
      ++solution.convolutions;
    }
    inside = (pressure > 0).cast<double>();
    const double count = inside.sum();
    ArrayXd gap = displacement + undeformed;
    const double approach = (gap * inside).sum() / count;
    gap -= approach;
    const double norm = (gap.square() * inside).sum();
    const double scale = approach - lowest;
    solution.residual = std::sqrt(norm / count) / scale;
    solution.penetration = std::max(0.0, -((1 - inside) * gap).minCoeff()) / scale;
    solution.iterations = iteration;
    if (!std::isfinite(solution.residual) || scale <= 0 || iteration == max_iterations)
      throw ConvergenceError("conjugate gradients of the layer contact", iteration,
                             solution.residual,
                             "the gap is not smooth, or the tolerance is below rounding");
    // A cell's overlap is held to a looser bound, as it is a maximum and not a mean.
    if (solution.residual <= tolerance && solution.penetration <= 10 * tolerance) {
      solution.pressure = pressure;
      solution.gap = gap;
      solution.approach = approach;
      return solution;
    }
    direction = inside * (gap + (last_norm > 0 ? momentum * norm / last_norm : 0) * direction);
    last_norm = norm;
    convolution->apply(direction, response);
    ++solution.convolutions;
    const double mean_response = (response * inside).sum() / count;
    const double curvature = ((response - mean_response) * direction * inside).sum();
    const double step =
        curvature > 0 ? (gap * direction * inside).sum() / curvature : 1 / kernel(0, 0);
    ArrayXd next = pressure - step * direction;
    stale = (next < 0).any();
    next = next.max(0.0);
    momentum = 1;
    for (Eigen::Index i = 0; i < next.size(); ++i)
      if (inside[i] == 0 && gap[i] < 0) {
        next[i] = -step * gap[i];
        momentum = 0;
        stale = true;
      }
    const double correction = total / next.sum();
    pressure = next * correction;
    if (!stale) displacement = (displacement - step * response) * correction;
  }
}

/// Pressure of a coarser solution at the cells of another grid; zero outside it.
ArrayXd interpolate(const GridSolution& from, const fft::CellGrid& grid, bool even) {
  ArrayXd result(grid.rows * grid.columns);
  const auto at = [&](int i, int j) {
    if (even) {
      i = i < 0 ? 0 : i;
      j = j < 0 ? 0 : j;
    }
    const bool outside = i < 0 || j < 0 || i >= from.grid.rows || j >= from.grid.columns;
    return outside ? 0.0 : from.pressure[i * from.grid.columns + j];
  };
  for (int i = 0, k = 0; i < grid.rows; ++i)
    for (int j = 0; j < grid.columns; ++j, ++k) {
      const double u = (grid.x(j) - from.grid.first_x) / from.grid.size_x;
      const double v = (grid.y(i) - from.grid.first_y) / from.grid.size_y;
      const int j0 = static_cast<int>(std::floor(u)), i0 = static_cast<int>(std::floor(v));
      const double s = u - j0, t = v - i0;
      result[k] = (1 - t) * ((1 - s) * at(i0, j0) + s * at(i0, j0 + 1)) +
                  t * ((1 - s) * at(i0 + 1, j0) + s * at(i0 + 1, j0 + 1));
    }
  return result;
}

/// Rectangle around the cells with pressure, and whether it lies on the grid's border.
struct Extent {
  double x0 = std::numeric_limits<double>::infinity(), x1 = -x0, y0 = x0, y1 = -x0;
  bool touches_x = false, touches_y = false;
};

Extent extent_of(const GridSolution& solution, bool even) {
  const fft::CellGrid& grid = solution.grid;
  Extent extent;
  for (int i = 0, k = 0; i < grid.rows; ++i)
    for (int j = 0; j < grid.columns; ++j, ++k) {
      if (!(solution.pressure[k] > 0)) continue;
      extent.x0 = std::min(extent.x0, grid.x(j) - grid.size_x / 2);
      extent.x1 = std::max(extent.x1, grid.x(j) + grid.size_x / 2);
      extent.y0 = std::min(extent.y0, grid.y(i) - grid.size_y / 2);
      extent.y1 = std::max(extent.y1, grid.y(i) + grid.size_y / 2);
      extent.touches_x |= j + 1 == grid.columns || (!even && j == 0);
      extent.touches_y |= i + 1 == grid.rows || (!even && i == 0);
    }
  if (even) {
    extent.x0 = -extent.x1;
    extent.y0 = -extent.y1;
  }
  return extent;
}

/// `box` around an extent, times `margin`, and not beyond the window of a general gap.
Box box_around(const Extent& extent, double margin, const Problem& problem) {
  Box box{0.5 * (extent.x0 + extent.x1), 0.5 * (extent.y0 + extent.y1),
          0.5 * margin * (extent.x1 - extent.x0), 0.5 * margin * (extent.y1 - extent.y0)};
  if (problem.even) return box;
  const auto clip = [](double& middle, double& half, double window, double window_half) {
    const double low = std::max(middle - half, window - window_half);
    const double high = std::min(middle + half, window + window_half);
    middle = 0.5 * (low + high);
    half = 0.5 * (high - low);
  };
  clip(box.x, box.half_x, problem.window.x, problem.window.half_x);
  clip(box.y, box.half_y, problem.window.y, problem.window.half_y);
  return box;
}

bool fills(const Box& box, const Box& window) {
  const double nearly = 1 - 1e-9;
  return box.half_x > nearly * window.half_x || box.half_y > nearly * window.half_y;
}

/// Solves on coarse grids until the contact fills most of the box, which grows where the contact
/// touches its border and shrinks where it is mostly empty.
GridSolution find_contact(const Problem& problem, Kernels& kernels, int max_iterations) {
  constexpr double kCoarseTolerance = 1e-3, kGrowth = 1.5, kFull = 0.6;
  constexpr int kAttempts = 60;
  Box box = problem.window;
  GridSolution solution;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const fft::CellGrid grid = make_grid(box, kCoarseCells, problem.even);
    const ArrayXd gap = mean_gap(problem.gap, grid);
    ArrayXd start = attempt > 0 ? interpolate(solution, grid, problem.even)
                                : ArrayXd::Ones(grid.rows * grid.columns);
    if (!(start.sum() > 0)) start.setOnes();
    solution =
        solve_on_grid(grid, gap, problem.even, kernels(kCoarseCells, grid.size_x, grid.size_y),
                      start, kCoarseTolerance, max_iterations);
    const Extent extent = extent_of(solution, problem.even);
    if (!extent.touches_x && !extent.touches_y && extent.x1 - extent.x0 > kFull * 2 * box.half_x &&
        extent.y1 - extent.y0 > kFull * 2 * box.half_y)
      return solution;
    if ((extent.touches_x || extent.touches_y) && !problem.even && fills(box, problem.window)) {
      const bool at_x = extent.touches_x && box.half_x > (1 - 1e-9) * problem.window.half_x;
      const bool at_y = extent.touches_y && box.half_y > (1 - 1e-9) * problem.window.half_y;
      if (at_x || at_y) break;
    }
    // Two cells of margin, since a coarse contact is known to a cell.
    Extent target = extent;
    const double grow_x = extent.touches_x ? (kGrowth - 1) * box.half_x : 2 * grid.size_x;
    const double grow_y = extent.touches_y ? (kGrowth - 1) * box.half_y : 2 * grid.size_y;
    target.x0 -= grow_x;
    target.x1 += grow_x;
    target.y0 -= grow_y;
    target.y1 += grow_y;
    box = box_around(target, 1, problem);
  }
  throw ContactReachesBorder("search for the contact", kAttempts, solution.residual);
}

/// (int |x - centre| dA) over a cell: the moment arm is not smooth near the centre, where the cell
/// is divided.
double mean_distance(double x, double y, const fft::CellGrid& grid) {
  const double size = std::max(grid.size_x, grid.size_y);
  const int parts = x * x + y * y < 16 * size * size ? 6 : 1;
  const double offset = 0.5 / std::sqrt(3.0);
  double sum = 0;
  for (int i = 0; i < 2 * parts; ++i)
    for (int j = 0; j < 2 * parts; ++j) {
      const auto place = [&](int k) {
        return (k / 2 + 0.5 + (k % 2 ? offset : -offset)) / parts - 0.5;
      };
      sum += std::hypot(x + place(j) * grid.size_x, y + place(i) * grid.size_y);
    }
  return sum / (4 * parts * parts);
}

/// The quarter and its mirror images.
ArrayXd mirrored(const ArrayXd& quarter, int rows, int columns) {
  ArrayXd full(4 * rows * columns);
  for (int i = 0, k = 0; i < 2 * rows; ++i)
    for (int j = 0; j < 2 * columns; ++j, ++k) {
      const int row = i < rows ? rows - 1 - i : i - rows;
      const int column = j < columns ? columns - 1 - j : j - columns;
      full[k] = quarter[row * columns + column];
    }
  return full;
}

LayerContact solve(const Problem& problem, const LayerContactOptions& options) {
  const int cells = options.cells;
  if (cells < 32 || cells > 1024 || (cells & (cells - 1)) != 0)
    throw InputError("layer contact", "cells", std::to_string(cells),
                     "a power of two from 32 to 1024");
  if (!(options.tolerance >= 1e-12 && options.tolerance <= 1e-2))
    throw InputError("layer contact", "tolerance", options.tolerance, "1e-12 to 1e-2");
  if (options.max_iterations < 1)
    throw InputError("layer contact", "max_iterations", std::to_string(options.max_iterations),
                     "1 or more");
  const bool even = problem.even;
  Kernels kernels(problem.layers);
  GridSolution solution = find_contact(problem, kernels, options.max_iterations);

  // The final box lies around the edge, not around cells, so that it changes smoothly with the
  // problem.
  Extent extent = extent_of(solution, even);
  {
    const fft::ContactEdge edge = fft::fit_contact_edge(solution.grid, solution.pressure,
                                                        solution.gap, problem.compliance(), even);
    extent.x0 = edge.points.row(0).minCoeff();
    extent.x1 = edge.points.row(0).maxCoeff();
    extent.y0 = edge.points.row(1).minCoeff();
    extent.y1 = edge.points.row(1).maxCoeff();
  }
  double margin = kMargin;
  // A grid between the two costs little and saves the fine one a third of its iterations.
  if (cells >= 4 * kCoarseCells) {
    const fft::CellGrid grid = make_grid(box_around(extent, margin, problem), cells / 2, even);
    solution = solve_on_grid(
        grid, mean_gap(problem.gap, grid), even, kernels(cells / 2, grid.size_x, grid.size_y),
        interpolate(solution, grid, even), 10 * options.tolerance, options.max_iterations);
  }
  constexpr int kAttempts = 4;
  for (int attempt = 0;; ++attempt) {
    const Box box = box_around(extent, margin, problem);
    const fft::CellGrid grid = make_grid(box, cells, even);
    solution = solve_on_grid(
        grid, mean_gap(problem.gap, grid), even, kernels(cells, grid.size_x, grid.size_y),
        interpolate(solution, grid, even), options.tolerance, options.max_iterations);
    const Extent reached = extent_of(solution, even);
    if (!reached.touches_x && !reached.touches_y) break;
    if (attempt == kAttempts)
      throw ContactReachesBorder("layer contact", solution.iterations, solution.residual);
    margin *= 1.15;
  }

  LayerContact contact;
  contact.edge = fft::fit_contact_edge(solution.grid, solution.pressure, solution.gap,
                                       problem.compliance(), even);
  contact.approach_m = solution.approach;
  contact.iterations = solution.iterations;
  contact.convolutions = solution.convolutions;
  contact.residual = solution.residual;
  contact.penetration = solution.penetration;
  double thinnest = std::numeric_limits<double>::infinity();
  for (const auto& layer : problem.layers) thinnest = std::min(thinnest, layer.thickness);
  contact.cells_per_thickness = thinnest / std::max(solution.grid.size_x, solution.grid.size_y);

  contact.peak_pressure_Pa = solution.pressure.maxCoeff();
  if (even) {
    // Extrapolates to the corner of the first cell, from the means of a parabola over the first
    // three cells.
    const int columns = solution.grid.columns;
    const double first = solution.pressure[0];
    contact.peak_pressure_Pa =
        first + (2 * first - solution.pressure[1] - solution.pressure[columns]) / 6;
    contact.grid = solution.grid;
    contact.grid.rows *= 2;
    contact.grid.columns *= 2;
    contact.grid.first_x = -(columns - 0.5) * solution.grid.size_x;
    contact.grid.first_y = -(solution.grid.rows - 0.5) * solution.grid.size_y;
    contact.pressure_Pa = mirrored(solution.pressure, solution.grid.rows, columns);
    contact.gap_m = mirrored(solution.gap, solution.grid.rows, columns);
  } else {
    contact.grid = solution.grid;
    contact.pressure_Pa = solution.pressure;
    contact.gap_m = solution.gap;
    for (int i = 0, k = 0; i < contact.grid.rows; ++i)
      for (int j = 0; j < contact.grid.columns; ++j, ++k) {
        const double force = contact.pressure_Pa[k] * contact.grid.cell_area();
        contact.centre_of_pressure_x_m += force * contact.grid.x(j);
        contact.centre_of_pressure_y_m += force * contact.grid.y(i);
      }
  }
  // Displacement of the first layer alone at the largest pressure; the rest is the object's.
  contact.layer_displacement_m = solution.approach;
  if (problem.layers.size() > 1) {
    const fft::KernelQuadrant kernel =
        kernels.of_layer(0, cells, contact.grid.size_x, contact.grid.size_y);
    Eigen::Index peak = 0;
    contact.pressure_Pa.maxCoeff(&peak);
    const int peak_row = static_cast<int>(peak) / cells,
              peak_column = static_cast<int>(peak) % cells;
    double sum = 0;
    for (int i = 0; i < cells; ++i)
      for (int j = 0; j < cells; ++j)
        sum += kernel(std::abs(i - peak_row), std::abs(j - peak_column)) *
               contact.pressure_Pa[i * cells + j];
    contact.layer_displacement_m = sum;
    contact.object_displacement_m =
        solution.approach - problem.gap(contact.grid.x(peak_column), contact.grid.y(peak_row)) -
        sum;
  }
  const fft::CellGrid& grid = solution.grid;
  const double cell_area = grid.cell_area() * (even ? 4 : 1);
  for (int i = 0, k = 0; i < grid.rows; ++i)
    for (int j = 0; j < grid.columns; ++j, ++k)
      if (solution.pressure[k] > 0)
        contact.torque_arm_m += solution.pressure[k] * cell_area *
                                mean_distance(grid.x(j) - contact.centre_of_pressure_x_m,
                                              grid.y(i) - contact.centre_of_pressure_y_m, grid);
  return contact;
}

/// Converts the dimensionless answer to SI, `length`, `height` and `pressure` being its units.
void scale(LayerContact& contact, double length, double height, double pressure) {
  contact.grid.size_x *= length;
  contact.grid.size_y *= length;
  contact.grid.first_x *= length;
  contact.grid.first_y *= length;
  contact.pressure_Pa *= pressure;
  contact.peak_pressure_Pa *= pressure;
  contact.gap_m *= height;
  contact.approach_m *= height;
  contact.layer_displacement_m *= height;
  contact.object_displacement_m *= height;
  contact.centre_of_pressure_x_m *= length;
  contact.centre_of_pressure_y_m *= length;
  contact.torque_arm_m *= length;
  contact.edge.centre *= length;
  contact.edge.a *= length;
  contact.edge.b *= length;
  contact.edge.area *= length * length;
  contact.edge.points *= length;
  contact.edge.to_scaled /= length;
}

void require(bool condition, const char* field, double value, const char* allowed) {
  if (!condition) throw InputError("layer contact", field, value, allowed);
}

bool positive(double value) { return value > 0 && std::isfinite(value); }

std::vector<DimensionlessLayer> dimensionless_layers(const LayerStack& layer,
                                                     const LayerStack& object_layer,
                                                     double length) {
  std::vector<DimensionlessLayer> layers;
  for (const LayerStack* stack : {&layer, &object_layer}) {
    if (stack == &object_layer && object_layer.count == 0) break;
    require(stack->count > 0, "thickness_m", 0, "positive and finite");
    for (std::size_t i = 0; i < stack->count; ++i) {
      const ElasticLayer& one = stack->sublayers[i];
      require(positive(one.thickness_m), "thickness_m", one.thickness_m, "positive and finite");
      require(positive(one.youngs_modulus_Pa), "youngs_modulus_Pa", one.youngs_modulus_Pa,
              "positive and finite");
      require(one.poisson_ratio >= 0 && one.poisson_ratio <= 0.5, "poisson_ratio",
              one.poisson_ratio, "0 to 0.5");
    }
    layers.push_back(
        {stack->surface().thickness_m / length,
         layer.surface().plane_strain_modulus_Pa() / stack->surface().plane_strain_modulus_Pa(),
         StackKernel(*stack)});
  }
  return layers;
}

/// Rounded to 40 bits, which takes off the last twelve.
double rounded(double value) {
  int exponent = 0;
  const double fraction = std::frexp(value, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(fraction, 40)), exponent - 40);
}

}  // namespace

double LayerContact::pressure_at_Pa(double x_m, double y_m) const {
  const double r = edge.relative_radius(x_m, y_m);
  if (!(r < 1)) return 0;
  // Near the edge the pressure falls too steeply for the cells' means to describe it. Within three
  // cells of the edge the ratio p²/(1 - r²) is therefore taken from the point three cells inside on
  // the same radius. Its interpolation then uses cells about two or more from the edge.
  const double cell = std::max(grid.size_x * edge.to_scaled.col(0).norm(),
                               grid.size_y * edge.to_scaled.col(1).norm());
  const double trusted = std::max(0.0, 1 - 3 * cell);
  double x = x_m, y = y_m;
  if (r > trusted) {
    x = edge.centre.x() + (x - edge.centre.x()) * trusted / r;
    y = edge.centre.y() + (y - edge.centre.y()) * trusted / r;
  }
  const double u = (x - grid.first_x) / grid.size_x, v = (y - grid.first_y) / grid.size_y;
  const int j = std::clamp(static_cast<int>(std::floor(u)), 0, grid.columns - 2);
  const int i = std::clamp(static_cast<int>(std::floor(v)), 0, grid.rows - 2);
  const double s = u - j, t = v - i;
  double sum = 0;
  for (int di = 0; di < 2; ++di)
    for (int dj = 0; dj < 2; ++dj) {
      const double p = pressure_Pa[(i + di) * grid.columns + j + dj];
      const double radius = edge.relative_radius(grid.x(j + dj), grid.y(i + di));
      sum +=
          (dj ? s : 1 - s) * (di ? t : 1 - t) * p * p / std::max(1 - radius * radius, 0.5 * cell);
    }
  return std::sqrt(sum * (1 - r * r));
}

LayerContact solve_layer_contact(const GapFunction& gap_m, const GapWindow& window,
                                 const LayerStack& layer, const LayerStack& object_layer,
                                 double load_N, const LayerContactOptions& options) {
  require(positive(load_N), "normal_force_N", load_N, "positive and finite");
  require(positive(window.half_width_x_m), "half_width_x_m", window.half_width_x_m,
          "positive and finite");
  require(positive(window.half_width_y_m), "half_width_y_m", window.half_width_y_m,
          "positive and finite");
  const double length = std::sqrt(window.half_width_x_m) * std::sqrt(window.half_width_y_m);
  Problem problem;
  problem.layers = dimensionless_layers(layer, object_layer, length);
  const double height = load_N / (layer.surface().plane_strain_modulus_Pa() * length);
  problem.gap = [&](double x, double y) { return gap_m(length * x, length * y) / height; };
  problem.window = {window.centre_x_m / length, window.centre_y_m / length,
                    window.half_width_x_m / length, window.half_width_y_m / length};
  LayerContact contact = solve(problem, options);
  scale(contact, length, height, load_N / (length * length));
  return contact;
}

LayerContact solve_layer_contact(const RelativeRadii& radii, const LayerStack& layer,
                                 const LayerStack& object_layer, double load_N,
                                 const LayerContactOptions& options) {
  require(positive(load_N), "normal_force_N", load_N, "positive and finite");
  require(positive(radii.minor_m), "minor_m", radii.minor_m, "positive and finite");
  require(radii.major_m >= radii.minor_m && std::isfinite(radii.major_m), "major_m", radii.major_m,
          "finite and not below the minor radius");
  // In the unit of the Hertz contact the load and the mean curvature are 1.
  const double modulus_Pa = layer.surface().plane_strain_modulus_Pa();
  const double mean_radius_m = std::sqrt(radii.major_m) * std::sqrt(radii.minor_m);
  const double length = std::cbrt(load_N / modulus_Pa * mean_radius_m);
  const double height = length * (length / mean_radius_m);
  Problem problem;
  problem.layers = dimensionless_layers(layer, object_layer, length);
  for (auto& one : problem.layers) {
    one.thickness = rounded(one.thickness);
    one.compliance = rounded(one.compliance);
  }
  const double root_ratio = rounded(std::sqrt(radii.major_m / radii.minor_m));
  problem.gap = [=](double x, double y) { return 0.5 * (x * x / root_ratio + y * y * root_ratio); };
  problem.even = true;
  // First guess: the semi-axes on a half-space for moderate ratios. Coarse grids correct it.
  const double guess = std::cbrt(0.75 * problem.compliance());
  const double stretch = std::pow(root_ratio, 2.0 / 3);
  problem.window = {0, 0, 1.3 * guess * stretch, 1.3 * guess / stretch};
  LayerContact contact = solve(problem, options);
  scale(contact, length, height, load_N / (length * length));
  return contact;
}

}  // namespace softfinger
