#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/input/triangle_surface.h"

/// Internal to the geometry library: the connected part of a surface around a point.
namespace softfinger::internal {

/// A region as a quadrature rule over its facets: sum(weights * f(samples)) is the integral of f.
/// The facets, not the vertices alone, are sampled: a tessellation has few vertices where it is
/// flat, and a fit through those few would follow the steeper surroundings.
struct SurfaceRegion {
  Eigen::Matrix3Xd samples_m;    ///< relative to `SurfaceNeighbourhood::centre_m()`
  Eigen::VectorXd weights_m2;    ///< sums to the region's area
  Eigen::Matrix3Xi corners;      ///< columns of `vertices_m` of each sample's facet
  Eigen::Matrix3Xd barycentric;  ///< of each sample in its facet

  Eigen::Matrix3Xd vertices_m;  ///< of all facets that the region touches, relative to the centre
  int vertices_within = 0;      ///< the first of them, which lie within the radius
  Eigen::Vector3d mean_normal;  ///< unit, area-weighted, outward

  /// Angles between the normals of neighbouring facets, over edges that reach into the ball, those
  /// included at which the region ends because the surface turns away: the largest that edges of
  /// half the region's radius reach (no slivers), and the median by the edges' length.
  double sharp_kink_rad = 0, usual_kink_rad = 0;
};

/// A surface as seen from one point: built once (linear in the number of triangles), then regions
/// of any radius cost only what they contain. Keeps a reference to the surface.
class SurfaceNeighbourhood {
 public:
  /// Finds the triangle nearest to the point (true point-triangle distance). Where several are
  /// equally near, at an edge or a vertex, the one that faces along `outward_normal` is taken.
  ///
  /// @throws InputError for a point or normal that is not finite, a surface without triangles, and
  /// a normal that points into the body.
  SurfaceNeighbourhood(const TriangleSurface& surface, const Eigen::Vector3d& point_m,
                       const Eigen::Vector3d* outward_normal);

  /// The component, connected over edges, of the surface inside a ball around `centre_m`, through
  /// triangles within 75 degrees of the region's mean normal. Triangles are clipped at the ball, so
  /// that the region changes smoothly with its radius.
  SurfaceRegion region(double radius_m) const;

  /// Number of vertices of that region within the radius.
  int vertices_within(double radius_m) const;

  /// The smallest radius whose region has at least `count` vertices.
  /// @throws InputError when no region has as many.
  double radius_with_points(int count) const;

  /// The smallest radius, to 5 %, whose region touches at least `count` facets.
  /// @throws InputError when no region touches as many.
  double radius_with_facets(int count) const;

  const Eigen::Vector3d& point_m() const { return point_; }
  const Eigen::Vector3d& centre_m() const { return centre_; }  ///< the surface's nearest point
  double distance_m() const { return distance_; }              ///< from the point to it
  double extent_m() const { return extent_; }                  ///< distance to the farthest vertex

 private:
  struct Component {
    std::vector<int> triangles;
    std::vector<int> vertices;  ///< those within the radius
    Eigen::Vector3d mean_normal;
  };
  Component grow(double radius_m, const Eigen::Vector3d& reference_normal) const;
  Component component(double radius_m) const;
  void measure_kinks(const Component& found, double radius_m, SurfaceRegion& region) const;
  Eigen::Vector3d relative(int vertex) const { return surface_.vertices_m[vertex] - centre_; }

  const TriangleSurface& surface_;
  Eigen::Vector3d point_, centre_;
  double distance_ = 0, extent_ = 0;
  int seed_ = -1;
  // Twice the area times the unit normal, per triangle.
  std::vector<Eigen::Vector3d> area_vectors_;
  // Triangles around vertex v: vertex_triangles_[first_[v]] ... vertex_triangles_[first_[v + 1] -
  // 1].
  std::vector<int> first_, vertex_triangles_;
};

}  // namespace softfinger::internal
