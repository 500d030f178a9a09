#include "fem/layer/outside_mesh.h"

#include <deal.II/grid/grid_tools.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "fem/layer/patch_boxes.h"
#include "meshes/generation/divide_sheets.h"
#include "meshes/generation/layer_mesh.h"

namespace softfinger::fem {

namespace {

/// Our meshes number a face's corners around it, deal.II row by row.
constexpr std::array<std::size_t, 4> corners_row_by_row{0, 1, 3, 2};

void make_triangulation(const meshes::LayerMesh& mesh, double thickness,
                        dealii::Triangulation<dim>& triangulation) {
  std::vector<dealii::Point<dim>> vertices;
  for (const auto& vertex : mesh.hexahedra.vertices)
    vertices.emplace_back(vertex.x() / thickness, vertex.y() / thickness, vertex.z() / thickness);
  std::vector<dealii::CellData<dim>> cells;
  for (std::size_t i = 0; i < mesh.hexahedra.cells.size(); ++i) {
    const auto& vertices_of = mesh.hexahedra.cells[i];
    cells.emplace_back();
    cells.back().material_id = static_cast<dealii::types::material_id>(mesh.hexahedra.region[i]);
    for (std::size_t v = 0; v < 8; ++v)
      cells.back().vertices[v] = static_cast<unsigned int>(vertices_of[corners_layer_by_layer[v]]);
  }
  dealii::SubCellData faces;
  const auto mark = [&](const std::vector<std::array<int, 4>>& marked,
                        dealii::types::boundary_id id) {
    for (const auto& face : marked) {
      faces.boundary_quads.emplace_back();
      faces.boundary_quads.back().boundary_id = id;
      for (std::size_t v = 0; v < 4; ++v)
        faces.boundary_quads.back().vertices[v] =
            static_cast<unsigned int>(face[corners_row_by_row[v]]);
    }
  };
  mark(mesh.contact, contact_face);
  mark(mesh.core, core_face);
  dealii::GridTools::consistently_order_cells(cells);
  triangulation.create_triangulation(vertices, cells, faces);
}

using Face = dealii::Triangulation<dim>::face_iterator;

std::vector<Face> patch_faces(const LayerDiscretisation& discretisation,
                              const dealii::Triangulation<dim>& triangulation) {
  std::vector<Face> result;
  for (const auto& cell : triangulation.active_cell_iterators())
    for (const unsigned int f : cell->face_indices())
      if (cell->face(f)->at_boundary() && cell->face(f)->boundary_id() == contact_face &&
          is_in_patch(box_of(cell->face(f)), discretisation))
        result.push_back(cell->face(f));
  return result;
}

/// Longest sides that the contact asks for along x, y and z.
dealii::Point<dim> wanted_sides(const LayerDiscretisation& mesh) {
  const double fine_x = mesh.a / mesh.elements_along_a(), fine_y = mesh.b / mesh.elements_along_b();
  constexpr double depth = 2;  // under the surface stresses vary less than along it
  return {fine_x, fine_y, depth * std::min(fine_x, fine_y)};
}

/// The factor by which an edge is longer than wanted. Sizes that are meant to be equal differ by
/// round-off.
double oversize(const dealii::Tensor<1, dim>& edge, const dealii::Point<dim>& wanted) {
  constexpr double round_off = 1e-6;
  double largest = 0;
  for (unsigned int c = 0; c < dim; ++c) largest = std::max(largest, std::abs(edge[c]) / wanted[c]);
  return largest / (1 + round_off);
}

/// The largest factor of the edges of a cell or a face. (A skewed cell's box would be larger than
/// any of them.)
template <class Object>
double largest_oversize(const Object& object, const dealii::Point<dim>& wanted) {
  double largest = 0;
  for (unsigned int i = 0; i < object->n_lines(); ++i)
    largest = std::max(largest,
                       oversize(object->line(i)->vertex(1) - object->line(i)->vertex(0), wanted));
  return largest;
}

template <class Object>
double longest_edge(const Object& object) {
  double longest = 0;
  for (unsigned int i = 0; i < object->n_lines(); ++i)
    longest = std::max(longest, object->line(i)->diameter());
  return longest;
}

/// Halves the cells near the patch like those of our own block: each while it is too large itself
/// and nearer to the patch than a share of its longest side. Smaller ones stay as they are, so that
/// nodes may hang on the surface.
/// @param most_cells  where to give up
void refine_towards_patch(const LayerDiscretisation& discretisation, unsigned int most_cells,
                          dealii::Triangulation<dim>& triangulation) {
  constexpr int most_halvings = 12;  // cells 4096 times too large mean a wrong unit of length
  const dealii::Point<dim> wanted = wanted_sides(discretisation);
  bool is_done = false;
  for (int step = 0;
       !is_done && step < most_halvings && triangulation.n_active_cells() < most_cells; ++step) {
    std::vector<Box> patch;
    for (const Face& face : patch_faces(discretisation, triangulation))
      patch.push_back(box_of(face));
    is_done = true;
    for (const auto& cell : triangulation.active_cell_iterators()) {
      if (largest_oversize(cell, wanted) <= 1) continue;
      const Box box = box_of(cell);
      const double reach = fine_surroundings(discretisation) * longest_edge(cell);
      const Box around{{box.first[0] - reach, box.first[1] - reach, 0},
                       {box.second[0] + reach, box.second[1] + reach, 0}};
      // Faces in the patch may go far beyond it as long as they are large.
      if (!is_in_patch(around, discretisation) ||
          std::none_of(patch.begin(), patch.end(),
                       [&](const Box& face) { return distance(face, box) <= reach * (1 + 1e-9); }))
        continue;
      cell->set_refine_flag();
      is_done = false;
    }
    triangulation.execute_coarsening_and_refinement();
  }
}

/// A user's mesh that is divided along sheets before its cells are halved.
class DividedMesh {
 public:
  DividedMesh(const meshes::LayerMesh& mesh, double thickness,
              const LayerDiscretisation& discretisation)
      : mesh_(mesh), thickness_(thickness), discretisation_(discretisation) {
    find_edges_in_patch();
  }

  /// Takes the way with the fewest cells that makes the patch's cells small enough: dividing sheets
  /// makes long cells shorter, halving makes all sides smaller, and leaves what is far away.
  void triangulate(dealii::Triangulation<dim>& triangulation) const {
    // Sheets of many more parts only make slivers far away.
    constexpr double most_parts = 16;
    double largest = 1;
    for (const auto& [edge, size] : edges_) largest = std::max(largest, size);
    double best = 1;
    unsigned int fewest = std::numeric_limits<unsigned int>::max();
    for (double halved = 1; halved < 2 * largest; halved *= 2) {
      if (largest / halved > most_parts) continue;
      dealii::Triangulation<dim> trial(
          dealii::Triangulation<dim>::limit_level_difference_at_vertices);
      triangulate(halved, fewest, trial);
      if (trial.n_active_cells() >= fewest) continue;
      fewest = trial.n_active_cells();
      best = halved;
    }
    triangulate(best, std::numeric_limits<unsigned int>::max(), triangulation);
  }

 private:
  using Edge = std::pair<int, int>;

  dealii::Point<dim> place(int vertex) const {
    const Eigen::Vector3d at =
        mesh_.hexahedra.vertices[static_cast<std::size_t>(vertex)] / thickness_;
    return {at.x(), at.y(), at.z()};
  }

  Box box(const std::array<int, 4>& face) const {
    Box result{place(face[0]), place(face[0])};
    for (const int vertex : face)
      for (unsigned int c = 0; c < dim; ++c) {
        result.first[c] = std::min(result.first[c], place(vertex)[c]);
        result.second[c] = std::max(result.second[c], place(vertex)[c]);
      }
    return result;
  }

  /// Finds the edges of the cells whose contact faces lie in the patch, and by what factor they are
  /// too long.
  void find_edges_in_patch() {
    std::set<int> vertices;
    for (const auto& face : mesh_.contact)
      if (is_in_patch(box(face), discretisation_)) vertices.insert(face.begin(), face.end());
    const dealii::Point<dim> wanted = wanted_sides(discretisation_);
    // From a corner of gmsh's hexahedron to the next one along each direction.
    constexpr std::array<std::array<std::size_t, 2>, 12> ends{{{0, 1},
                                                               {1, 2},
                                                               {3, 2},
                                                               {0, 3},
                                                               {4, 5},
                                                               {5, 6},
                                                               {7, 6},
                                                               {4, 7},
                                                               {0, 4},
                                                               {1, 5},
                                                               {2, 6},
                                                               {3, 7}}};
    for (const auto& cell : mesh_.hexahedra.cells) {
      if (std::count_if(cell.begin(), cell.end(),
                        [&](int vertex) { return vertices.count(vertex) > 0; }) < 4)
        continue;
      for (const auto& [from, to] : ends) {
        const Edge edge = std::minmax({cell[from], cell[to]});
        edges_[edge] = oversize(place(edge.second) - place(edge.first), wanted);
      }
    }
  }

  /// @param halved  how many times too large cells are still when sheets are divided
  void triangulate(double halved, unsigned int most_cells,
                   dealii::Triangulation<dim>& triangulation) const {
    const auto parts = [&](int from, int to) {
      const auto found = edges_.find(std::minmax({from, to}));
      if (found == edges_.end()) return 1;
      return std::max(1, static_cast<int>(std::ceil(found->second / halved)));
    };
    make_triangulation(meshes::divide_sheets(mesh_, parts), thickness_, triangulation);
    refine_towards_patch(discretisation_, most_cells, triangulation);
  }

  const meshes::LayerMesh& mesh_;
  double thickness_;
  LayerDiscretisation discretisation_;
  std::map<Edge, double> edges_;
};

}  // namespace

void triangulate(const meshes::LayerMesh& mesh, double thickness,
                 const LayerDiscretisation& discretisation,
                 dealii::Triangulation<dim>& triangulation) {
  DividedMesh(mesh, thickness, discretisation).triangulate(triangulation);
}

int cells_along_b(const LayerDiscretisation& discretisation,
                  const dealii::Triangulation<dim>& triangulation) {
  const dealii::Point<dim> wanted = wanted_sides(discretisation);
  double largest = 0;
  for (const Face& face : patch_faces(discretisation, triangulation))
    largest = std::max(largest, largest_oversize(face, wanted));
  return largest > 0 ? static_cast<int>(discretisation.elements_per_semi_axis / largest) : 0;
}

}  // namespace softfinger::fem
