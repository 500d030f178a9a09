#pragma once

#include <Eigen/Core>
#include <vector>

#include "meshes/scans/smooth_surface.h"

namespace softfinger::meshes {

/// Reason why a cloth ends at a node.
enum class ClothEnd : char {
  none,    ///< it does not: the node lies on the surface
  edge,    ///< at a sharp edge of the surface, beyond which it is continued a little
  far,     ///< farther than was asked for
  rim,     ///< the surface ends
  turned,  ///< the surface faces away from the load
  crease,  ///< the surface turns too sharply
  fold,    ///< the cloth or the layer under it would fold
};

/// A square lattice of points laid on a surface as a cloth is, lengths and angles changed as little
/// as possible. Node (i, j) is the place of the point (i, j) times the spacing; (0, 0) is where it
/// is pinned.
class Cloth {
 public:
  struct Node {
    Eigen::Vector3d position = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::UnitZ();
    ClothEnd end = ClothEnd::far;
    bool is_beyond = false;  ///< a sharp edge: the surface is continued there
  };

  Cloth(int half, double spacing) : half_(half), spacing_(spacing) {
    nodes_.resize(static_cast<std::size_t>((2 * half + 1) * (2 * half + 1)));
  }

  int half() const { return half_; }  ///< indices run from -half to half
  double spacing() const { return spacing_; }
  bool contains(int i, int j) const { return std::abs(i) <= half_ && std::abs(j) <= half_; }
  bool lies(int i, int j) const { return contains(i, j) && node(i, j).end == ClothEnd::none; }
  Node& node(int i, int j) { return nodes_[index(i, j)]; }
  const Node& node(int i, int j) const { return nodes_[index(i, j)]; }

 private:
  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>((i + half_) + (2 * half_ + 1) * (j + half_));
  }
  int half_;
  double spacing_;
  std::vector<Node> nodes_;
};

/// Lays a cloth over the disc of this radius around a point of the surface. It grows from there
/// ring by ring; after each one it is relaxed as rigidly as possible (O. Sorkine, M. Alexa,
/// As-Rigid-As-Possible Surface Modeling, SGP 2007) and drawn to the surface.
/// @param x_axis  of the cloth at its centre; its part along the surface counts
Cloth lay_cloth(const SmoothSurface& surface, const SmoothSurface::Point& centre,
                const Eigen::Vector3d& x_axis, double radius, double spacing);

}  // namespace softfinger::meshes
