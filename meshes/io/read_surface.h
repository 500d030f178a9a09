#pragma once

#include <string>

#include "softfinger/input/triangle_surface.h"

namespace softfinger::meshes {

/// A surface as read from a file, with what had to be tolerated.
struct SurfaceFile {
  TriangleSurface surface;       ///< metres, vertices welded
  int degenerate_triangles = 0;  ///< dropped: zero area
  int duplicate_triangles = 0;   ///< dropped: same three vertices
};

/// Reads binary or ASCII STL, or OBJ (by Assimp), scales it to metres and welds equal vertices.
///
/// @param metres_per_unit  1e-3 for millimetres
/// @throws InputError (where = path) for a missing or unreadable file, a file that is no mesh or has no triangles,
/// NaN or infinite coordinates, a truncated file, or a surface larger than 5 m across, which is a wrong unit.
SurfaceFile read_surface(const std::string& path, double metres_per_unit);

/// Writes a binary STL in millimetres, atomically (to a temporary name, then renamed).
/// @throws InputError when the folder cannot be written or the disk is full.
void write_stl_mm(const TriangleSurface& surface, const std::string& path);

}  // namespace softfinger::meshes
