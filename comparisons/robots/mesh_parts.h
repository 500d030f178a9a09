#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "meshes/io/mesh_formats.h"

/// A mesh file of several parts, each with its place, as DAE, glTF and 3MF have them.
namespace softfinger::robots {

struct PartMesh {
  std::string name;
  std::vector<Eigen::Vector3d> vertices;  ///< in the file's unit
  std::vector<std::array<int, 3>> triangles;
};

/// Several meshes in one place, relative to another node.
struct PartNode {
  std::string name;
  int parent = -1;  ///< stands before this one; -1: the file's own axes
  Eigen::Affine3d in_parent = Eigen::Affine3d::Identity();
  std::vector<std::size_t> meshes;
};

struct MeshParts {
  std::vector<PartMesh> meshes;
  std::vector<PartNode> nodes;
  std::optional<double> metres_per_unit;  ///< as the file says it
  std::size_t left_out = 0;               ///< points and lines
};

/// Puts all parts in their places and makes one STL of them.
/// @param path  for messages
/// @param part  the name of a node, which is taken with all that hangs on it, or of a mesh; empty:
///              everything
/// @throws InputError for an unknown part, indices out of range, numbers that are none, no
/// triangles or too many
meshes::ConvertedMesh merged(const MeshParts& parts, const std::string& path,
                             const std::string& part);

}  // namespace softfinger::robots
