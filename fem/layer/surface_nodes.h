#pragma once

#include <Eigen/Core>
#include <array>

namespace softfinger::fem {

/// A node where the surface can be touched.
struct SurfaceNode {
  double x = 0, y = 0;  ///< in the block: arc lengths from the contact point on a curved layer
  double weight = 0;    ///< integral of its shape function over the block's surface, > 0
  double area_ratio = 1;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in space
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();   ///< outward
  bool at_end = false;   ///< of the surface that can be touched, beside what is not meshed
  bool on_edge = false;  ///< on the finger's sharp edge, at which its layer ends
};

/// The area of a node, seen along the load.
inline double seen_area(const SurfaceNode& node) {
  return node.weight * node.area_ratio * node.normal.z();
}

/// A finest face of the surface, an axis-parallel rectangle, with the nodes of its biquadratic
/// shape functions (index x + 3 y; -1 where the node cannot be touched). On a mesh from outside it
/// is the unit square of its own coordinates, wherever it lies.
struct SurfaceFace {
  double x = 0, y = 0, size_x = 0, size_y = 0;
  std::array<int, 9> node;
};

}  // namespace softfinger::fem
