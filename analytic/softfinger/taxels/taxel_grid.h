#pragma once

#include <Eigen/Core>

namespace softfinger::taxels {

/// A rectangular array of square taxels in the contact plane. The array's centre is the contact's,
/// x runs along the contact's long axis.
struct TaxelGrid {
  static constexpr int kMost = 64;  ///< along a side

  int columns = 0, rows = 0;  ///< along x, along y: 1 to kMost
  double pitch_m = 0;         ///< side of a taxel, > 0

  double left_m() const { return -0.5 * columns * pitch_m; }
  double lower_m() const { return -0.5 * rows * pitch_m; }
  double x_m(int column) const { return left_m() + (column + 0.5) * pitch_m; }
  double y_m(int row) const { return lower_m() + (row + 0.5) * pitch_m; }
};

/// Forces of a contact on small cells, whole numbers of which make a taxel. They may lie beside the
/// array.
struct ForceCells {
  TaxelGrid grid;
  int per_taxel_x = 1, per_taxel_y = 1;  ///< cells along a taxel's sides
  int begin_x = 0, begin_y = 0;  ///< place of the first cell, in cells from the array's lower left
  Eigen::ArrayXXd force_N;       ///< normal, (i, j): cell begin_x + i along x, begin_y + j along y
  /// Friction on the layer, likewise; empty: none, or not known.
  Eigen::ArrayXXd shear_x_N, shear_y_N;

  /// Moments of the normal forces before they were put into cells, about the centre.
  double spread_x_m = 0, spread_y_m = 0;  ///< root of the mean of x², of y²
  double arm_m = 0;                       ///< mean distance from the centre
  /// Load over the sum of the normal forces as they were integrated, by which all have been
  /// multiplied.
  double normalisation = 1;

  bool has_shear() const { return shear_x_N.size() > 0; }
  double step_x_m() const { return grid.pitch_m / per_taxel_x; }
  double step_y_m() const { return grid.pitch_m / per_taxel_y; }
  double x_m(int i) const { return grid.left_m() + (begin_x + i) * step_x_m(); }  ///< left side
  double y_m(int j) const { return grid.lower_m() + (begin_y + j) * step_y_m(); }
};

}  // namespace softfinger::taxels
