#pragma once

#include <Eigen/Core>
#include <string>

#include "comparisons/report/mesh_page.h"
#include "meshes/io/read_surface.h"

/// Helpers that the commands `mesh`, `fit` and `predict` share: vectors from the command line,
/// points of a surface and the lines of a case for them.
namespace softfinger::commands {

/// "X,Y,Z". @throws InputError(flag)
Eigen::Vector3d parse_vector(const std::string& flag, const std::string& text,
                             const std::string& allowed);

/// The surface of a finger in a file, "-": from standard input.
/// @param unit  "mm" or "m" as typed; empty: it is guessed
/// @throws InputError as meshes::read_surface, and for a guess that makes no finger of it
meshes::SurfaceFile read_typed_surface(const std::string& path, const std::string& unit);

/// A remark on the unit, for commands that have --unit, or empty.
std::string finger_unit_remark(const meshes::SurfaceFile& file);

/// "the nearest point that is round and smooth is 1.2 mm away: near_mm = [..]", or empty where none
/// is found. For points that should not be pressed on.
/// @param normal  outward; null: any side
std::string smooth_point_advice(const TriangleSurface& surface, const Eigen::Vector3d& point_m,
                                const Eigen::Vector3d* normal);

/// A point with the quadric around it, and with the normal of that. Where none can be fitted, the
/// normal is the given one, or the facet's, and `doubt` says why.
/// @param normal  outward, roughly; null: that of the surface
report::MeshPoint describe_point(const TriangleSurface& surface, const std::string& name,
                                 const Eigen::Vector3d& point_m, const Eigen::Vector3d* normal);

/// The surface's point nearest to --near X,Y,Z, in the mesh's unit, "mm" or "m".
/// @param path  of the mesh, for messages
/// @throws InputError for a point that is not near the surface
report::MeshPoint point_near(const TriangleSurface& surface, const std::string& near,
                             const std::string& unit, const std::string& path);

/// The line of [geometry]: "finger = { mesh = .., point_mm = .., normal = .. }". The mesh of
/// standard input is called FILE.stl: a case needs a file.
std::string geometry_line(const std::string& mesh, const std::string& unit,
                          const report::MeshPoint& point);

/// Writes the page of fits to one surface: the region and the quadric of each point.
/// @param mesh  its file, as typed
/// @param points  without their lines for cases, which are added
void write_fits_page(const std::string& file, const std::string& mesh, const std::string& unit,
                     const TriangleSurface& surface, std::vector<report::MeshPoint> points,
                     const std::string& command_line);

/// "5,374 triangles, closed, 16.2 x 12.1 x 28.0 mm"
std::string facts_in_words(const TriangleSurface& surface);

}  // namespace softfinger::commands
