#pragma once

#include <string>

#include "meshes/io/mesh_formats.h"

namespace softfinger::robots {

/// Reads a mesh in a format other than STL and OBJ and makes an STL of it.
/// @param part  the name of one of its parts; empty: all
/// @throws InputError (where = path)
meshes::ConvertedMesh convert_mesh(const std::string& path, const std::string& part);

/// Does that for a file's bytes; `path` is used in messages, for its suffix, and for the folder of
/// the files that it names.
meshes::ConvertedMesh convert_mesh_bytes(std::string bytes, const std::string& path,
                                         const std::string& part);

}  // namespace softfinger::robots
