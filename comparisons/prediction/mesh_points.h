#pragma once

#include <Eigen/Core>
#include <ctime>
#include <optional>
#include <string>
#include <vector>

#include "meshes/io/read_surface.h"
#include "softfinger/geometry/quadric_fit.h"
#include "softfinger/input/triangle_surface.h"

/// Points of a triangulated surface that a person need not type.
namespace softfinger::prediction {

/// Leaves out the facets that lie inside of the body, where nothing touches them: the inside of a
/// hollow tip, screws, bones. Nothing is left out where one of the points lies on such a facet:
/// then the body is touched there, as a cup is from its inside. Nor of so many triangles that it
/// would take long.
/// @param touched_m  points that are given, near the surface
void keep_outer_skin(meshes::SurfaceFile& file, const std::vector<Eigen::Vector3d>& touched_m);

/// The point of the surface that lies farthest in a direction: where a plane that comes from there
/// touches first. Where a whole facet or edge lies that far, within 1e-5 of the surface's size (a
/// file's rounding), it is the point of that part nearest to the part's centre, so that it does not
/// depend on the order of the vertices.
/// @param surface    with at least one triangle, m
/// @param direction  of length 1
Eigen::Vector3d extreme_point_m(const TriangleSurface& surface, const Eigen::Vector3d& direction);

/// The quadric around a point where no load says how large the region has to be: about forty
/// vertices determine a quadric well. Where they lie so close, as around the pole of a sphere by
/// longitudes, that they do not, or where they are noisy, the region grows until the smaller radius
/// is known to 1 %, or the surface is another one there. Where vertices determine none, as on a
/// wall that is straight in one direction, ten facets are taken.
/// @throws InputError, ConvergenceError as fit_quadric
QuadricFit fit_around(const TriangleSurface& surface, const Eigen::Vector3d& point_m,
                      const Eigen::Vector3d* outward_normal);

/// A search for another point, usually of 0.3 s, ends after 3 s of the processor, so that its end
/// does not depend on what else a machine does.
constexpr std::clock_t kLongestSearch = 3 * CLOCKS_PER_SEC;

/// Vertices around a point, at most a hundred, the nearest first: dense beside it and sparse far
/// away, each at least half its distance from the others.
std::vector<Eigen::Vector3d> points_around(const TriangleSurface& surface,
                                           const Eigen::Vector3d& centre_m);

/// Why a fit at a point should not be pressed on: a sharp edge in the region, a smaller radius that
/// the fit does not know to 50 %; empty where there is nothing against it.
std::string doubt_of(const QuadricFit& fit);

/// The nearest of `points_around` whose fit is convex, with both radii known to 50 %, and that
/// faces the same side; null where there is none, and after `kLongestSearch`.
/// @param normal  outward at `centre_m`; null: any side
std::optional<Eigen::Vector3d> nearest_smooth_point(const TriangleSurface& surface,
                                                    const Eigen::Vector3d& centre_m,
                                                    const Eigen::Vector3d* normal);

/// "[1, -7.25, 0]" in mm, as files have it: to 0.1 micrometres, without a minus before zero.
std::string in_millimetres(const Eigen::Vector3d& point_m);

/// The surface's area. It is closed where each edge has two triangles that run through it in
/// opposite directions.
struct SurfaceFacts {
  Eigen::Vector3d least_m, largest_m;  ///< corners of the box
  double area_m2 = 0;
  std::size_t open_edges = 0;  ///< edges that do not have exactly two such triangles; 0: closed
};
SurfaceFacts facts_of(const TriangleSurface& surface);

}  // namespace softfinger::prediction
