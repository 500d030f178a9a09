#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <string>

#include "comparisons/input/mesh_file.h"
#include "comparisons/input/mesh_unit.h"
#include "comparisons/judgement/pads.h"
#include "comparisons/report/mesh_page.h"
#include "meshes/io/read_surface.h"

/// Helpers that the commands `mesh`, `fit` and `predict` share: vectors from the command line,
/// points of a surface and the lines of a case for them.
namespace softfinger::commands {

/// "X,Y,Z". @throws InputError(flag)
Eigen::Vector3d parse_vector(const std::string& flag, const std::string& text,
                             const std::string& allowed);

/// A mesh as it was typed on the command line.
struct TypedMesh {
  std::string path;  ///< found; "-": standard input, which is STL or OBJ
  std::string unit;  ///< "mm" or "m"; empty: the file's own, or a guess
  std::string part;  ///< empty: all of the file
};

/// Adds --unit and --part.
/// @param also  what else is in the mesh's unit: " and of --point", or nothing
void add_mesh_options(CLI::App& command, std::string& unit, std::string& part,
                      const std::string& also);

/// The surface of a finger in a file.
/// @throws InputError as input::read_mesh_file, and for a guess that makes no finger of it
meshes::SurfaceFile read_typed_surface(const TypedMesh& typed);

/// The surface of a finger as read_typed_surface reads it, but its outer skin alone.
/// @param flag, point  X,Y,Z as typed, where the body is touched, in the mesh's unit; may be empty
meshes::SurfaceFile read_typed_skin(const TypedMesh& typed, const std::string& flag,
                                    const std::string& point);

/// A remark on the unit, for commands that have --unit, or empty.
std::string finger_unit_remark(const meshes::SurfaceFile& file);

/// "the nearest point that is round and smooth is 1.2 mm away: near_mm = [..]", or empty where none
/// is found. For points that should not be pressed on.
/// @param normal  outward; null: any side
std::string smooth_point_advice(const TriangleSurface& surface, const Eigen::Vector3d& point_m,
                                const Eigen::Vector3d* normal);

enum class Advice { none, nearest_point };

/// A point with the quadric around it, and with the normal of that. Where none can be fitted, the
/// normal is the given one, or the facet's, and `doubt` says why.
/// @param normal  outward, roughly; null: that of the surface
/// @param advice  to look for where there is a doubt
report::MeshPoint describe_point(const TriangleSurface& surface, const std::string& name,
                                 const Eigen::Vector3d& point_m, const Eigen::Vector3d* normal,
                                 Advice advice = Advice::nearest_point);

/// The surface's point nearest to --near X,Y,Z, in the mesh's unit.
/// @param path  of the mesh, for messages
/// @throws InputError for a point that is not near the surface
report::MeshPoint point_near(const TriangleSurface& surface, const std::string& near,
                             double metres_per_unit, const std::string& path);

/// The line of [geometry]: "finger = { mesh = .., point_mm = .., normal = .. }". The mesh of
/// standard input is called FILE.stl: a case needs a file.
std::string geometry_line(const input::NamedMesh& mesh, const report::MeshPoint& point,
                          input::MeshRole role = input::MeshRole::finger);

/// Sets how a page names its mesh.
void name_mesh(report::MeshPage& page, const input::NamedMesh& mesh);

/// A pressed place as a point to show, with its line for a case.
report::MeshPoint point_of(const judgement::Pad& pad, const input::NamedMesh& mesh,
                           input::MeshRole role);

/// "usable, torque 2.9 mN·m, contact 8.4 x 4.1 mm, ± 3.1 %", "flat, 22 x 37 mm: a pad", or why it
/// is not usable.
std::string verdict_of(const judgement::Pad& pad);

/// Writes the page of fits to one surface: the region and the quadric of each point.
/// @param page  its points, without their lines for cases, and the prediction, where there is one;
///              the rest is added
void write_fits_page(const std::string& file, const input::NamedMesh& mesh,
                     const TriangleSurface& surface, report::MeshPage page,
                     const std::string& command_line);

/// "5,374 triangles, closed, 16.2 x 12.1 x 28.0 mm"
std::string facts_in_words(const TriangleSurface& surface);
std::string facts_in_words(const meshes::SurfaceFile& file);

}  // namespace softfinger::commands
