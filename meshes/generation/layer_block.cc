#include "meshes/generation/layer_block.h"

#include <gmsh.h>

#include <cmath>
#include <numeric>
#include <string>
#include <unordered_map>

#include "meshes/generation/gmsh_session.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

/// One side of the block: `uniform` cells of the given size, then `graded` cells that grow by
/// `ratio`.
struct Division {
  double inner;  ///< where the graded part begins
  int uniform, graded;
  double ratio;
};

Division divide(double inner, double length, double cell, double growth) {
  Division division{};
  division.uniform = std::max(1, static_cast<int>(std::ceil(inner / cell - 1e-9)));
  division.inner = division.uniform * cell;
  if (!(division.inner < length))
    throw InputError("layer block", "length", length,
                     "> the refined part, " + std::to_string(division.inner));
  // Cells cell*r, cell*r², ... fill what is left: take the count that growth asks for, then the
  // ratio that fits it exactly, so that the first graded cell matches its uniform neighbour.
  const double rest = (length - division.inner) / cell;
  const auto sum = [](double ratio, int count) {
    double total = 0, term = 1;
    for (int i = 0; i < count; ++i) total += (term *= ratio);
    return total;
  };
  division.graded = 1;
  while (sum(growth, division.graded) < rest) ++division.graded;
  double low = 1e-3, high = 1e3;
  while (high / low > 1 + 1e-13) {
    const double middle = std::sqrt(low * high);
    (sum(middle, division.graded) < rest ? low : high) = middle;
  }
  division.ratio = low;
  return division;
}

}  // namespace

HexahedralMesh mesh_layer_block(const LayerBlock& block) {
  std::vector<double> lengths = {block.inner_x, block.inner_y, block.length_x,  block.length_y,
                                 block.cell_x,  block.cell_y,  block.growth - 1};
  for (const BlockSublayer& sublayer : block.sublayers) lengths.push_back(sublayer.thickness);
  for (const double length : lengths)
    if (!(length > 0)) throw InputError("layer block", "length", length, "> 0 (and growth > 1)");
  const Division x = divide(block.inner_x, block.length_x, block.cell_x, block.growth);
  const Division y = divide(block.inner_y, block.length_y, block.cell_y, block.growth);
  // gmsh's extrusion goes up from the core.
  double thickness = 0;
  for (const BlockSublayer& sublayer : block.sublayers) thickness += sublayer.thickness;
  std::vector<int> cells;
  std::vector<double> up_to;  // share of the thickness
  double below = 0;
  for (auto sublayer = block.sublayers.rbegin(); sublayer != block.sublayers.rend(); ++sublayer) {
    cells.push_back(sublayer->cells);
    up_to.push_back((below += sublayer->thickness) / thickness);
  }
  up_to.back() = 1;

  const GmshSession session("layer");
  namespace geo = gmsh::model::geo;
  namespace mesh = gmsh::model::geo::mesh;
  const double xs[] = {0, x.inner, block.length_x}, ys[] = {0, y.inner, block.length_y};
  int point[3][3], along_x[3][2], along_y[2][3];
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) point[j][i] = geo::addPoint(xs[i], ys[j], -thickness);
  const auto line = [](int from, int to, const Division& division, bool graded) {
    const int tag = geo::addLine(from, to);
    mesh::setTransfiniteCurve(tag, (graded ? division.graded : division.uniform) + 1, "Progression",
                              graded ? division.ratio : 1.0);
    return tag;
  };
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 2; ++i) along_x[j][i] = line(point[j][i], point[j][i + 1], x, i == 1);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 3; ++i) along_y[j][i] = line(point[j][i], point[j + 1][i], y, j == 1);
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int loop =
          geo::addCurveLoop({along_x[j][i], along_y[j][i + 1], -along_x[j + 1][i], -along_y[j][i]});
      const int surface = geo::addPlaneSurface({loop});
      mesh::setTransfiniteSurface(surface);
      mesh::setRecombine(2, surface);
      gmsh::vectorpair extruded;
      geo::extrude({{2, surface}}, 0, 0, thickness, extruded, cells, up_to, /*recombine=*/true);
    }
  geo::synchronize();
  gmsh::model::mesh::generate(3);
  // The four blocks share their walls; extrusion made them twice.
  gmsh::model::mesh::removeDuplicateNodes();

  HexahedralMesh result;
  std::vector<std::size_t> tags, element_tags, element_nodes;
  std::vector<double> coordinates, parametric;
  gmsh::model::mesh::getNodes(tags, coordinates, parametric);
  std::unordered_map<std::size_t, int> index;
  index.reserve(tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i) {
    index[tags[i]] = static_cast<int>(i);
    result.vertices.emplace_back(coordinates[3 * i], coordinates[3 * i + 1],
                                 coordinates[3 * i + 2]);
  }
  constexpr int eight_node_hexahedron = 5;
  gmsh::model::mesh::getElementsByType(eight_node_hexahedron, element_tags, element_nodes);
  result.cells.resize(element_tags.size());
  for (std::size_t i = 0; i < element_nodes.size(); ++i)
    result.cells[i / 8][i % 8] = index.at(element_nodes[i]);
  for (const auto& cell : result.cells) {
    double depth = 0;
    for (const int vertex : cell)
      depth -= result.vertices[static_cast<std::size_t>(vertex)].z() / 8;
    int region = 0;
    for (double bottom = block.sublayers[0].thickness; depth > bottom;)
      bottom += block.sublayers[static_cast<std::size_t>(++region)].thickness;
    result.region.push_back(region);
  }
  const std::size_t expected =
      static_cast<std::size_t>(x.uniform + x.graded) *
      static_cast<std::size_t>(y.uniform + y.graded) *
      static_cast<std::size_t>(std::accumulate(cells.begin(), cells.end(), 0));
  if (result.cells.size() != expected)
    throw InputError("layer block", "hexahedra", std::to_string(result.cells.size()),
                     std::to_string(expected) + " (gmsh left other elements)");
  return result;
}

}  // namespace softfinger::meshes
