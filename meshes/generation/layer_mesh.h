#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "meshes/generation/layer_block.h"

namespace softfinger::meshes {

/// A layer from a user's file, in metres: +z out of the finger, the load along the z axis.
struct LayerMesh {
  HexahedralMesh hexahedra;
  /// Faces by their vertices, in order around the face: where an object can touch, and where the
  /// layer is bonded to the rigid core. All other faces are free.
  std::vector<std::array<int, 4>> contact, core;
  /// Thickness under the contact: distance between both surfaces along the z axis. None where the
  /// axis misses one of them.
  std::optional<double> thickness_m;
};

/// Reads a gmsh file (see meshes/io/read_msh.h) with the physical groups "layer" (a volume),
/// "contact" and "core" (surfaces).
/// @param metres_per_unit  of the file's coordinates
/// @param regions          volumes in place of "layer": a cell's region is its volume's place here
/// @throws InputError for a file that cannot be read, a group that is missing or empty, elements of
/// a volume that are not 8-node hexahedra or are inverted, surface elements that are no outer faces
/// of them.
LayerMesh read_layer_mesh(const std::string& path, double metres_per_unit,
                          const std::vector<std::string>& regions = {"layer"});

}  // namespace softfinger::meshes
