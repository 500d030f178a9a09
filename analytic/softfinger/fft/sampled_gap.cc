#include "softfinger/fft/sampled_gap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

constexpr int kFewestSamples = 5;  // two cells inside the outermost points

[[noreturn]] void refuse(const char* field, const std::string& value, const char* allowed) {
  throw InputError("sampled gap", field, value, allowed);
}

std::string place(double x_m, double y_m) {
  return "x " + std::to_string(1e3 * x_m) + " mm, y " + std::to_string(1e3 * y_m) + " mm";
}

/// Weights of the points -1, 0, 1, 2 when a place t between 0 and 1 is interpolated.
std::array<double, 4> weights(double t) {
  const double u = 1 - t;
  return {-0.5 * t * u * u, 1 + t * t * (1.5 * t - 2.5), 1 + u * u * (1.5 * u - 2.5),
          -0.5 * u * t * t};
}

/// The cell of a place, among those with a neighbour on both sides, and the place in it.
std::pair<int, double> locate(double place, int samples) {
  const int cell = std::clamp(static_cast<int>(std::floor(place)), 1, samples - 3);
  return {cell, place - cell};
}

}  // namespace

SampledGap::SampledGap(const Grid& grid, Eigen::ArrayXd samples_m)
    : grid_(grid), samples_m_(std::move(samples_m)) {
  if (!std::isfinite(grid.first_x_m) || !std::isfinite(grid.first_y_m))
    refuse("first_x_m, first_y_m", place(grid.first_x_m, grid.first_y_m), "finite");
  if (!(std::min(grid.spacing_x_m, grid.spacing_y_m) > 0 &&
        std::isfinite(grid.spacing_x_m + grid.spacing_y_m)))
    refuse("spacing_x_m, spacing_y_m",
           std::to_string(grid.spacing_x_m) + ", " + std::to_string(grid.spacing_y_m),
           "positive and finite");
  if (grid.rows < kFewestSamples || grid.columns < kFewestSamples)
    refuse("rows, columns", std::to_string(grid.rows) + ", " + std::to_string(grid.columns),
           "5 or more of each");
  if (samples_m_.size() != static_cast<Eigen::Index>(grid.rows) * grid.columns)
    refuse("samples_m", std::to_string(samples_m_.size()) + " values", "rows times columns values");
  for (Eigen::Index k = 0; k < samples_m_.size(); ++k)
    if (!std::isfinite(samples_m_[k]))
      refuse("samples_m",
             "not finite at " +
                 place(grid.first_x_m + static_cast<double>(k % grid.columns) * grid.spacing_x_m,
                       grid.first_y_m + static_cast<double>(k / grid.columns) * grid.spacing_y_m),
             "finite numbers everywhere: no holes");
  samples_m_ -= samples_m_.minCoeff();
}

double SampledGap::operator()(double x_m, double y_m) const {
  const double column = (x_m - grid_.first_x_m) / grid_.spacing_x_m;
  const double row = (y_m - grid_.first_y_m) / grid_.spacing_y_m;
  // The window's border, as a user computes it, may miss by rounding.
  constexpr double kRounding = 1e-6;
  const auto inside = [](double place, int samples) {
    return place >= 1 - kRounding && place <= samples - 2 + kRounding;
  };
  if (!inside(column, grid_.columns) || !inside(row, grid_.rows))
    refuse("place", place(x_m, y_m), "inside the window of the samples");
  const auto [j, s] = locate(column, grid_.columns);
  const auto [i, t] = locate(row, grid_.rows);
  const auto along_x = weights(s), along_y = weights(t);
  double sum = 0;
  for (int m = 0; m < 4; ++m) {
    const double* samples = samples_m_.data() + (i - 1 + m) * grid_.columns + j - 1;
    double line = 0;
    for (int n = 0; n < 4; ++n) line += along_x[n] * samples[n];
    sum += along_y[m] * line;
  }
  return sum;
}

GapWindow SampledGap::window() const {
  GapWindow window;
  window.centre_x_m = grid_.first_x_m + 0.5 * (grid_.columns - 1) * grid_.spacing_x_m;
  window.centre_y_m = grid_.first_y_m + 0.5 * (grid_.rows - 1) * grid_.spacing_y_m;
  window.half_width_x_m = 0.5 * (grid_.columns - 3) * grid_.spacing_x_m;
  window.half_width_y_m = 0.5 * (grid_.rows - 3) * grid_.spacing_y_m;
  return window;
}

}  // namespace softfinger
