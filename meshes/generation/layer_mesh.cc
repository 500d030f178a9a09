#include "meshes/generation/layer_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "meshes/io/read_msh.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

constexpr int quadrilateral = 3, hexahedron = 5;  // gmsh's element types

/// Elements of a physical group: their numbers in the file, and their nodes one after the other.
struct Group {
  std::vector<std::size_t> elements;
  std::vector<int> nodes;
};

std::string dimension_text(int dimension) {
  const char* const texts[] = {"point", "curve", "surface", "volume"};
  return texts[dimension];
}

class Reader {
 public:
  Reader(const MshFile& file, const std::string& path, const std::vector<std::string>& regions)
      : file_(file), path_(path) {
    for (const std::string& region : regions) allowed_groups_ += "volume \"" + region + "\", ";
    allowed_groups_ += "surfaces \"contact\" and \"core\"";
  }

  /// @param type  the only one allowed
  Group group(int dimension, const std::string& name, int type, const char* allowed) const {
    constexpr std::size_t kNamed = 10;
    std::string there;
    for (std::size_t i = 0; i < file_.physical_names.size(); ++i) {
      const MshFile::PhysicalName& found = file_.physical_names[i];
      if (found.dimension == dimension && found.name == name)
        return read(dimension, found.tag, name, type, allowed);
      if (i < kNamed)
        there += (i == 0 ? "" : ", ") + dimension_text(found.dimension) + " \"" + found.name + "\"";
      if (i == kNamed) there += ", ...";
    }
    throw InputError(path_, "physical " + dimension_text(dimension), "\"" + name + "\" is missing",
                     allowed_groups_ + "; the file has " + (there.empty() ? "none" : there));
  }

 private:
  Group read(int dimension, int tag, const std::string& name, int type, const char* allowed) const {
    std::vector<bool> belongs;
    for (const MshFile::Entity& entity : file_.entities) {
      const auto& tags = entity.physical_tags;
      belongs.push_back(entity.dimension == dimension &&
                        std::find(tags.begin(), tags.end(), tag) != tags.end());
    }
    Group group;
    for (const MshFile::Element& element : file_.elements) {
      if (!belongs[static_cast<std::size_t>(element.entity)]) continue;
      const MshShape& shape = *msh_shape(element.type);
      if (element.type != type)
        throw InputError(path_, "element " + std::to_string(element.tag) + " of \"" + name + "\"",
                         shape.name, allowed);
      group.elements.push_back(element.tag);
      const int* const nodes = &file_.element_nodes[element.first_node];
      group.nodes.insert(group.nodes.end(), nodes, nodes + shape.nodes);
    }
    if (group.elements.empty())
      throw InputError(path_, "physical " + dimension_text(dimension), "\"" + name + "\" is empty",
                       std::string("one with elements: ") + allowed);
    return group;
  }

  const MshFile& file_;
  std::string path_, allowed_groups_;
};

/// Smallest Jacobian determinant at the corners of a trilinear cell. If all are positive, the cell
/// counts as not inverted. The three edges of each corner are right-handed in gmsh's ordering.
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

/// Returns the height z at which the z axis meets a triangle; none where it misses.
std::optional<double> height_on_axis(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                     const Eigen::Vector3d& c) {
  const auto twice_area = [](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    return from.x() * to.y() - from.y() * to.x();
  };
  const Eigen::Vector3d parts(twice_area(b, c), twice_area(c, a), twice_area(a, b));
  const double whole = parts.sum();
  constexpr double rounding = 1e-9;  // the axis may run along an edge
  if (whole == 0 || (parts / whole).minCoeff() < -rounding) return std::nullopt;
  return (parts.x() * a.z() + parts.y() * b.z() + parts.z() * c.z()) / whole;
}

/// Returns the largest height at which the z axis meets the faces; none where it misses all.
std::optional<double> highest_on_axis(const HexahedralMesh& mesh,
                                      const std::vector<std::array<int, 4>>& faces) {
  std::optional<double> highest;
  for (const std::array<int, 4>& face : faces) {
    const auto at = [&](std::size_t corner) -> const Eigen::Vector3d& {
      return mesh.vertices[static_cast<std::size_t>(face[corner])];
    };
    for (const auto& height :
         {height_on_axis(at(0), at(1), at(2)), height_on_axis(at(0), at(2), at(3))})
      if (height && !(highest > height)) highest = height;
  }
  return highest;
}

std::optional<double> thickness_under_contact(const LayerMesh& layer) {
  const auto top = highest_on_axis(layer.hexahedra, layer.contact),
             bottom = highest_on_axis(layer.hexahedra, layer.core);
  if (!top || !bottom || !(*top > *bottom)) return std::nullopt;
  return *top - *bottom;
}

}  // namespace

LayerMesh read_layer_mesh(const std::string& path, double metres_per_unit,
                          const std::vector<std::string>& regions) {
  const MshFile file = read_msh(path);
  const Reader reader(file, path, regions);
  std::vector<Group> volumes;
  for (const std::string& region : regions)
    volumes.push_back(reader.group(3, region, hexahedron,
                                   "8-node hexahedra only (gmsh: recombined, first order)"));
  const char* const quadrilaterals = "4-node quadrilaterals only, faces of the layer";
  const Group surfaces[] = {reader.group(2, "contact", quadrilateral, quadrilaterals),
                            reader.group(2, "core", quadrilateral, quadrilaterals)};

  LayerMesh result;
  HexahedralMesh& mesh = result.hexahedra;
  std::vector<int> vertex(file.nodes.size(), -1);  // -1: not of the layer
  for (std::size_t r = 0; r < regions.size(); ++r)
    for (std::size_t i = 0; i < volumes[r].elements.size(); ++i) {
      const Group& layer = volumes[r];
      std::array<int, 8> cell{};
      for (std::size_t corner = 0; corner < 8; ++corner) {
        const auto node = static_cast<std::size_t>(layer.nodes[8 * i + corner]);
        if (vertex[node] < 0) {
          vertex[node] = static_cast<int>(mesh.vertices.size());
          mesh.vertices.push_back(metres_per_unit * file.nodes[node]);
        }
        cell[corner] = vertex[node];
      }
      const double corner = smallest_corner(mesh, cell);
      if (!(corner > 0 && std::isfinite(corner))) {
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

  std::map<std::array<int, 4>, int> cells_at;  // a face with one cell only is an outer face
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
        face[corner] = vertex[static_cast<std::size_t>(group.nodes[4 * i + corner])];
        outer = outer && face[corner] >= 0;
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
  result.thickness_m = thickness_under_contact(result);
  return result;
}

}  // namespace softfinger::meshes
