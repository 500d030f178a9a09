#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <vector>

namespace softfinger::fem {

/// A mesh of a layer whose quadratic nodes its maker places: cells may be curved. Lengths in h; the
/// bottom is bonded.
struct PlacedMesh {
  std::vector<Eigen::Vector3d> vertices;  ///< no two in one place
  /// Vertices of each cell row by row, then layer by layer from the bottom, so that its own
  /// coordinates are right-handed and the third one points outwards.
  std::vector<std::array<unsigned int, 8>> cells;
  /// Whether a cell lies at the surface where an object can touch it.
  std::vector<char> touched;
  /// Place of a point of a cell, whose own coordinates run from 0 to 1.
  std::function<Eigen::Vector3d(std::size_t cell, const Eigen::Vector3d& unit)> place;
  bool curved = true;  ///< else the cells are those that the vertices span
};

}  // namespace softfinger::fem
