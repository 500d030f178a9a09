#pragma once

#include <string>

#include "comparisons/robots/mesh_parts.h"

namespace softfinger::robots {

/// Reads a 3MF file: the objects that it builds, in their places, also those that lie in other
/// files of the archive (production extension, which slicers write). Colours, textures, lattices
/// and slices are not read.
///
/// It is no work for Assimp 5.2, which does not tell the unit, leaves out objects of other files
/// without a word, and reads beyond the end of a transform that is too short.
/// @param bytes  of the file
/// @param path   for messages
/// @throws InputError
MeshParts read_3mf(std::string bytes, const std::string& path);

}  // namespace softfinger::robots
