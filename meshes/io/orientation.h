#pragma once

#include "softfinger/input/triangle_surface.h"

namespace softfinger::meshes {

/// What `orient` did to a surface.
struct Orientation {
  int turned_triangles = 0;
  /// A part has no two sides, as a Moebius strip: its triangles are left as they are.
  bool is_one_sided = false;
};

/// Turns triangles until neighbours run through their common edge in opposite directions. In each
/// connected part the smaller number is turned. A surface that is closed then, with inward normals,
/// is turned as a whole; the sign of the enclosed volume tells.
///
/// Triangles are neighbours where exactly two meet at an edge. Time: that of sorting the edges.
Orientation orient(TriangleSurface& surface);

}  // namespace softfinger::meshes
