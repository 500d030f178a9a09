#pragma once

#include "softfinger/input/triangle_surface.h"

namespace softfinger::meshes {

/// Changes that `orient` made to a surface.
struct Orientation {
  int turned_triangles = 0;
  /// Some part is one-sided, like a Moebius strip: its triangles are left as they are.
  bool is_one_sided = false;
};

/// Turns triangles until neighbours traverse their common edge in opposite directions. In each
/// connected part the smaller number is turned. A surface that is then closed with inward normals
/// (its enclosed volume is negative) is turned as a whole.
///
/// Triangles are neighbours where exactly two meet at an edge. Time: that of sorting the edges.
Orientation orient(TriangleSurface& surface);

}  // namespace softfinger::meshes
