#pragma once

#include <Eigen/Core>

#include "softfinger/fft/layer_contact.h"

namespace softfinger {

/// A gap that is known on a regular grid of points, made smooth: a GapFunction for
/// `solve_layer_contact`, as measured, or sampled from triangulated bodies.
///
/// Cubic convolution between the 4 x 4 nearest points (R. G. Keys, IEEE Trans. Acoust. Speech
/// Signal Process. 29 (1981) 1153): through every sample, with continuous slopes, exact for
/// quadrics, error of third order in the spacing. One sample has no effect farther than two points
/// away: noise is neither smoothed nor spread.
///
/// The lowest sample becomes zero, first touch, so that only differences of the samples matter.
class SampledGap {
 public:
  /// Positions of the samples, in metres.
  struct Grid {
    double first_x_m = 0, first_y_m = 0;      ///< of sample (row 0, column 0)
    double spacing_x_m = 0, spacing_y_m = 0;  ///< > 0, between columns, between rows
    int rows = 0, columns = 0;                ///< >= 5 each
  };

  /// @param samples_m  gap in metres at (first_x + column * spacing_x, first_y + row * spacing_y),
  ///   index = row * columns + column; any constant may be added to all of them
  /// @throws InputError for grids and samples outside these ranges, and for a sample that is not
  ///   finite (a hole), naming where it lies
  SampledGap(const Grid& grid, Eigen::ArrayXd samples_m);

  /// The gap inside `window()`, in metres. About 20 ns.
  /// @throws InputError outside it, where nothing is known
  double operator()(double x_m, double y_m) const;

  /// The samples' rectangle without the outermost points, which only shape the cells within.
  GapWindow window() const;

 private:
  Grid grid_;
  Eigen::ArrayXd samples_m_;
};

}  // namespace softfinger
