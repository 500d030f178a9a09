#pragma once

#include <Eigen/Core>
#include <array>

#include "softfinger/input/triangle_surface.h"

namespace softfinger {

/// A surface near a contact, as depth below its tangent plane: depth = A x² + B y² + C x y,
/// positive into the body, so that a convex body has positive A and B (Ciocarlie et al. 2007, eq.
/// 7).
struct Quadric {
  double A_per_m = 0, B_per_m = 0, C_per_m = 0;
};

/// Quadric with principal radii R1 (along x) and R2 (along y); infinite = flat, negative = concave.
Quadric quadric_from_radii(double radius_x_m, double radius_y_m);

/// Principal directions of a quadric. `radii_m[0]` belongs to the smallest curvature and lies along
/// `axis_rad`; radii are infinite where the surface is flat, negative where it is concave.
struct PrincipalCurvature {
  std::array<double, 2> radii_m;
  double axis_rad = 0;  ///< in (-pi/2, pi/2], counter-clockwise from x; 0 for an umbilic point
};
PrincipalCurvature principal_curvature(const Quadric& quadric);

/// Least-squares quadric of the part of a triangulated surface around a point.
///
/// The standard deviations come from the scatter of the vertices about the quadric. On a body that
/// is no quadric at the scale of the region the radii change with the region by more than that.
struct QuadricFit {
  Quadric quadric;
  Eigen::Matrix3d covariance_per_m2 = Eigen::Matrix3d::Zero();  ///< of (A, B, C)
  PrincipalCurvature principal;
  std::array<double, 2> radii_std_m{};  ///< one standard deviation of principal.radii_m (infinite
                                        ///< for a flat direction)

  Eigen::Vector3d origin_m;  ///< on the fitted surface, nearest to the given point
  Eigen::Vector3d normal;    ///< outward unit normal of the fitted surface there
  Eigen::Vector3d
      x_axis;  ///< unit, in the tangent plane: the projection of the global x axis (of the global y
               ///< axis where the normal is within 30 degrees of x); y = normal cross x_axis

  double residual_rms_m = 0;  ///< area-weighted, between facets and quadric
  double region_radius_m = 0;
  double area_m2 = 0;  ///< of the surface region used
  int points = 0;      ///< vertices of the mesh within the region
};

/// Fits the connected region of `surface` around `point_m` within `region_radius_m`: minimises the
/// integral of (depth of the facets - quadric)² over the region's area (Ciocarlie et al. 2007, eq.
/// 7).
///
/// The region grows from the triangle nearest to the point over shared edges, through triangles
/// that face the same way (within 75 degrees of the region's mean normal), and is clipped at a ball
/// of the given radius around the surface's point nearest to the given one: it never reaches
/// through to the other side of a thin body. The facets are integrated, not their vertices summed,
/// so that the fit does not depend on how the mesh spreads its vertices; the chords of a smooth
/// surface bias the radii by about (edge length / radius)². Tilt and offset are estimated with the
/// quadric and the frame turned until both vanish, so that `outward_normal` only has to tell
/// outside from inside (null: the triangles' orientation does). Works in coordinates relative to
/// the point: accurate far from the origin.
///
/// Cost: linear in the number of triangles; about 1 ms for 5,000.
///
/// @throws InputError when the surface has no triangle within the radius of the point, when fewer
/// than six vertices are in the region, when they lie on a line or a conic, or when
/// `outward_normal` points into the body; ConvergenceError when the region is too strongly curved
/// for one quadric.
QuadricFit fit_quadric(const TriangleSurface& surface, const Eigen::Vector3d& point_m,
                       const Eigen::Vector3d* outward_normal, double region_radius_m);

}  // namespace softfinger
