#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

/// The surface formats that are read: binary STL, ASCII STL, OBJ.
namespace softfinger::meshes {

/// Sizes in a binary STL, bytes.
constexpr std::size_t kStlHeader = 84, kStlTriangle = 50;

/// Allowed files, for messages.
constexpr const char* kAllowedSurface = "a readable STL (binary or ASCII) or OBJ file";

/// A file's triangles as it writes them: vertices may repeat, in the file's unit. Coordinates are
/// rounded to single precision, as STL stores them.
struct RawSurface {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  std::vector<int> lines;  ///< of the vertices, from 1; empty in a binary STL
};

/// Returns the place and the name of a vertex for messages: ("tip.obj:17", "vertex") or ("tip.stl",
/// "vertex 2 of triangle 7").
std::pair<std::string, std::string> place_of_vertex(const RawSurface& surface, int vertex,
                                                    const std::string& path);

/// Recognises the format by the content. The file's name only counts for damaged files, whose
/// content does not show the format. An OBJ file's polygons are cut into triangles; its materials,
/// groups, lines and points are passed over, and no file that it names is opened.
/// @param bytes  of the file
/// @param path   for messages, and for its ending
/// @throws InputError (where = path, with the line where known)
RawSurface parse_raw_surface(const std::string& path, std::string bytes);

}  // namespace softfinger::meshes
