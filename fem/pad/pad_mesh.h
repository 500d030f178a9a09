#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "fem/layer/placed_mesh.h"
#include "fem/pad/convex_outline.h"
#include "fem/problem/mirror_planes.h"

/// Meshes of a flat pad: quadrilaterals of its face, stacked in depth. Stress is singular along the
/// edges of the face and of the backing, so that cells become smaller towards both, by the cube of
/// the distance in cells: quadratic elements then converge as fast as on a smooth field.
///
/// ```
///      polygon: blocks around          rounded: a core, and a ring        smaller face: a further
///      the centre, graded to           that is graded to the              ring from the face's
///      edge the outline                     outline                            to the pad's
///      +-----+-----+                     .--+--.                            +-------------+
///      |     |     |                    / +-+-+ \                           |\   .---.   /|
///      +-----C-----+                   +--+-C-+--+                          | --(  C  )-- |
///      |     |     |                    \ +-+-+ /                           |/   '---'   \|
///      +-----+-----+                     '--+--'                            +-------------+
/// ```
namespace softfinger::fem {

/// The pad and the part of its face that an object touches, lengths in h, coordinates from the
/// centroid of that part.
struct PadGeometry {
  ConvexOutline contact;
  /// The pad's outline where an object's face is smaller and lies inside of it; none: the object
  /// touches the whole face.
  std::optional<ConvexOutline> pad;
  MirrorPlanes planes;  ///< of both: a quarter is meshed, or the whole
  /// Rectangles along x and y, whose contact shares sides with the pad: meshed as a grid.
  bool shares_sides = false;
  /// Radius of the fillet around the face, from the contact's outline to the pad's; 0: none.
  double edge_radius = 0;
};

/// Cells along the lines of a mesh. Each level has about 1.6 times as many as the one before it.
struct PadCells {
  int across = 8;  ///< from the centre to the outline
  int deep = 6;    ///< even
};

/// @param level  0 to 3
PadCells cells_of_level(const PadGeometry& geometry, int level);

/// @throws InputError where the outline is too irregular for these blocks
PlacedMesh mesh_pad(const PadGeometry& geometry, const PadCells& cells);

}  // namespace softfinger::fem
