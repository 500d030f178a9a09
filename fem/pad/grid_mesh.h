#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "fem/layer/placed_mesh.h"

namespace softfinger::fem {

/// One direction of a pad's face and how its cells are spread, lengths in h.
struct GridAxis {
  double low = 0, high = 0;  ///< side walls, or a mirror plane at low = 0
  double middle = 0;         ///< of the contact
  double contact = 0;        ///< its half-length; where it exceeds the face, the walls end it
  bool is_mirrored = false;

  double first() const { return std::max(low, middle - contact); }
  double last() const { return std::min(high, middle + contact); }
};

/// Lines of a grid, ascending. Cells are contact/cells wide in the contact, at most 1.5/cells at
/// its edges (the pressure falls to zero over a thickness) and 0.6/cells at walls that it reaches,
/// and grow away from both.
std::vector<double> grid_lines(const GridAxis& axis, int cells);

/// Lines from the bond at -1 to the face at 0, the finer there the smaller the contact.
/// @param contact  its smaller half-length
std::vector<double> grid_depths(double contact, int cells);

/// A block of hexahedra between the lines of x, y and depth (-1 at the bond to 0 at the face).
/// @param touchable  lowest and highest x and y that an object may touch
PlacedMesh grid_mesh(const std::vector<double>& x, const std::vector<double>& y,
                     const std::vector<double>& depths, const Eigen::AlignedBox2d& touchable);

}  // namespace softfinger::fem
