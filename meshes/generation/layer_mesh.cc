#include "meshes/generation/layer_mesh.h"

#include <gmsh.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <limits>
#include <map>
#include <unordered_map>

#include "meshes/generation/gmsh_session.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

constexpr int quadrilateral = 3, hexahedron = 5;  // gmsh's element types

/// Elements of a physical group: their numbers in the file, and their nodes one after the other.
struct Group {
  std::vector<std::size_t> elements, nodes;
};

std::string dimension_text(int dimension) { return dimension == 3 ? "volume" : "surface"; }

class Reader {
 public:
  Reader(const std::string& path, const std::vector<std::string>& regions) : path_(path) {
    for (const std::string& region : regions) allowed_groups_ += "volume \"" + region + "\", ";
    allowed_groups_ += "surfaces \"contact\" and \"core\"";
  }

  /// @param type  the only one allowed
  Group group(int dimension, const std::string& name, int type, const char* allowed) const {
    gmsh::vectorpair groups;
    gmsh::model::getPhysicalGroups(groups);
    std::string there;
    for (const auto& [found_dimension, tag] : groups) {
      std::string found;
      gmsh::model::getPhysicalName(found_dimension, tag, found);
      if (found_dimension == dimension && found == name)
        return read(dimension, tag, name, type, allowed);
      there += (there.empty() ? "" : ", ") + dimension_text(found_dimension) + " \"" + found + "\"";
    }
    throw InputError(path_, "physical " + dimension_text(dimension), "\"" + name + "\" is missing",
                     allowed_groups_ + "; the file has " + (there.empty() ? "none" : there));
  }

 private:
  Group read(int dimension, int tag, const std::string& name, int type, const char* allowed) const {
    Group group;
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(dimension, tag, entities);
    for (const int entity : entities) {
      std::vector<int> types;
      std::vector<std::vector<std::size_t>> elements, nodes;
      gmsh::model::mesh::getElements(types, elements, nodes, dimension, entity);
      for (std::size_t i = 0; i < types.size(); ++i) {
        if (types[i] != type) {
          std::string kind;
          int unused = 0;
          std::vector<double> unused_places;
          gmsh::model::mesh::getElementProperties(types[i], kind, unused, unused, unused,
                                                  unused_places, unused);
          throw InputError(
              path_, "element " + std::to_string(elements[i].front()) + " of \"" + name + "\"",
              kind, allowed);
        }
        group.elements.insert(group.elements.end(), elements[i].begin(), elements[i].end());
        group.nodes.insert(group.nodes.end(), nodes[i].begin(), nodes[i].end());
      }
    }
    if (group.elements.empty())
      throw InputError(path_, "physical " + dimension_text(dimension), "\"" + name + "\" is empty",
                       std::string("one with elements: ") + allowed);
    return group;
  }

  std::string path_, allowed_groups_;
};

/// Smallest Jacobian determinant at a corner: a trilinear cell that has none below zero there is
/// not inverted. In gmsh's ordering the three edges listed go right-handed.
double smallest_corner(const HexahedralMesh& mesh, const std::array<int, 8>& cell) {
  constexpr int edges[8][3] = {{1, 3, 4}, {2, 0, 5}, {3, 1, 6}, {0, 2, 7},
                               {7, 5, 0}, {4, 6, 1}, {5, 7, 2}, {6, 4, 3}};
  const auto at = [&](int corner) {
    return mesh.vertices[static_cast<std::size_t>(cell[static_cast<std::size_t>(corner)])];
  };
  double smallest = std::numeric_limits<double>::infinity();
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d x = at(edges[corner][0]) - at(corner),
                          y = at(edges[corner][1]) - at(corner),
                          z = at(edges[corner][2]) - at(corner);
    smallest = std::min(smallest, x.cross(y).dot(z));
  }
  return smallest;
}

template <std::size_t count>
std::array<int, count> sorted(std::array<int, count> vertices) {
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

}  // namespace

LayerMesh read_layer_mesh(const std::string& path, double metres_per_unit,
                          const std::vector<std::string>& regions) {
  if (!std::ifstream(path))
    throw InputError(path, "mesh of the layer", "", "a gmsh file (.msh) that can be read");
  const GmshSession session("layer mesh");
  try {
    gmsh::merge(path);
  } catch (...) {  // of whatever type this version of gmsh throws
    throw InputError(path, "mesh of the layer", "", "a gmsh file (.msh)");
  }
  const Reader reader(path, regions);
  std::vector<Group> volumes;
  for (const std::string& region : regions)
    volumes.push_back(reader.group(3, region, hexahedron,
                                   "8-node hexahedra only (gmsh: recombined, first order)"));
  const char* const quadrilaterals = "4-node quadrilaterals only, faces of the layer";
  const Group surfaces[] = {reader.group(2, "contact", quadrilateral, quadrilaterals),
                            reader.group(2, "core", quadrilateral, quadrilaterals)};

  std::vector<std::size_t> tags;
  std::vector<double> coordinates, unused;
  gmsh::model::mesh::getNodes(tags, coordinates, unused);
  std::unordered_map<std::size_t, std::size_t> place;
  for (std::size_t i = 0; i < tags.size(); ++i) place[tags[i]] = i;
  LayerMesh result;
  HexahedralMesh& mesh = result.hexahedra;
  std::unordered_map<std::size_t, int> vertex;  // those of the layer only
  for (std::size_t r = 0; r < regions.size(); ++r)
    for (std::size_t i = 0; i < volumes[r].elements.size(); ++i) {
      const Group& layer = volumes[r];
      std::array<int, 8> cell{};
      for (std::size_t corner = 0; corner < 8; ++corner) {
        const std::size_t tag = layer.nodes[8 * i + corner];
        const auto [entry, is_new] = vertex.emplace(tag, static_cast<int>(mesh.vertices.size()));
        if (is_new) {
          const double* at = &coordinates[3 * place.at(tag)];
          mesh.vertices.push_back(metres_per_unit * Eigen::Vector3d(at[0], at[1], at[2]));
        }
        cell[corner] = entry->second;
      }
      const double corner = smallest_corner(mesh, cell);
      if (!(corner > 0)) {
        Eigen::Vector3d centre = Eigen::Vector3d::Zero();
        for (const int v : cell) centre += mesh.vertices[static_cast<std::size_t>(v)] / 8;
        char text[160];
        std::snprintf(text, sizeof text,
                      "determinant %.3g mm³ at a corner, near (%.4g, %.4g, %.4g) mm", 1e9 * corner,
                      1e3 * centre.x(), 1e3 * centre.y(), 1e3 * centre.z());
        throw InputError(path,
                         "element " + std::to_string(layer.elements[i]) + " of \"" + regions[r] +
                             "\" is inverted",
                         text, "> 0 at every corner");
      }
      mesh.cells.push_back(cell);
      mesh.region.push_back(static_cast<int>(r));
    }

  std::map<std::array<int, 4>, int> cells_at;  // a face of one cell is an outer one
  constexpr int faces[6][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4},
                               {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  for (const auto& cell : mesh.cells)
    for (const auto& face : faces) {
      std::array<int, 4> vertices{};
      for (std::size_t i = 0; i < 4; ++i) vertices[i] = cell[static_cast<std::size_t>(face[i])];
      ++cells_at[sorted(vertices)];
    }
  for (const int surface : {0, 1}) {
    const Group& group = surfaces[surface];
    auto& chosen = surface == 0 ? result.contact : result.core;
    for (std::size_t i = 0; i < group.elements.size(); ++i) {
      std::array<int, 4> face{};
      bool outer = true;
      for (std::size_t corner = 0; corner < 4; ++corner) {
        const auto found = vertex.find(group.nodes[4 * i + corner]);
        outer = outer && found != vertex.end();
        face[corner] = outer ? found->second : -1;
      }
      const auto found = outer ? cells_at.find(sorted(face)) : cells_at.end();
      if (found == cells_at.end() || found->second != 1)
        throw InputError(path,
                         "element " + std::to_string(group.elements[i]) + " of \"" +
                             (surface == 0 ? "contact" : "core") + "\"",
                         "", "an outer face of a hexahedron of the layer");
      chosen.push_back(face);
    }
  }
  return result;
}

}  // namespace softfinger::meshes
