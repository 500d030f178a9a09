#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <variant>
#include <vector>

#include "softfinger/input/triangle_surface.h"

namespace softfinger::simulation {

/// Finds what is near a triangulated surface, by a tree of balls and boxes over its triangles. All
/// in the surface's frame, in metres. A query costs the logarithm of the number of triangles, more
/// where many are equally near.
class TriangleTree {
 public:
  /// @param surface  outlives the tree; has at least one triangle
  explicit TriangleTree(const TriangleSurface& surface);

  /// A point where both ends are the same.
  struct Segment {
    Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  };
  /// Centred in its frame.
  struct Block {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    Eigen::Vector3d half_size_m = Eigen::Vector3d::Zero();
  };
  using Core = std::variant<Segment, Block>;

  struct Nearest {
    double distance_m = std::numeric_limits<double>::infinity();  ///< 0: the core meets the surface
    Eigen::Vector3d on_surface = Eigen::Vector3d::Zero(), on_core = Eigen::Vector3d::Zero();
    int triangle = -1;  ///< -1: none is nearer than the limit
  };
  /// The nearest points of surface and core.
  /// @param limit_m  what is farther away is of no interest
  /// @param guess    a triangle that may be near: the search is faster; -1: none is known
  Nearest nearest(const Core& core, double limit_m, int guess = -1) const;

  /// Whether a point lies within the closed surface, by its winding number. Linear cost, unless it
  /// lies outside of the box around all.
  bool contains(const Eigen::Vector3d& point) const;

  /// The vertex farthest along a direction.
  Eigen::Vector3d support(const Eigen::Vector3d& direction) const;

  /// Outward unit normal of a triangle; zero of one without area.
  Eigen::Vector3d normal(int triangle) const;

  /// The triangles that reach into a ball, with their vertices.
  TriangleSurface within(const Eigen::Vector3d& centre, double radius_m) const;

 private:
  struct Node {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    double radius_m = 0;                                    ///< of the ball
    Eigen::Vector3d half_size_m = Eigen::Vector3d::Zero();  ///< of the box
    int first = 0, count = 0;                ///< of a leaf's triangles in order_; 0: two children
    int first_vertex = 0, vertex_count = 0;  ///< of a leaf in vertices_m_: in no leaf before it
    int left = -1, right = -1;
  };
  int build(int first, int count);
  void collect_vertices();
  template <class Probe>
  Nearest search(const Probe& probe, double limit_m, int guess) const;
  Eigen::Vector3d corner(int triangle, int k) const {
    return surface_
        .vertices_m[std::size_t(surface_.triangles[std::size_t(triangle)][std::size_t(k)])];
  }

  const TriangleSurface& surface_;
  std::vector<int> order_;  ///< triangles, those of a leaf next to each other
  std::vector<Node> nodes_;
  std::vector<Eigen::Vector3d> vertices_m_;  ///< of the triangles, each once
};

}  // namespace softfinger::simulation
