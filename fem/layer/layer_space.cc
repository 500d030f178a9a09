#include "fem/layer/layer_space.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q1.h>
#include <deal.II/fe/mapping_q_eulerian.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "fem/base/threads.h"
#include "fem/layer/block_mesh.h"
#include "fem/layer/contact_surface.h"
#include "fem/layer/edge_shape.h"
#include "fem/layer/outside_mesh.h"
#include "fem/layer/patch_boxes.h"
#include "fem/layer/placed_mesh.h"
#include "meshes/generation/layer_mesh.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
using dealii::types::global_dof_index;

LayerSpace::LayerSpace(const LayerDiscretisation& meant,
                       const std::shared_ptr<const LayerShape>& bent, MirrorPlanes mirrored)
    : discretisation(meant), element(dealii::FE_Q<dim>(2), dim), shape(bent), planes(mirrored) {
  std::vector<dealii::Point<dim>> support;
  // If cells under the contact fold, or do not fit between the contact and an edge, cells of half
  // the length may still do.
  constexpr double usual = 1, half = 0.5;
  Left left = mesh_block(usual, bent, support);
  if (left == Left::part && mesh_block(half, bent, support) == Left::nothing)
    left = mesh_block(usual, bent, support);
  if (left == Left::nothing) {
    folded = FoldedLayer{InputError("finger", "layer at the contact", "none",
                                    "less load, a thinner layer, or a point farther from edges and "
                                    "thin walls")};
    return;
  }
  constrain(support);
  collect_surface(support);
  number_surface();
}

namespace {

/// The lines between the columns of a block's cells, ascending.
std::vector<double> lines_of(const meshes::HexahedralMesh& block, int component) {
  std::vector<double> lines;
  for (const Eigen::Vector3d& vertex : block.vertices) lines.push_back(vertex[component]);
  std::sort(lines.begin(), lines.end());
  lines.erase(std::unique(lines.begin(), lines.end(), at), lines.end());
  return lines;
}

}  // namespace

/// @param coarsest  longest cells, in thicknesses
/// @param support   place of each dof in the block
LayerSpace::Left LayerSpace::mesh_block(double coarsest,
                                        const std::shared_ptr<const LayerShape>& bent,
                                        std::vector<dealii::Point<dim>>& support) {
  const Lattice lattice = plan_lattice(discretisation, coarsest);
  meshes::HexahedralMesh block = [&] {
    const auto lock = lock_global_state();
    return with_images(meshes::mesh_layer_block(lattice.block), planes);
  }();
  Left left = Left::all;
  if (discretisation.is_scan) {
    // Cells that lie partly within the side wall belong to the layer too.
    bent->cover(std::max(discretisation.a, discretisation.b) + discretisation.extent +
                std::hypot(lattice.block.cell_x, lattice.block.cell_y));
    if (bent->has_edges())
      shape = to_edges = std::make_shared<const EdgeShape>(
          bent, lines_of(block, 0), lines_of(block, 1),
          Eigen::Vector2d(lattice.block.inner_x, lattice.block.inner_y));
    left = leave_out_uncovered(block);
  }
  while (!block.cells.empty()) {
    clear_mesh();
    make_triangulation(block, triangulation);
    refine_towards_patch(discretisation, lattice.refinements, triangulation);
    dofs.distribute_dofs(element);
    support = support_points();
    bend(support);
    if (!discretisation.is_scan) return left;
    const Columns folding = folded_columns();
    if (folding.empty()) return left;
    for (const auto& [corner, box] : folding)
      if (is_in_patch(box, discretisation)) left = Left::part;
    leave_out_folded(folding, block);
  }
  return Left::nothing;
}

LayerSpace::LayerSpace(const LayerDiscretisation& meant, const meshes::LayerMesh& mesh,
                       double thickness_m)
    : discretisation(meant), element(dealii::FE_Q<dim>(2), dim), meshed(true) {
  triangulate(mesh, thickness_m, discretisation, triangulation);
  discretisation.elements_per_semi_axis =
      std::max(meant.elements_per_semi_axis, cells_along_b(discretisation, triangulation));
  dofs.distribute_dofs(element);
  const std::vector<dealii::Point<dim>> support = support_points();
  bend(support);
  constrain(support);
  collect_meshed_surface(support);
  number_surface();
  if (nodes.empty())
    throw InputError(
        "mesh of the layer", "physical surface \"contact\"", "",
        "a surface at the origin of the mesh's coordinates, where the load acts along z");
}

LayerSpace::LayerSpace(const PlacedMesh& mesh, MirrorPlanes mirrored)
    : element(dealii::FE_Q<dim>(2), dim), planes(mirrored), meshed(true) {
  // The mesh says itself what can be touched.
  constexpr double everywhere = 1e6;
  discretisation.a = discretisation.b = everywhere;
  std::vector<dealii::Point<dim>> vertices;
  for (const Eigen::Vector3d& vertex : mesh.vertices)
    vertices.emplace_back(vertex.x(), vertex.y(), vertex.z());
  std::vector<dealii::CellData<dim>> cells(mesh.cells.size());
  for (std::size_t i = 0; i < cells.size(); ++i)
    std::copy(mesh.cells[i].begin(), mesh.cells[i].end(), cells[i].vertices.begin());
  triangulation.create_triangulation(vertices, cells, dealii::SubCellData());
  constexpr unsigned int bottom = 4, top = 5;
  for (const auto& cell : triangulation.active_cell_iterators()) {
    if (cell->face(bottom)->at_boundary()) cell->face(bottom)->set_boundary_id(core_face);
    if (cell->face(top)->at_boundary() && mesh.touched[cell->active_cell_index()])
      cell->face(top)->set_boundary_id(contact_face);
  }
  dofs.distribute_dofs(element);
  std::vector<dealii::Point<dim>> support = support_points();
  place_nodes(mesh, support);
  constrain(support);
  collect_meshed_surface(support);
  number_surface();
}

/// Moves the nodes of straight cells to where the mesh places them.
void LayerSpace::place_nodes(const PlacedMesh& mesh, std::vector<dealii::Point<dim>>& support) {
  if (!mesh.curved) {
    mapping = std::make_unique<dealii::MappingQ1<dim>>();
    return;
  }
  bending.reinit(dofs.n_dofs());
  const std::vector<dealii::Point<dim>> straight = support;
  std::vector<global_dof_index> indices(element.n_dofs_per_cell());
  for (const auto& cell : dofs.active_cell_iterators()) {
    cell->get_dof_indices(indices);
    for (unsigned int i = 0; i < indices.size(); ++i) {
      const auto& unit = element.unit_support_point(i);
      const Eigen::Vector3d placed =
          mesh.place(cell->active_cell_index(), {unit[0], unit[1], unit[2]});
      const unsigned int c = element.system_to_component_index(i).first;
      bending[indices[i]] = placed[c] - straight[indices[i]][c];
      support[indices[i]] = dealii::Point<dim>(placed.x(), placed.y(), placed.z());
    }
  }
  mapping =
      std::make_unique<dealii::MappingQEulerian<dim, dealii::Vector<double>>>(2, dofs, bending);
}

namespace {

/// A key that is the same for all cells of a column, whatever rounding does.
std::pair<long, long> column_at(double x, double y) {
  constexpr double fine = 1e6;
  return {std::lround(fine * x), std::lround(fine * y)};
}

}  // namespace

/// Removes the cells that reach over the finger's edge, and those that this cuts off from the rest.
/// The result says whether the contact lost any of its cells.
LayerSpace::Left LayerSpace::leave_out_uncovered(meshes::HexahedralMesh& block) const {
  meshes::HexahedralMesh covered;
  covered.vertices = block.vertices;
  Left left = Left::all;
  for (std::size_t i = 0; i < block.cells.size(); ++i) {
    Box box{{infinite, infinite, infinite}, {-infinite, -infinite, -infinite}};
    for (const int vertex : block.cells[i])
      for (unsigned int c = 0; c < dim; ++c) {
        const double at = block.vertices[static_cast<std::size_t>(vertex)][c];
        box.first[c] = std::min(box.first[c], at);
        box.second[c] = std::max(box.second[c], at);
      }
    const auto& [low, high] = box;
    // The square's corners are farther away than the wall has to be.
    const LayerDiscretisation& mesh = discretisation;
    const auto distance = [&](unsigned int c) {
      return std::max({0.0, box.first[c], -box.second[c]});
    };
    if (std::hypot(distance(0) / (mesh.a + mesh.extent), distance(1) / (mesh.b + mesh.extent)) > 1)
      continue;
    const LayerShape::Cover cover = shape->covers(low[0], high[0], low[1], high[1]);
    if (to_edges && ends_finger(cover) && is_in_patch(box, mesh) && reaches_over_edge(box))
      left = Left::part;
    if (cover != LayerShape::Cover::whole) continue;
    covered.cells.push_back(block.cells[i]);
    covered.region.push_back(block.region[i]);
  }
  if (covered.cells.size() == block.cells.size()) return Left::all;
  block = std::move(covered);
  keep_cells_around_contact(block);
  return left;
}

/// Whether a cell that reaches beyond the finger's edge lies on this side of it as well.
bool LayerSpace::reaches_over_edge(const Box& box) const {
  constexpr double little = 0.05;  // what is less is no loss
  for (const double x : {box.first[0], (box.first[0] + box.second[0]) / 2, box.second[0]})
    for (const double y : {box.first[1], (box.first[1] + box.second[1]) / 2, box.second[1]}) {
      const double beyond = shape->beyond_edge(x, y);
      if (std::isfinite(beyond) && beyond < -little) return true;
    }
  return false;
}

/// Places in the block's plane over which a cell folds: the shape itself does not, but a quadratic
/// cell between a few of its points may. By the lowest corner of its coarse cell.
LayerSpace::Columns LayerSpace::folded_columns() const {
  constexpr unsigned int points_per_direction = 3;  // where stiffness is integrated
  dealii::FEValues<dim> values(*mapping, element, dealii::QGauss<dim>(points_per_direction),
                               dealii::update_JxW_values);
  Columns folding;
  for (const auto& cell : dofs.active_cell_iterators()) {
    values.reinit(cell);
    const std::vector<double>& volumes = values.get_JxW_values();
    if (*std::min_element(volumes.begin(), volumes.end()) > 0) continue;
    auto coarse = static_cast<dealii::Triangulation<dim>::cell_iterator>(cell);
    while (coarse->level() > 0) coarse = coarse->parent();
    const Box box = box_of(coarse);
    folding.emplace(column_at(box.first[0], box.first[1]), box);
  }
  return folding;
}

/// A cell that folds is left out with all above and below it: no contact shall lie over a hole. The
/// mesh then has to be made anew from what is left.
void LayerSpace::leave_out_folded(const Columns& folding, meshes::HexahedralMesh& block) const {
  meshes::HexahedralMesh left;
  left.vertices = block.vertices;
  for (std::size_t i = 0; i < block.cells.size(); ++i) {
    Eigen::Vector3d low = block.vertices[static_cast<std::size_t>(block.cells[i][0])];
    for (const int vertex : block.cells[i])
      low = low.cwiseMin(block.vertices[static_cast<std::size_t>(vertex)]);
    if (folding.count(column_at(low.x(), low.y()))) continue;
    left.cells.push_back(block.cells[i]);
    left.region.push_back(block.region[i]);
  }
  block = std::move(left);
  keep_cells_around_contact(block);
}

void LayerSpace::clear_mesh() {
  mapping.reset();
  dofs.clear();
  triangulation.clear();
}

std::vector<dealii::Point<dim>> LayerSpace::support_points() const {
  std::vector<dealii::Point<dim>> support(dofs.n_dofs());
  dealii::DoFTools::map_dofs_to_support_points(dealii::MappingQ1<dim>(), dofs, support);
  return support;
}

void LayerSpace::number_surface() {
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (const auto dof : node_dofs[i]) surface_node[dof] = static_cast<int>(i);
}

/// The layer's shape as a quadratic displacement of the block, continuous across hanging nodes.
void LayerSpace::bend(const std::vector<dealii::Point<dim>>& support) {
  if (!shape) {
    mapping = std::make_unique<dealii::MappingQ1<dim>>();
    return;
  }
  bending.reinit(dofs.n_dofs());
  std::vector<global_dof_index> indices(element.n_dofs_per_cell());
  for (const auto& cell : dofs.active_cell_iterators()) {
    cell->get_dof_indices(indices);
    for (unsigned int i = 0; i < indices.size(); ++i) {
      const auto& point = support[indices[i]];
      const unsigned int c = element.system_to_component_index(i).first;
      // One component at a time: the map is called three times per node, which is little work.
      bending[indices[i]] = shape->position(point[0], point[1], point[2])[c] - point[c];
    }
  }
  dealii::AffineConstraints<double> hanging;
  dealii::DoFTools::make_hanging_node_constraints(dofs, hanging);
  hanging.close();
  hanging.distribute(bending);
  mapping =
      std::make_unique<dealii::MappingQEulerian<dim, dealii::Vector<double>>>(2, dofs, bending);
}

void LayerSpace::constrain(const std::vector<dealii::Point<dim>>& support) {
  dealii::DoFTools::make_hanging_node_constraints(dofs, constraints);
  on_plane.assign(dofs.n_dofs(), 0);
  component.assign(dofs.n_dofs(), 0);
  node_of.assign(dofs.n_dofs(), 0);
  std::vector<global_dof_index> indices(element.n_dofs_per_cell());
  std::vector<char> bonded(dofs.n_dofs(), 0);
  for (const auto& cell : dofs.active_cell_iterators()) {
    cell->get_dof_indices(indices);
    for (unsigned int i = 0; i < indices.size(); ++i) {
      const auto dof = indices[i];
      const auto [component_of_dof, node] = element.system_to_component_index(i);
      component[dof] = static_cast<char>(component_of_dof);
      node_of[dof] = indices[element.component_to_system_index(0, node)];
      on_plane[dof] = static_cast<char>((planes.x && at(support[dof][0], 0) ? 1 : 0) +
                                        (planes.y && at(support[dof][1], 0) ? 2 : 0));
      bonded[dof] = at(support[dof][2], -1);
    }
  }
  if (meshed) bonded = dofs_on([](auto id) { return id == core_face; });
  if (discretisation.clamped_wall) {
    const std::vector<char> walls = dofs_on_walls(Walls::inside);
    for (global_dof_index i = 0; i < bonded.size(); ++i) bonded[i] |= walls[i];
  }
  for (global_dof_index i = 0; i < bonded.size(); ++i)
    if (bonded[i] && !constraints.is_constrained(i)) constraints.add_line(i);
  constraints.close();
}

/// Whether a side face of the block, by its centre, lies on the finger's sharp edge.
template <class Face>
bool LayerSpace::is_on_edge(const Face& face) const {
  if (!shape || !shape->has_edges()) return false;
  const Box box = box_of(face);
  const auto is_there = [&](double x, double y) {
    return std::abs(shape->beyond_edge(x, y)) < fitted_to_edge;
  };
  return is_there(box.first[0], box.first[1]) && is_there(box.second[0], box.second[1]) &&
         is_there((box.first[0] + box.second[0]) / 2, (box.first[1] + box.second[1]) / 2);
}

bool LayerSpace::is_at_rim(const dealii::Point<dim>& face, const dealii::Point<dim>& cell) const {
  if (!shape) return false;
  constexpr double beyond = 1.1;
  const auto at = cell + beyond * (face - cell);
  return ends_finger(shape->covers(at[0], at[0], at[1], at[1]));
}

/// Dofs of the faces between the surface and the core, mirror planes left out.
std::vector<char> LayerSpace::dofs_on_walls(Walls walls) const {
  std::vector<char> result(dofs.n_dofs(), 0);
  std::vector<global_dof_index> indices(element.n_dofs_per_face());
  for (const auto& cell : dofs.active_cell_iterators())
    for (const unsigned int f : cell->face_indices()) {
      const auto face = cell->face(f);
      if (!face->at_boundary()) continue;
      const auto centre = face->center();
      const bool on_mirror = (planes.x && at(centre[0], 0)) || (planes.y && at(centre[1], 0));
      if (on_mirror || at(centre[2], 0) || at(centre[2], -1)) continue;
      const bool on_edge = is_on_edge(face);
      if (walls == Walls::on_edges ? !on_edge : on_edge) continue;
      // The layer ends freely at the end of the finger.
      if (walls == Walls::inside && is_at_rim(centre, cell->center())) continue;
      face->get_dof_indices(indices);
      for (const auto dof : indices) result[dof] = 1;
    }
  return result;
}

std::vector<char> LayerSpace::dofs_on(
    const std::function<bool(dealii::types::boundary_id)>& is_meant) const {
  std::vector<char> result(dofs.n_dofs(), 0);
  std::vector<global_dof_index> indices(element.n_dofs_per_face());
  for (const auto& cell : dofs.active_cell_iterators())
    for (const unsigned int f : cell->face_indices()) {
      if (!cell->face(f)->at_boundary() || !is_meant(cell->face(f)->boundary_id())) continue;
      cell->face(f)->get_dof_indices(indices);
      for (const auto dof : indices) result[dof] = 1;
    }
  return result;
}

void LayerSpace::collect_surface(const std::vector<dealii::Point<dim>>& support) {
  std::vector<char> at_end(dofs.n_dofs(), 0), on_edge = at_end;
  if (discretisation.is_scan) {
    at_end = dofs_on_walls(Walls::beside_edges);
    on_edge = dofs_on_walls(Walls::on_edges);
  }
  collect_finest_faces(support, at_end, on_edge, *this);
}

void LayerSpace::collect_meshed_surface(const std::vector<dealii::Point<dim>>& support) {
  const std::vector<char> at_end = dofs_on([](auto id) { return id != contact_face; });
  collect_contact_faces(support, at_end, *this);
}

}  // namespace softfinger::fem
