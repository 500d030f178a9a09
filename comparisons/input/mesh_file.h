#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "meshes/io/read_surface.h"

/// Users' mesh files in any format (mesh_formats.h). STL and OBJ are read here. The others are
/// turned into STL by the program softfinger-robot, with limits of time and memory, so that this
/// program does not load their reader and does not end with it.
namespace softfinger::input {

/// Reads a surface as meshes::read_surface does.
/// @param part  the name of one part of the file; empty: all of it
/// @param metres_per_unit  typed; none: the file's own unit, or a guess
/// @throws InputError, also where softfinger-robot is not there, or names nothing of the file
meshes::SurfaceFile read_mesh_file(const std::filesystem::path& path, const std::string& part,
                                   std::optional<double> metres_per_unit);

/// The file as an STL. Each file is converted once.
/// @throws InputError
meshes::ConvertedMesh converted_mesh(const std::filesystem::path& path, const std::string& part);

/// A file with this mesh that a process of this user can read as STL or OBJ while this one lives:
/// itself, or one in memory.
/// @throws InputError
std::filesystem::path plain_mesh_file(const std::filesystem::path& path, const std::string& part);

/// A mesh as a case or a command line names it.
struct NamedMesh {
  std::string file;  ///< as typed
  std::string part;  ///< empty: all of it
  double metres_per_unit = 1e-3;
  bool is_own_unit = false;  ///< the file says its unit: nobody need name it

  /// Entries of a table: mesh = "tip.dae", part = "pad", unit = "mm".
  std::string entries() const;
  /// Options of a command: --part pad --unit mm.
  std::string options() const;
};

NamedMesh named_mesh(const std::string& typed, const std::string& part,
                     const meshes::SurfaceFile& file);

}  // namespace softfinger::input
