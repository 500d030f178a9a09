#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "softfinger/input/triangle_surface.h"

namespace softfinger::meshes {

/// Point where a line leaves a surface.
struct SurfaceHit {
  Eigen::Vector3d point;   ///< contact frame, in the surface's unit
  Eigen::Vector3d normal;  ///< unit, out of the body
  /// Estimated distance from `point` on the facet to the smooth surface that the mesh stands for,
  /// along the line's unit direction. It is half the distance to the tangent planes in the facet's
  /// vertices, interpolated over the facet. For a quadric with exact normals that is exact. It is
  /// continuous across edges and as large as the facets' sag, h²/(8 R) for edges of length h.
  double rounding = 0;
};

/// Position and orientation of a triangulated body in the contact frame. The vectors are given in
/// the body's own coordinates.
struct SurfacePlacement {
  Eigen::Vector3d point_m;         ///< contact point; the nearest point of the surface is taken
  Eigen::Vector3d outward_normal;  ///< of the body there, any length
  Eigen::Vector3d x_axis;          ///< the contact's x, before the turn; its part across the normal
  double angle_rad = 0;            ///< then the body is turned about the contact's z, right-handed
};

/// A triangulated surface in the contact frame. A tree of boxes makes the cost of intersecting a
/// line about the logarithm of the number of triangles.
///
/// The normals are smooth. At a vertex they are the mean of the facets' normals, weighted by the
/// facets' angles there, so that they do not depend on how a mesh cuts its polygons (Thürmer and
/// Wüthrich 1998). In between they are interpolated barycentrically.
class PlacedSurface {
 public:
  /// The outward normal becomes +z when the body lies `below` the contact plane (a finger), -z when
  /// it lies `above` it (an object).
  enum class Body { below, above };

  /// @throws InputError for a surface without triangles, numbers that are not finite, an x axis
  /// along the normal, a point farther from the surface than a twentieth of its extent, and a
  /// normal that points into the body at the point.
  PlacedSurface(const TriangleSurface& surface, const SurfacePlacement& placement, Body body);

  /// The point where the line from + t direction leaves the body, that is where
  /// direction . facet normal > 0, with t of either sign. Of several the one with the smallest |t|;
  /// null if there is none.
  std::optional<SurfaceHit> nearest_exit(const Eigen::Vector3d& from,
                                         const Eigen::Vector3d& direction) const;

  /// Four points inside each facet: its centre and near its corners.
  std::vector<Eigen::Vector3d> facet_points() const;

  /// The whole surface in the contact frame.
  TriangleSurface in_contact_frame() const { return {vertices_, triangles_}; }

  /// Another surface of the same body, given in the body's coordinates as this one was.
  TriangleSurface in_contact_frame(const TriangleSurface& other) const;

  /// The contact point on the surface, in the body's own coordinates.
  const Eigen::Vector3d& contact_point_m() const { return contact_point_; }

 private:
  /// Inner nodes have their first child next to them and the second at `second`; leaves hold the
  /// triangles [first, last).
  struct Node {
    Eigen::Vector3d low, high;
    int first, last, second;
  };
  int build(int first, int last);

  std::vector<Eigen::Vector3d> vertices_, normals_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<Node> nodes_;
  Eigen::Vector3d contact_point_;
  Eigen::Matrix3d to_contact_;  ///< turns the body's coordinates
};

}  // namespace softfinger::meshes
