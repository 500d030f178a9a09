#pragma once

#include <optional>
#include <string>

/// The formats of mesh files, by their names' suffixes. STL and OBJ have readers here
/// (read_surface.h); the others are read by a program of their own, softfinger-robot, which turns
/// them into STL.
namespace softfinger::meshes {

struct MeshFormat {
  const char* suffix;  ///< in small letters, with its point
  const char* name;
  bool is_converted;  ///< by softfinger-robot
  bool has_unit;      ///< a file says in which unit its coordinates are
  bool has_parts;     ///< a file may hold several parts, with names
};

/// All formats, for messages.
constexpr const char* kMeshFormats = "STL, OBJ, DAE, GLB, glTF, PLY or 3MF";

/// The format of a file, by the suffix of its name, in small or capital letters; null: none of
/// them. A file of another suffix may still be an STL or OBJ file, which are known by their
/// content.
const MeshFormat* mesh_format(const std::string& path);

/// Whether softfinger-robot has to turn the file into STL.
bool is_converted_mesh(const std::string& path);

/// A file of another format as an STL.
struct ConvertedMesh {
  std::string stl;                        ///< binary, in the file's own unit and axes
  std::optional<double> metres_per_unit;  ///< as the file says it
  std::string note;                       ///< what was left out, or empty
};

}  // namespace softfinger::meshes
