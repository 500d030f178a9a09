#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace softfinger::fem {

/// The mesh of a layer for a contact of semi-axes a along x and b along y, of which a is the longer
/// one unless the layer is a scan's. Lengths in units of the thickness h.
struct LayerDiscretisation {
  double a = 1, b = 1;
  int elements_per_semi_axis = 8;  ///< n: finest cells along the shorter one
  double patch = 1.25;             ///< contact is possible within this multiple of the ellipse
  double extent = 6;               ///< side wall at a + extent, b + extent: see README.md
  bool is_scan = false;            ///< the shape ends where it must, not at the block's sides
  bool clamped_wall = false;       ///< the side wall is bonded too, else it is free
  /// Depths of the interfaces between bonded sublayers, from the surface on: no cell crosses one.
  std::vector<double> interfaces;

  /// Share of the reach below that the refined patch may take: a last cell has to fit beside it.
  static constexpr double usable_reach = 0.98;
  /// The block may go this far along x and y, as the surface may end. Infinite for a flat layer.
  double reach_x = std::numeric_limits<double>::infinity();
  double reach_y = std::numeric_limits<double>::infinity();

  /// Finest cells along a and b: n, more where cells would be longer than three times their width.
  int elements_along_a() const;
  int elements_along_b() const;

  /// Half-extents of the surface along x and y that hold the patch and one cell beside it.
  Eigen::Vector2d needed_reach() const;
  bool is_within_reach() const;
};

}  // namespace softfinger::fem
