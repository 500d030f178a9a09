#pragma once

#include <Eigen/Core>

#include "softfinger/input/triangle_surface.h"

/// The object and fingertip surfaces of the built-in mesh cases, triangulated by gmsh. They are
/// written as STL and read like a user's own files. All surfaces are closed, their triangles are
/// counter-clockwise seen from outside, and their vertices lie on the exact surface. Metres.
namespace softfinger::meshes {

/// A point on an exact surface with its exact radii, for tests and cases.
struct SurfacePoint {
  Eigen::Vector3d point_m;
  Eigen::Vector3d normal;           ///< outward, unit
  double major_m = 0, minor_m = 0;  ///< principal radii, major >= minor; infinite where straight
  Eigen::Vector3d major_direction;  ///< unit, along which the radius is `major_m`
};

/// Shadow-like distal pad: a smooth convex body with a larger radius along the finger than across
/// it, the cross-section tapering towards the tip. Pad faces -y, tip at +z, as on the hand's own
/// link.
///
/// It is the image of the unit sphere (u, v, w) under
///   x = R_across s(w) (1 - t z) u,  y = R_across s(w) v,  z = (length / 2) w,
///   s(w) = sqrt(1 + (1 - alpha) w²),  alpha = (length / 2)² / (R_across R_along),
/// so that the profile in the plane x = 0 is y² = R_across² (1 - alpha w² - (1 - alpha) w⁴), whose
/// curvature radius at z = 0 is R_along, and the cross-section at z = 0 is a circle of R_across.
/// The taper t makes the widths at z = +-length/4 stand in the ratio `tip_to_base_width`.
struct FingertipPad {
  double across_radius_m = 7e-3;    ///< of the cross-section at the pad's middle
  double along_radius_m = 25e-3;    ///< of the pad's profile along the finger, at its middle
  double length_m = 26e-3;          ///< alpha between 0.3 and 1.3, where the body is convex
  double tip_to_base_width = 0.75;  ///< ratio of the widths: the taper; 0.5 to 1
  double edge_length_m = 0.6e-3;
};
/// @throws InputError for a shape outside the ranges given.
TriangleSurface fingertip_pad(const FingertipPad& shape);
/// The pad's middle, (0, -across_radius, 0): radii exactly as the shape names them.
SurfacePoint fingertip_pad_middle(const FingertipPad& shape);

/// A drinking glass as a surface of revolution about z, standing on z = 0: conical wall with
/// thickness 6 % of the rim's radius, rounded foot and rim, hollow.
TriangleSurface glass(double foot_radius_m, double rim_radius_m, double height_m,
                      double edge_length_m);
/// Half-way up the outer wall, at +x.
SurfacePoint glass_wall_middle(double foot_radius_m, double rim_radius_m, double height_m);

/// Cube around the origin with all edges rounded.
TriangleSurface rounded_box(double side_m, double edge_radius_m, double edge_length_m);
/// The middle of the rounded edge between the faces +x and +y.
SurfacePoint rounded_box_edge_middle(double side_m, double edge_radius_m);

/// Cylinder around the origin, axis z.
TriangleSurface cylinder(double radius_m, double length_m, double edge_length_m);
TriangleSurface sphere(double radius_m, double edge_length_m);

}  // namespace softfinger::meshes
