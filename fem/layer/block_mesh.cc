#include "fem/layer/block_mesh.h"

#include <deal.II/grid/grid_tools.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "fem/layer/patch_boxes.h"

namespace softfinger::fem {

Lattice plan_lattice(const LayerDiscretisation& discretisation, double coarsest) {
  const double fine_x = discretisation.a / discretisation.elements_along_a();
  const double fine_y = discretisation.b / discretisation.elements_along_b();
  Lattice lattice;
  // The coarsest cells are at most as long as the layer is thick; up to 2^0.1 = 1.07 times as long
  // where that saves a refinement.
  constexpr double tolerated = 0.1;
  // Thin sublayers bend over lengths of their own.
  constexpr double longest_in_sublayer = 1.5;
  double thinnest = 1, above = 0;
  for (const double interface : discretisation.interfaces) {
    thinnest = std::min({thinnest, interface - above, 1 - interface});
    above = interface;
  }
  coarsest = std::min(coarsest, longest_in_sublayer * thinnest);
  lattice.refinements =
      std::max(0, static_cast<int>(std::floor(std::log2(coarsest / fine_x) + tolerated)));
  const double coarsening = std::ldexp(1.0, lattice.refinements);
  auto& block = lattice.block;
  block.sublayers.clear();
  double top = 0;
  for (std::size_t i = 0; i <= discretisation.interfaces.size(); ++i) {
    const double bottom = i < discretisation.interfaces.size() ? discretisation.interfaces[i] : 1;
    // The finest cells are about as deep as wide: rounded up from 0.6 on.
    constexpr double rounding = 0.4;
    const double cells = (bottom - top) / (coarsening * fine_y);
    block.sublayers.push_back({bottom - top, std::max(1, static_cast<int>(cells + rounding))});
    top = bottom;
  }
  block.cell_x = coarsening * fine_x;
  block.cell_y = coarsening * fine_y;
  block.inner_x = discretisation.patch * discretisation.a;
  block.inner_y = discretisation.patch * discretisation.b;
  block.length_x =
      std::max(discretisation.a + discretisation.extent, block.inner_x + 2 * block.cell_x);
  block.length_y =
      std::max(discretisation.b + discretisation.extent, block.inner_y + 2 * block.cell_y);
  // A curved layer ends at its reach; near it even the coarsest cells are small enough to fit.
  const auto fit = [](double inner, double reach, double& cell, double& length) {
    length = std::min(length, reach);
    const double usable = LayerDiscretisation::usable_reach * length;
    if (std::ceil(inner / cell - 1e-9) * cell < usable) return;
    const double cells = std::ceil(inner / (usable - inner));
    cell = inner / cells;
  };
  fit(block.inner_x, discretisation.reach_x, block.cell_x, block.length_x);
  fit(block.inner_y, discretisation.reach_y, block.cell_y, block.length_y);
  // Each cell is so much longer than the one before it, towards the side wall. Its effect on d is
  // part of the stated 0.01 %.
  block.growth = 1.5;
  // Cells that a scan covers in part are lost: smaller ones lose less.
  constexpr double growth_on_scan = 1.1;
  if (discretisation.is_scan) block.growth = growth_on_scan;
  return lattice;
}

void make_triangulation(const meshes::HexahedralMesh& mesh,
                        dealii::Triangulation<dim>& triangulation) {
  std::vector<dealii::Point<dim>> vertices;
  vertices.reserve(mesh.vertices.size());
  for (const auto& vertex : mesh.vertices)
    vertices.emplace_back(vertex.x(), vertex.y(), vertex.z());
  std::vector<dealii::CellData<dim>> cells(mesh.cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (std::size_t v = 0; v < 8; ++v)
      cells[i].vertices[v] = static_cast<unsigned int>(mesh.cells[i][corners_layer_by_layer[v]]);
    cells[i].material_id = static_cast<dealii::types::material_id>(mesh.region[i]);
  }
  dealii::SubCellData none;
  std::vector<unsigned int> all;  // the vertices that mirror images share
  dealii::GridTools::delete_duplicated_vertices(vertices, cells, none, all, 1e-9);
  dealii::GridTools::delete_unused_vertices(vertices, cells, none);
  dealii::GridTools::invert_all_negative_measure_cells(vertices, cells);
  dealii::GridTools::consistently_order_cells(cells);
  triangulation.create_triangulation(vertices, cells, none);
}

meshes::HexahedralMesh with_images(const meshes::HexahedralMesh& quarter, MirrorPlanes planes) {
  meshes::HexahedralMesh mesh;
  for (const double sign_x : {1.0, -1.0})
    for (const double sign_y : {1.0, -1.0}) {
      if ((sign_x < 0 && planes.x) || (sign_y < 0 && planes.y)) continue;
      std::vector<int> index;
      for (const Eigen::Vector3d& vertex : quarter.vertices) {
        index.push_back(static_cast<int>(mesh.vertices.size()));
        mesh.vertices.emplace_back(sign_x * vertex.x(), sign_y * vertex.y(), vertex.z());
      }
      for (auto cell : quarter.cells) {
        for (int& vertex : cell) vertex = index[static_cast<std::size_t>(vertex)];
        // A mirror image lists its faces clockwise.
        if (sign_x * sign_y < 0)
          for (const std::size_t face : {0, 4}) std::swap(cell[face + 1], cell[face + 3]);
        mesh.cells.push_back(cell);
      }
      mesh.region.insert(mesh.region.end(), quarter.region.begin(), quarter.region.end());
    }
  return mesh;
}

void keep_cells_around_contact(meshes::HexahedralMesh& mesh) {
  std::vector<std::vector<std::size_t>> around(mesh.vertices.size());
  std::map<std::array<long, 3>, int> places;  // mirror images share vertices by place
  const auto place = [&](int vertex) {
    const Eigen::Vector3d& at = mesh.vertices[static_cast<std::size_t>(vertex)];
    constexpr double fine = 1e6;
    return static_cast<std::size_t>(
        places
            .emplace(std::array<long, 3>{std::lround(fine * at.x()), std::lround(fine * at.y()),
                                         std::lround(fine * at.z())},
                     vertex)
            .first->second);
  };
  std::vector<std::size_t> front;
  for (std::size_t i = 0; i < mesh.cells.size(); ++i)
    for (const int vertex : mesh.cells[i]) {
      around[place(vertex)].push_back(i);
      const Eigen::Vector3d& at = mesh.vertices[static_cast<std::size_t>(vertex)];
      if (at.head<2>().norm() < 1e-9) front.push_back(i);
    }
  std::vector<char> kept(mesh.cells.size(), 0);
  while (!front.empty()) {
    const std::size_t i = front.back();
    front.pop_back();
    if (kept[i]) continue;
    kept[i] = 1;
    for (const int vertex : mesh.cells[i])
      for (const std::size_t next : around[place(vertex)])
        if (!kept[next]) front.push_back(next);
  }
  meshes::HexahedralMesh connected;
  for (std::size_t i = 0; i < kept.size(); ++i)
    if (kept[i]) {
      connected.cells.push_back(mesh.cells[i]);
      connected.region.push_back(mesh.region[i]);
    }
  mesh.cells = std::move(connected.cells);
  mesh.region = std::move(connected.region);
}

void refine_towards_patch(const LayerDiscretisation& discretisation, int refinements,
                          dealii::Triangulation<dim>& triangulation) {
  const double patch_x = discretisation.patch * discretisation.a;
  const double patch_y = discretisation.patch * discretisation.b;
  for (int step = 0; step < refinements; ++step) {
    for (const auto& cell : triangulation.active_cell_iterators()) {
      const auto box = cell->bounding_box();
      const auto &low = box.get_boundary_points().first, &high = box.get_boundary_points().second;
      // A cell is halved while it is nearer to the patch than a share of its longest side: measured
      // along its own sides, flat cells would leave the stress under the patch to coarse ones.
      const auto size = high - low;
      const double reach =
          fine_surroundings(discretisation) * std::max({size[0], size[1], size[2]});
      const auto distance = [&](unsigned int c) { return std::max({0.0, low[c], -high[c]}); };
      const double x = std::max(0.0, distance(0) - reach) / patch_x;
      const double y = std::max(0.0, distance(1) - reach) / patch_y;
      const bool near = x * x + y * y < 1 && -high[2] <= reach * (1 + 1e-9);
      if (near) cell->set_refine_flag();
    }
    triangulation.execute_coarsening_and_refinement();
  }
}

}  // namespace softfinger::fem
