#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "comparisons/input/shape.h"
#include "comparisons/simulation/triangle_tree.h"
#include "softfinger/geometry/quadric_fit.h"

/// Shapes as surfaces: positions, normals and curvatures in closed form.
namespace softfinger::simulation {

/// A surface near one of its points, to second order.
struct SurfacePoint {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< outward
  /// Change of the normal per length, a symmetric tensor in the tangent plane: positive for convex.
  Eigen::Matrix3d curvature_per_m = Eigen::Matrix3d::Zero();
  bool smooth = true;  ///< false at edges and rims, where the curvature means nothing
};

/// A point of the shape's surface near `point_m`, both in the shape's frame: the nearest one, on an
/// ellipsoid the one on the ray from its centre. Not for meshes.
SurfacePoint surface_near(const input::ShapeKind& kind, const Eigen::Vector3d& point_m);

/// A point of the quadric that was fitted to a mesh, above or below `point_m` along the fit's
/// normal.
SurfacePoint surface_near(const QuadricFit& fit, const Eigen::Vector3d& point_m);

/// The farthest point in a direction; of a half-space that contains the direction, an infinite one.
Eigen::Vector3d support_point(const input::ShapeKind& kind, const Eigen::Vector3d& direction);

/// Points that together bear a flat contact in a direction: corners, points of a rim, ends of an
/// edge. One for a round shape. At most eight; of a mesh those vertices that are farthest in eight
/// directions slightly beside the given one: the corners of its flat side, or what it would tip
/// over.
std::vector<Eigen::Vector3d> bearing_points(const input::ShapeKind& kind,
                                            const Eigen::Vector3d& direction);

/// Half the diagonal of the box around the shape, about its frame's origin; infinite for a
/// half-space.
double bounding_radius_m(const input::ShapeKind& kind);

/// A shape of a body, in the scene's list.
struct Part {
  int body = -1;
  const input::Shape* shape = nullptr;
  double radius_m = 0;                                     ///< of a ball around it
  const TriangleTree* tree = nullptr;                      ///< of a mesh
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< in the world, now

  const input::ShapeKind& kind() const { return shape->kind; }
  bool is_mesh() const { return std::holds_alternative<input::Mesh>(kind()); }
  bool is_half_space() const { return std::holds_alternative<input::HalfSpace>(kind()); }
  /// A point or a direction of the world in the shape's frame.
  Eigen::Vector3d local_point(const Eigen::Vector3d& point_m) const;
  Eigen::Vector3d local_direction(const Eigen::Vector3d& direction) const;
};

/// `support_point` and `bearing_points` of a part, in its frame: the same, of a mesh by its tree.
Eigen::Vector3d support_point(const Part& part, const Eigen::Vector3d& direction);
std::vector<Eigen::Vector3d> bearing_points(const Part& part, const Eigen::Vector3d& direction);

/// Two tangents and the normal; the tangents depend on the normal alone.
Eigen::Matrix3d any_axes(const Eigen::Vector3d& normal);

/// The surface of a part near a point, all in the world. @param fit  of a mesh, in its frame
SurfacePoint surface(const Part& part, const std::optional<QuadricFit>& fit,
                     const Eigen::Vector3d& point_m);

}  // namespace softfinger::simulation
