// Files that gmsh writes, in each of its formats, are read back by our own reader.

#include <gmsh.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <limits>
#include <map>
#include <set>

#include "meshes/generation/gmsh_session.h"
#include "meshes/generation/layer_mesh.h"
#include "meshes/io/read_msh.h"

namespace softfinger::meshes {
namespace {

/// Group, type, nodes.
using Elements = std::multiset<std::tuple<std::string, int, std::vector<std::size_t>>>;

/// Two volumes of hexahedra, over them one of tetrahedra.
void build() {
  namespace geo = gmsh::model::geo;
  const int point = geo::addPoint(0, 0, -1.3);
  gmsh::vectorpair made;
  const auto extrude = [&](std::pair<int, int> what, double x, double y, double z, int cells) {
    made.clear();
    geo::extrude({what}, x, y, z, made, cells > 0 ? std::vector<int>{cells} : std::vector<int>{},
                 {}, cells > 0);
    return made;
  };
  const auto line = extrude({0, point}, 0.9, 0, 0, 3)[1];
  const auto core = extrude(line, 0, 0.7, 0, 2)[1];
  const auto lower = extrude(core, 0, 0, 0.5, 2);
  const auto upper = extrude(lower[0], 0, 0, 0.8, 1);
  const auto above = extrude(upper[0], 0, 0, 0.4, 0);
  geo::synchronize();
  const auto group = [](int dimension, const std::vector<int>& entities, const char* name) {
    const int tag = gmsh::model::addPhysicalGroup(dimension, entities);
    gmsh::model::setPhysicalName(dimension, tag, name);
  };
  group(3, {lower[1].second}, "pulp");
  group(3, {upper[1].second}, "skin");
  group(2, {core.second}, "core");
  group(2, {upper[0].second}, "contact");
  group(3, {above[1].second}, "flesh");
  gmsh::model::mesh::generate(3);
}

/// Elements of the mesh that gmsh holds.
Elements elements_in_gmsh() {
  Elements result;
  gmsh::vectorpair groups;
  gmsh::model::getPhysicalGroups(groups);
  for (const auto& [dimension, tag] : groups) {
    std::string name;
    gmsh::model::getPhysicalName(dimension, tag, name);
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(dimension, tag, entities);
    for (const int entity : entities) {
      std::vector<int> types;
      std::vector<std::vector<std::size_t>> tags, nodes;
      gmsh::model::mesh::getElements(types, tags, nodes, dimension, entity);
      for (std::size_t t = 0; t < types.size(); ++t) {
        const std::size_t each = nodes[t].size() / tags[t].size();
        for (auto node = nodes[t].begin(); node != nodes[t].end();
             node += static_cast<std::ptrdiff_t>(each))
          result.insert({name, types[t], {node, node + static_cast<std::ptrdiff_t>(each)}});
      }
    }
  }
  return result;
}

Elements elements_of(const MshFile& file) {
  Elements result;
  for (const auto& element : file.elements) {
    const auto& entity = file.entities[static_cast<std::size_t>(element.entity)];
    std::vector<std::size_t> nodes;
    for (int i = 0; i < msh_shape(element.type)->nodes; ++i)
      nodes.push_back(file.node_tags[static_cast<std::size_t>(
          file.element_nodes[element.first_node + static_cast<std::size_t>(i)])]);
    for (const auto& group : file.physical_names)
      for (const int tag : entity.physical_tags)
        if (group.dimension == entity.dimension && group.tag == tag)
          result.insert({group.name, element.type, nodes});
  }
  return result;
}

TEST(WrittenByGmsh, ElementsHaveTheShapesThatWeKnow) {
  const GmshSession session("shapes");
  int known = 0;
  for (int type = 1; type < 140; ++type) {
    const MshShape* const shape = msh_shape(type);
    if (!shape) continue;
    ++known;
    std::string name;
    int dimension = 0, order = 0, nodes = 0, primary_nodes = 0;
    std::vector<double> places;
    gmsh::model::mesh::getElementProperties(type, name, dimension, order, nodes, places,
                                            primary_nodes);
    EXPECT_EQ(shape->dimension, dimension) << type;
    EXPECT_EQ(shape->nodes, nodes) << type;
    const std::string kind = std::string(shape->name).substr(0, 4);
    EXPECT_EQ(name.substr(0, 4), kind) << type;
  }
  EXPECT_EQ(known, 35);
}

TEST(WrittenByGmsh, IsReadAlikeInEveryFormat) {
  const GmshSession session("formats");
  build();
  const Elements expected = elements_in_gmsh();
  std::map<int, int> of_type;
  for (const auto& element : expected) ++of_type[std::get<1>(element)];
  EXPECT_EQ(of_type[3], 2 * 3 * 2) << "quadrilaterals of core and contact";
  EXPECT_EQ(of_type[5], 3 * 3 * 2) << "hexahedra of three layers";
  EXPECT_GT(of_type[4], 0) << "tetrahedra";
  std::vector<std::size_t> tags;
  std::vector<double> coordinates, unused;
  gmsh::model::mesh::getNodes(tags, coordinates, unused);
  std::map<std::size_t, Eigen::Vector3d> places;
  for (std::size_t i = 0; i < tags.size(); ++i)
    places[tags[i]] = {coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]};

  std::vector<LayerMesh> layers;
  for (const double version : {2.2, 4.1})
    for (const bool binary : {false, true})
      for (const bool all : {false, true}) {
        const std::string path = std::filesystem::temp_directory_path() /
                                 ("softfinger_formats_" + std::to_string(getpid()) + ".msh");
        gmsh::option::setNumber("Mesh.MshFileVersion", version);
        gmsh::option::setNumber("Mesh.Binary", binary);
        gmsh::option::setNumber("Mesh.SaveAll", all && version > 4);  // 2.2 would drop all groups
        gmsh::option::setNumber("Mesh.SaveParametric", all && version > 4);
        gmsh::write(path);
        SCOPED_TRACE(std::to_string(version) + (binary ? " binary" : " text") +
                     (all ? " all" : ""));
        const MshFile file = read_msh(path);
        EXPECT_EQ(elements_of(file), expected);
        for (std::size_t i = 0; i < file.nodes.size(); ++i)  // written with 16 digits
          EXPECT_LE((file.nodes[i] - places.at(file.node_tags[i])).norm(),
                    8 * std::numeric_limits<double>::epsilon());
        layers.push_back(read_layer_mesh(path, 1e-3, {"skin", "pulp"}));
        std::filesystem::remove(path);
      }
  for (const LayerMesh& layer : layers) {
    EXPECT_EQ(layer.hexahedra.cells, layers[0].hexahedra.cells);
    EXPECT_EQ(layer.hexahedra.region, layers[0].hexahedra.region);
    EXPECT_EQ(layer.contact, layers[0].contact);
    EXPECT_EQ(layer.core, layers[0].core);
    ASSERT_EQ(layer.hexahedra.vertices.size(), layers[0].hexahedra.vertices.size());
    for (std::size_t v = 0; v < layer.hexahedra.vertices.size(); ++v)
      EXPECT_LE((layer.hexahedra.vertices[v] - layers[0].hexahedra.vertices[v]).norm(),
                8e-3 * std::numeric_limits<double>::epsilon());
  }
  EXPECT_EQ(layers[0].hexahedra.cells.size(), 3u * 2 * 3);
  EXPECT_EQ(layers[0].contact.size(), 3u * 2);
}

}  // namespace
}  // namespace softfinger::meshes
