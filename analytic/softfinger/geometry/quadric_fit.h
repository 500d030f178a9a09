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

/// Kind of surface in the fitted region.
enum class SurfaceKind {
  smooth,
  sharp_edge  ///< a kink of more than 35 degrees that stands out from the mesh's usual kinks: a
              ///< quadric's radii say little about a contact there
};

/// Least-squares quadric of the part of a triangulated surface around a point.
///
/// The standard deviations come from the scatter of the vertices about the quadric, with Student's
/// factor for few vertices, such that two of them hold both radii of a noisy quadric, together, in
/// 95 % of all cases (each one alone in 97.5 %). On a body that is no quadric at the scale of the
/// region the radii change with the region by more than that: see `radii_region_change_m`.
struct QuadricFit {
  Quadric quadric;
  Eigen::Matrix3d covariance_per_m2 = Eigen::Matrix3d::Zero();  ///< of (A, B, C)
  PrincipalCurvature principal;
  /// One standard deviation of principal.radii_m: wide enough that two of it reach the far end of
  /// two standard deviations of the curvature, and including the amount by which noise pushes
  /// nearly equal radii apart. Infinite for a flat direction.
  std::array<double, 2> radii_std_m{};

  Eigen::Vector3d origin_m;  ///< on the fitted surface, nearest to the given point
  Eigen::Vector3d normal;    ///< outward unit normal of the fitted surface there
  Eigen::Vector3d
      x_axis;  ///< unit, in the tangent plane: the projection of the global x axis (of the global y
               ///< axis where the normal is within 30 degrees of x); y = normal cross x_axis

  double residual_rms_m = 0;  ///< area-weighted, between facets and quadric
  double region_radius_m = 0;
  double area_m2 = 0;  ///< of the surface region used
  int points = 0;      ///< vertices of the mesh within the region
  int outliers = 0;    ///< spikes left out: single vertices at 8 times the usual distance
  SurfaceKind surface_kind = SurfaceKind::smooth;
  double sharpest_kink_rad = 0;  ///< between neighbouring facets in the region or at its end, over
                                 ///< edges of half the region's radius together
};

/// The axes in which a surface with this outward unit normal is described: x, y, normal in columns,
/// as QuadricFit::x_axis says.
Eigen::Matrix3d surface_axes(const Eigen::Vector3d& normal);

/// Fits the connected region of `surface` around `point_m` within `region_radius_m`: minimises the
/// integral of (depth of the facets - quadric)² over the region's area (Ciocarlie et al. 2007, eq.
/// 7).
///
/// The region grows from the triangle nearest to the point over shared edges, through triangles
/// that face the same way (within 75 degrees of the region's mean normal), and is clipped at a ball
/// of the given radius around the surface's point nearest to the given one: it never reaches
/// through to the other side of a thin body. The facets are integrated, not their vertices summed,
/// so that the fit does not depend on how the mesh spreads its vertices. They are compared with the
/// quadric's own facets between the same vertices: a quadric is fitted exactly, however coarse and
/// irregular its mesh. Where large facets do not kink at their edges as those of the quadric would,
/// because a tessellation has few vertices where it is flat, and where most of the region lies in
/// facets longer than its radius, they are compared with the quadric itself; the difference between
/// the two readings of the mesh is then part of the covariance. Tilt and offset are estimated with
/// the quadric and the frame turned until both vanish, so that `outward_normal` only has to tell
/// outside from inside (null: the triangles' orientation does). Works in coordinates relative to
/// the point: accurate far from the origin.
///
/// Cost: linear in the number of triangles; a few ms for 5,000.
///
/// @throws InputError when the surface has no triangle within the radius of the point, when fewer
/// than six vertices are in the region, when they lie on a line or a conic, or when
/// `outward_normal` points into the body; ConvergenceError when the region is too strongly curved
/// for one quadric.
QuadricFit fit_quadric(const TriangleSurface& surface, const Eigen::Vector3d& point_m,
                       const Eigen::Vector3d* outward_normal, double region_radius_m);

/// Returns how much the radii depend on the region: the largest change of each principal curvature
/// between the given fit and those over 0.8 and 1.25 times its radius, as a change of the radius,
/// R² dk. Infinite for flat directions, and where neither region can be fitted or each holds
/// another part of the surface: then the change is not known. Noise changes the radii too; only
/// what exceeds the standard deviations is the surface's departure from a quadric.
std::array<double, 2> radii_region_change_m(const TriangleSurface& surface,
                                            const Eigen::Vector3d& point_m,
                                            const Eigen::Vector3d* outward_normal,
                                            const QuadricFit& fit);

/// Whether a region of 1.25 times the radius would hold nothing more: the region takes in the whole
/// connected surface that faces as it does at the point.
bool is_whole_surface(const TriangleSurface& surface, const Eigen::Vector3d& point_m,
                      const Eigen::Vector3d* outward_normal, double region_radius_m);

}  // namespace softfinger
