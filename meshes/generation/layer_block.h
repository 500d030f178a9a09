#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace softfinger::meshes {

/// Hexahedra with shared vertices. A cell lists its bottom face counter-clockwise seen from above,
/// then its top face in the same order (gmsh's and VTK's ordering).
struct HexahedralMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::array<int, 8>> cells;
  std::vector<int> region;  ///< of each cell: of which sublayer it is a part
};

/// A sublayer of a block.
struct BlockSublayer {
  double thickness = 1;
  int cells = 2;  ///< number through its thickness
};

/// A quarter of a layer, [0, length_x] x [0, length_y] x [-its thickness, 0], in any unit of
/// length: uniform cells over the inner rectangle, growing geometrically from there to the side
/// walls.
struct LayerBlock {
  double inner_x = 1,
         inner_y = 1;  ///< extent of the uniform part; it becomes up to one cell larger
  double length_x = 6, length_y = 6;  ///< > inner
  double cell_x = 0.5, cell_y = 0.5;  ///< cell size in the uniform part
  double growth = 1.4;                ///< ratio of neighbouring cells in the graded part, > 1
  /// Sublayers from the surface inwards. Each cell lies in one sublayer.
  std::vector<BlockSublayer> sublayers = {{}};
};

/// Meshes the block by gmsh's transfinite interpolation: all hexahedra.
/// @throws InputError for lengths that are not positive or not nested.
HexahedralMesh mesh_layer_block(const LayerBlock& block);

}  // namespace softfinger::meshes
