#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger::meshes {

/// Larger files, and files with more nodes or more elements, are refused.
constexpr std::size_t kLargestMsh_bytes = 2'000'000'000, kMostMshNodes = 20'000'000,
                      kMostMshElements = 20'000'000;

/// The mesh in a gmsh file (.msh): lengths in the file's unit, every index valid, every coordinate
/// finite.
struct MshFile {
  /// A point, curve, surface or volume of the model that was meshed.
  struct Entity {
    int dimension = 0, tag = 0;
    std::vector<int> physical_tags;  ///< of the groups that it belongs to, positive
  };
  struct Element {
    std::size_t tag = 0;         ///< its number in the file
    int type = 0;                ///< gmsh's number of its shape
    int entity = 0;              ///< place in `entities`
    std::size_t first_node = 0;  ///< place in `element_nodes`; its others follow there
  };
  /// A group of entities of one dimension.
  struct PhysicalName {
    int dimension = 0, tag = 0;
    std::string name;
  };

  std::vector<std::size_t> node_tags;  ///< the nodes' numbers in the file, all different
  std::vector<Eigen::Vector3d> nodes;
  std::vector<Entity> entities;
  std::vector<Element> elements;
  std::vector<int> element_nodes;  ///< places in `nodes`
  std::vector<PhysicalName> physical_names;
};

/// A shape of elements.
struct MshShape {
  int type;          ///< gmsh's number
  const char* name;  ///< gmsh's name, with the number of nodes
  int dimension, nodes;
};

/// @return nullptr when there is no such type
const MshShape* msh_shape(int type);

/// Reads gmsh's formats 2.2 and 4.1 (gmsh's reference manual, "MSH file format"), ASCII and binary.
/// The file is not given to gmsh, which would run a file without the format's first line as a
/// script, system commands included. Sections that do not belong to the mesh are skipped.
///
/// In format 2.2 an element's group is its first tag. If elements of one entity have different
/// groups, the entity is split here, one per group. In format 4.1 groups belong to entities.
///
/// Safe for any bytes: memory stays below about twenty times the size of the file.
/// @param path  for the messages
/// @throws InputError (where = path, with the line or the byte) for other formats, numbers that are
/// not finite, indices that do not exist, a node's number given twice, counts larger than the rest
/// of the file, a partitioned mesh, or a file beyond the limits above.
MshFile parse_msh(std::string_view bytes, const std::string& path);

/// @throws InputError also for a file that cannot be read
MshFile read_msh(const std::string& path);

}  // namespace softfinger::meshes
