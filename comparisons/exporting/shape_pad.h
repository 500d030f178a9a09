#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/exporting/robot_shapes.h"
#include "comparisons/input/pad.h"
#include "softfinger/input/triangle_surface.h"

/// The part of a shape that touches: its place, and its local radii in closed form.
namespace softfinger::exporting {

/// A point of a shape's surface, in the shape's own axes.
struct ShapePad {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< outward
  /// Principal radii; infinite: flat in that direction.
  double major_radius_m = 0, minor_radius_m = 0;
  std::string part;  ///< "a cap of the capsule"
  /// The distance along the surface to where another curvature begins.
  double to_seam_m = std::numeric_limits<double>::infinity();

  bool is_flat() const { return std::isinf(minor_radius_m); }
  bool is_line() const { return std::isinf(major_radius_m) && !is_flat(); }
};

/// The pad that a plane touches which comes against a direction, of length 1, outward. A cylinder
/// and a box have edges and corners there: the face is taken that faces the direction most.
/// @param kind  neither empty nor a mesh
ShapePad pad_towards(const RobotShapeKind& kind, const Eigen::Vector3d& direction);

/// The pad nearest to a point in the shape's axes.
ShapePad pad_near(const RobotShapeKind& kind, const Eigen::Vector3d& point_m);

/// A flat end of a shape as a pad.
struct FlatEnd {
  input::FlatFigure figure;
  /// The figure's axes: its origin, and z outward.
  Eigen::Isometry3d in_shape = Eigen::Isometry3d::Identity();
  bool is_joined = false;  ///< of several shapes
};

/// Faces of boxes in one plane, in the axes of one of them, as one pad; null where they leave more
/// than a tenth of their hull open.
std::optional<FlatEnd> joined(const std::vector<FlatEnd>& ends);

/// The whole face of a box or cylinder on which a flat pad lies.
/// @param pad  flat, of this shape
FlatEnd flat_end(const RobotShapeKind& kind, const ShapePad& pad);

/// The flat face of a mesh on which a point lies; null where there is none, where it has holes or
/// hollows of more than a tenth of its area, or where it may be a facet of something round.
/// @param facing  outward; empty: any
std::optional<FlatEnd> flat_end_of_mesh(const TriangleSurface& surface,
                                        const Eigen::Vector3d& point_m,
                                        const std::optional<Eigen::Vector3d>& facing);

}  // namespace softfinger::exporting
