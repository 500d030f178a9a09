#include "fem/layer/layer_space.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q1.h>
#include <deal.II/fe/mapping_q_eulerian.h>
#include <deal.II/grid/grid_tools.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "fem/base/threads.h"
#include "fem/layer/edge_shape.h"
#include "meshes/generation/divide_sheets.h"
#include "meshes/generation/layer_block.h"
#include "meshes/generation/layer_mesh.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

using dealii::types::global_dof_index;

bool at(double coordinate, double plane) { return std::abs(coordinate - plane) < 1e-9; }

/// Our meshes number a face's corners around it, deal.II row by row.
constexpr std::array<std::size_t, 4> corners_row_by_row{0, 1, 3, 2};
constexpr std::array<std::size_t, 8> corners_layer_by_layer{0, 1, 3, 2, 4, 5, 7, 6};

/// Integrals over the unit interval of its three quadratic shape functions (Simpson's weights).
/// Their products are the biquadratic ones' over a face: all positive.
constexpr std::array<double, 3> shape_integrals{1.0 / 6, 4.0 / 6, 1.0 / 6};

/// The coarse lattice that, halved `refinements` times, gives cells of the size the contact asks
/// for.
struct Lattice {
  meshes::LayerBlock block;
  int refinements = 0;
};

/// @param coarsest  longest cells, in thicknesses
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
  // A bent layer ends at its reach; near it even the coarsest cells are small enough to fit.
  const auto fit = [](double inner, double reach, double& cell, double& length) {
    length = std::min(length, reach);
    const double usable = LayerDiscretisation::usable_reach * length;
    if (std::ceil(inner / cell - 1e-9) * cell < usable) return;
    const double cells = std::ceil(inner / (usable - inner));
    cell = inner / cells;
  };
  fit(block.inner_x, discretisation.reach_x, block.cell_x, block.length_x);
  fit(block.inner_y, discretisation.reach_y, block.cell_y, block.length_y);
  // From cell to cell towards the side wall. Chosen: what it costs in d is in the stated 0.01 %.
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

/// The mesh from its quarter x, y >= 0, on one side of mirror planes.
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

/// Drops cells that are not connected by vertices with those at the origin.
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

/// How near to the patch cells are halved, in their longest sides. A contact that is small against
/// the thickness strains what is around it: with 0.7 its approach was 0.09 % off at s = 0.1, 0.05 %
/// at 0.2, 0.01 % from 0.5 on, and its torque 0.04 % up to s = 0.5. Larger contacts lose nothing,
/// and their meshes are half as large.
/// On scans less is enough: with a third, cells of up to three times their depth are halved in one
/// layer, not in two, which would double the mesh. Against 1, a fingertip under 0.2 to 5 N changes
/// by up to 0.15 % in a and the area, where 0.3 and 0.5 % are stated, and 0.04 % in the torque.
double fine_surroundings(const LayerDiscretisation& mesh) {
  constexpr double small = 0.75;
  constexpr double on_scan = 1.0 / 3;
  if (mesh.is_scan) return on_scan;
  return mesh.b < small ? 1 : 0.7;
}

/// Halves the cells near the patch, level by level, so that cell size grows with the distance.
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

/// Marks of the faces of a mesh from outside; all others are free.
enum : dealii::types::boundary_id { contact_face = 1, core_face = 2 };

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

using Box = std::pair<dealii::Point<dim>, dealii::Point<dim>>;
constexpr double infinite = std::numeric_limits<double>::infinity();

template <class Object>
Box box_of(const Object& object) {
  return object->bounding_box().get_boundary_points();
}

double distance(const Box& one, const Box& other) {
  double squares = 0;
  for (unsigned int c = 0; c < dim; ++c) {
    const double apart =
        std::max({0.0, one.first[c] - other.second[c], other.first[c] - one.second[c]});
    squares += apart * apart;
  }
  return std::sqrt(squares);
}

/// Whether a box reaches into the ellipse where contact is possible, seen along the load.
bool is_in_patch(const Box& box, const LayerDiscretisation& discretisation) {
  const auto& [low, high] = box;
  const double x = std::max({0.0, low[0], -high[0]}) / (discretisation.patch * discretisation.a);
  const double y = std::max({0.0, low[1], -high[1]}) / (discretisation.patch * discretisation.b);
  return x * x + y * y < 1;
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

/// How many times an edge is as long as wanted. Sizes that are meant to be equal differ by
/// round-off.
double oversize(const dealii::Tensor<1, dim>& edge, const dealii::Point<dim>& wanted) {
  constexpr double round_off = 1e-6;
  double largest = 0;
  for (unsigned int c = 0; c < dim; ++c) largest = std::max(largest, std::abs(edge[c]) / wanted[c]);
  return largest / (1 + round_off);
}

/// Of the edges of a cell or a face. (A skewed cell's box would be larger than any of them.)
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

/// Cells along b, of the largest in the patch; 0 where there are none.
int cells_along_b(const LayerDiscretisation& discretisation,
                  const dealii::Triangulation<dim>& triangulation) {
  const dealii::Point<dim> wanted = wanted_sides(discretisation);
  double largest = 0;
  for (const Face& face : patch_faces(discretisation, triangulation))
    largest = std::max(largest, largest_oversize(face, wanted));
  return largest > 0 ? static_cast<int>(discretisation.elements_per_semi_axis / largest) : 0;
}

/// A user's mesh that is divided along sheets before its cells are halved.
class DividedMesh {
 public:
  DividedMesh(const meshes::LayerMesh& mesh, double thickness,
              const LayerDiscretisation& discretisation)
      : mesh_(mesh), thickness_(thickness), discretisation_(discretisation) {
    find_edges_in_patch();
  }

  /// Of all ways to make the patch's cells small enough, the one with the fewest cells: dividing
  /// sheets makes long cells shorter, halving makes all sides smaller, and leaves what is far away.
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

  /// Of the cells whose contact faces lie in the patch, by how many times they are too long.
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

/// Collects the surface where contact is possible: its nodes, with their share of it, and its
/// faces.
class SurfaceBuilder {
 public:
  /// @param support  place of each dof, in the block or on the mesh from outside
  SurfaceBuilder(LayerSpace& space, const std::vector<dealii::Point<dim>>& support)
      : space_(space), support_(support) {
    space_.surface_node.assign(space_.dofs.n_dofs(), -1);
  }

  /// Adds the faces of our own block: only the finest ones, which form a regular grid of
  /// rectangles.
  /// @param at_end   per dof: where the surface ends
  /// @param on_edge  per dof: where the finger does, at a sharp edge
  void add_finest_faces(const std::vector<char>& at_end, const std::vector<char>& on_edge) {
    constexpr double equal = 1.01;  // the next coarser faces are twice as large
    const LayerDiscretisation& mesh = space_.discretisation;
    const double fine_x = mesh.a / mesh.elements_along_a();
    const double fine_y = mesh.b / mesh.elements_along_b();
    std::vector<global_dof_index> indices(space_.element.n_dofs_per_face());
    for (const auto& cell : space_.dofs.active_cell_iterators())
      for (const unsigned int f : cell->face_indices()) {
        const auto face = cell->face(f);
        if (!face->at_boundary() || !at(face->center()[2], 0)) continue;
        const auto [low, high] = box_of(face);
        const SurfaceFace rectangle{low[0], low[1], high[0] - low[0], high[1] - low[1], {}};
        if (rectangle.size_x > equal * fine_x || rectangle.size_y > equal * fine_y) continue;
        face->get_dof_indices(indices);
        add_rectangle(rectangle, indices, at_end, on_edge);
      }
  }

  /// Adds the faces of a mesh from outside. They are any quadrilaterals, so that their areas and
  /// normals are integrated.
  /// @param at_end  per dof: on a face beside the contact surface
  void add_contact_faces(const std::vector<char>& at_end) {
    dealii::FEFaceValues<dim> values(
        *space_.mapping, space_.element, dealii::QGauss<dim - 1>(3),
        dealii::update_values | dealii::update_normal_vectors | dealii::update_JxW_values);
    std::vector<global_dof_index> indices(space_.element.n_dofs_per_cell());
    for (const auto& cell : space_.dofs.active_cell_iterators())
      for (const unsigned int f : cell->face_indices()) {
        const auto face = cell->face(f);
        if (!face->at_boundary() || face->boundary_id() != contact_face ||
            !is_in_patch(box_of(face), space_.discretisation))
          continue;
        values.reinit(cell, f);
        cell->get_dof_indices(indices);
        add_quadrilateral(f, values, indices, at_end);
      }
    find_dofs_of_nodes();
    for (SurfaceNode& node : space_.nodes) {
      node.normal.normalize();
      // As in the block, the weight is an area seen along the load.
      node.area_ratio = 1 / node.normal.z();
      node.weight *= node.normal.z();
    }
  }

 private:
  using NodeDofs = std::array<global_dof_index, 3>;

  /// A face with what belongs to each of its nine nodes.
  struct NewFace {
    SurfaceFace face;
    std::array<NodeDofs, 9> dofs{};
    std::array<Eigen::Vector3d, 9> places{};
  };

  bool is_touchable(global_dof_index dof) const {
    const LayerDiscretisation& mesh = space_.discretisation;
    const Eigen::Vector2d at = place_along_surface(support_[dof][0], support_[dof][1]);
    return std::hypot(at.x() / (mesh.patch * mesh.a), at.y() / (mesh.patch * mesh.b)) <= 1 &&
           !space_.constraints.is_constrained(dof);
  }

  /// @param dof        that tells the node from others
  /// @param make_node  makes it where it is new
  template <class MakeNode>
  int number_of_node(global_dof_index dof, const MakeNode& make_node) {
    int& number = space_.surface_node[dof];
    if (number >= 0) return number;
    number = static_cast<int>(space_.nodes.size());
    space_.nodes.push_back(make_node());
    space_.node_dofs.emplace_back();
    return number;
  }

  /// The block may be stretched to the finger's edges: contacts are measured as if it were not.
  Eigen::Vector2d place_along_surface(double x, double y) const {
    return space_.to_edges ? space_.to_edges->place(x, y) : Eigen::Vector2d(x, y);
  }

  SurfaceNode& node(int number) { return space_.nodes[static_cast<std::size_t>(number)]; }

  SurfaceNode block_node(global_dof_index dof) const {
    const double x = support_[dof][0], y = support_[dof][1];
    const Eigen::Vector2d along = place_along_surface(x, y);
    SurfaceNode result{along.x(), along.y()};
    result.position = {x, y, 0};
    if (!space_.shape) return result;
    result.position = space_.shape->position(x, y, 0);
    result.normal = space_.shape->normal(x, y);
    result.area_ratio = space_.shape->area_ratio(x, y);
    return result;
  }

  /// Its weight and normal are still to be summed over its faces.
  SurfaceNode meshed_node(global_dof_index dof, bool at_end) const {
    SurfaceNode result{support_[dof][0], support_[dof][1]};
    result.position = place_of(dof);
    result.normal.setZero();
    result.at_end = at_end;
    return result;
  }

  Eigen::Vector3d place_of(global_dof_index dof) const {
    return {support_[dof][0], support_[dof][1], support_[dof][2]};
  }

  void add_rectangle(const SurfaceFace& rectangle, const std::vector<global_dof_index>& indices,
                     const std::vector<char>& at_end, const std::vector<char>& on_edge) {
    NewFace made{rectangle};
    made.face.node.fill(-1);
    for (const global_dof_index dof : indices) {
      const auto column = static_cast<std::size_t>(
          std::lround(2 * (support_[dof][0] - rectangle.x) / rectangle.size_x));
      const auto row = static_cast<std::size_t>(
          std::lround(2 * (support_[dof][1] - rectangle.y) / rectangle.size_y));
      const std::size_t k = column + 3 * row;
      const int c = space_.component[dof];
      made.dofs[k][static_cast<std::size_t>(c)] = dof;
      made.places[k] = {rectangle.x + 0.5 * static_cast<double>(column) * rectangle.size_x,
                        rectangle.y + 0.5 * static_cast<double>(row) * rectangle.size_y, 0};
      // Each node once: by its normal component.
      if (c != 2 || !is_touchable(dof)) continue;
      made.face.node[k] = number_of_node(dof, [&] { return block_node(dof); });
      node(made.face.node[k]).at_end = at_end[dof] != 0;
      node(made.face.node[k]).on_edge = on_edge[dof] != 0;
      node(made.face.node[k]).weight +=
          shape_integrals[column] * shape_integrals[row] * rectangle.size_x * rectangle.size_y;
    }
    add(made);
  }

  /// @param number  of the face in its cell
  void add_quadrilateral(unsigned int number, const dealii::FEFaceValues<dim>& values,
                         const std::vector<global_dof_index>& indices,
                         const std::vector<char>& at_end) {
    // The cell's own coordinates along the face; the one across it is constant.
    const unsigned int across = number / 2;
    const unsigned int first = across == 0 ? 1 : 0, second = across == 2 ? 1 : 2;
    NewFace made{{0, 0, 1, 1, {}}};
    made.face.node.fill(-1);
    for (unsigned int i = 0; i < indices.size(); ++i) {
      if (!space_.element.has_support_on_face(i, number)) continue;
      const global_dof_index dof = indices[i];
      const auto& unit = space_.element.unit_support_point(i);
      const auto k = static_cast<std::size_t>(std::lround(2 * unit[first]) +
                                              3 * std::lround(2 * unit[second]));
      const int c = space_.component[dof];
      made.dofs[k][static_cast<std::size_t>(c)] = dof;
      made.places[k] = place_of(dof);
      // Each node once: by its component along the load.
      if (c != 2) continue;
      for (const auto& [master, share] : masters_of(dof)) {
        if (!is_touchable(master)) continue;
        const int touched =
            number_of_node(master, [&, at = master] { return meshed_node(at, at_end[at] != 0); });
        if (share == 1) made.face.node[k] = touched;
        add_share_of_face(values, i, share, node(touched));
      }
    }
    add(made);
  }

  /// By their numbers, which the component along the load has: a node from which others hang may be
  /// on none of the faces.
  void find_dofs_of_nodes() {
    std::vector<int> number(space_.dofs.n_dofs(), -1);
    for (global_dof_index i = 0; i < space_.dofs.n_dofs(); ++i)
      if (space_.surface_node[i] >= 0) number[space_.node_of[i]] = space_.surface_node[i];
    for (global_dof_index i = 0; i < space_.dofs.n_dofs(); ++i)
      if (const int node = number[space_.node_of[i]]; node >= 0)
        space_.node_dofs[static_cast<std::size_t>(node)]
                        [static_cast<std::size_t>(space_.component[i])] = i;
  }

  using Masters = std::vector<std::pair<global_dof_index, double>>;

  /// The node itself, or those that it is interpolated from where it hangs, with their shares.
  Masters masters_of(global_dof_index dof) const {
    if (!space_.constraints.is_constrained(dof)) return {{dof, 1.0}};
    return *space_.constraints.get_constraint_entries(dof);
  }

  /// Adds to a node's weight and normal a share of the integrals of a shape function over a face.
  static void add_share_of_face(const dealii::FEFaceValues<dim>& values,
                                unsigned int shape_function, double share, SurfaceNode& node) {
    for (const unsigned int q : values.quadrature_point_indices()) {
      const double area = share * values.shape_value(shape_function, q) * values.JxW(q);
      const auto& normal = values.normal_vector(q);
      node.weight += area;
      node.normal += area * Eigen::Vector3d(normal[0], normal[1], normal[2]);
    }
  }

  /// Faces that cannot be touched at all are left out.
  void add(const NewFace& made) {
    bool touchable = false;
    for (std::size_t k = 0; k < 9; ++k) {
      if (made.face.node[k] < 0) continue;
      space_.node_dofs[static_cast<std::size_t>(made.face.node[k])] = made.dofs[k];
      touchable = true;
    }
    if (!touchable) return;
    space_.faces.push_back(made.face);
    space_.face_dofs.push_back(made.dofs);
    space_.face_places.push_back(made.places);
  }

  LayerSpace& space_;
  const std::vector<dealii::Point<dim>>& support_;
};

}  // namespace

LayerSpace::LayerSpace(const LayerDiscretisation& meant,
                       const std::shared_ptr<const LayerShape>& bent, MirrorPlanes mirrored)
    : discretisation(meant), element(dealii::FE_Q<dim>(2), dim), shape(bent), planes(mirrored) {
  std::vector<dealii::Point<dim>> support;
  // Where cells under the contact fold or do not fit between it and an edge, cells half as long
  // may.
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

/// Between the columns of a block's cells, ascending.
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
  DividedMesh(mesh, thickness_m, discretisation).triangulate(triangulation);
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

namespace {

/// The same for all cells of a column, whatever rounding does.
std::pair<long, long> column_at(double x, double y) {
  constexpr double fine = 1e6;
  return {std::lround(fine * x), std::lround(fine * y)};
}

}  // namespace

/// Cells where the shape ends are no part of the mesh, nor islands beyond them.
/// Those that reach over the finger's edge are missed under the contact.
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
    const auto distance = [&](unsigned int c) { return std::max({0.0, low[c], -high[c]}); };
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

dealii::AffineConstraints<double> LayerSpace::constraints_in(
    const std::vector<Eigen::Matrix3d>& frames) const {
  dealii::AffineConstraints<double> turned;
  for (const auto& line : constraints.get_lines()) {
    turned.add_line(line.index);
    for (const auto& [dof, share] : line.entries) {
      const int node = surface_node[dof];
      if (node < 0) {
        turned.add_entry(line.index, dof, share);
        continue;
      }
      const auto number = static_cast<std::size_t>(node);
      for (std::size_t c = 0; c < dim; ++c)
        turned.add_entry(line.index, node_dofs[number][c],
                         share * frames[number](component[line.index], static_cast<int>(c)));
    }
  }
  turned.close();
  return turned;
}

std::vector<std::pair<int, double>> LayerSpace::node_shares(std::size_t face,
                                                            std::size_t place) const {
  const global_dof_index dof = face_dofs[face][place][2];
  if (surface_node[dof] >= 0) return {{surface_node[dof], 1.0}};
  std::vector<std::pair<int, double>> shares;
  if (const auto* masters = constraints.get_constraint_entries(dof))
    for (const auto& [master, share] : *masters)
      if (surface_node[master] >= 0) shares.emplace_back(surface_node[master], share);
  return shares;
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
      // Where the finger ends, its layer ends freely.
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
  SurfaceBuilder(*this, support).add_finest_faces(at_end, on_edge);
}

void LayerSpace::collect_meshed_surface(const std::vector<dealii::Point<dim>>& support) {
  const std::vector<char> at_end = dofs_on([](auto id) { return id != contact_face; });
  SurfaceBuilder(*this, support).add_contact_faces(at_end);
}

void LayerSpace::turn_to_frames(const std::vector<Eigen::Matrix3d>& frames,
                                const std::vector<global_dof_index>& indices,
                                dealii::FullMatrix<double>& matrix) const {
  std::map<int, std::array<unsigned int, 3>> places;
  for (unsigned int i = 0; i < indices.size(); ++i)
    if (const int node = surface_node[indices[i]]; node >= 0)
      places[node][static_cast<std::size_t>(component[indices[i]])] = i;
  for (const auto& [node, place] : places) {
    const Eigen::Matrix3d& frame = frames[static_cast<std::size_t>(node)];
    for (unsigned int j = 0; j < indices.size(); ++j) {
      const Eigen::Vector3d row(matrix(place[0], j), matrix(place[1], j), matrix(place[2], j));
      const Eigen::Vector3d turned = frame.transpose() * row;
      for (unsigned int c = 0; c < 3; ++c) matrix(place[c], j) = turned[c];
    }
    for (unsigned int j = 0; j < indices.size(); ++j) {
      const Eigen::Vector3d column(matrix(j, place[0]), matrix(j, place[1]), matrix(j, place[2]));
      const Eigen::Vector3d turned = frame.transpose() * column;
      for (unsigned int c = 0; c < 3; ++c) matrix(j, place[c]) = turned[c];
    }
  }
}

Unknowns LayerSpace::free_unknowns(Parity parity) const {
  Unknowns result;
  result.of_dof.assign(dofs.n_dofs(), -1);
  for (global_dof_index i = 0; i < dofs.n_dofs(); ++i) {
    const bool fixed_x = (on_plane[i] & 1) && (component[i] == 0) != parity.odd_x;
    const bool fixed_y = (on_plane[i] & 2) && (component[i] == 1) != parity.odd_y;
    if (!fixed_x && !fixed_y && !constraints.is_constrained(i)) result.of_dof[i] = result.count++;
  }
  return result;
}

SparseSymmetricMatrix LayerSpace::lower_triangle(const dealii::SparsityPattern& pattern,
                                                 const Unknowns& free) const {
  SparseSymmetricMatrix lower;
  lower.size = free.count;
  lower.column_begin.reserve(static_cast<std::size_t>(free.count) + 1);
  lower.column_begin.push_back(0);
  lower.row.reserve(pattern.n_nonzero_elements() / 2 + static_cast<std::size_t>(free.count));
  for (global_dof_index i = 0; i < dofs.n_dofs(); ++i) {
    if (free.of_dof[i] < 0) continue;
    // Row i of a symmetric matrix is its column i; deal.II puts the diagonal first, then ascends.
    for (auto entry = pattern.begin(i); entry != pattern.end(i); ++entry)
      if (const int row = free.of_dof[entry->column()]; row >= free.of_dof[i])
        lower.row.push_back(row);
    lower.column_begin.push_back(static_cast<int>(lower.row.size()));
  }
  lower.value.resize(lower.row.size());
  return lower;
}

void LayerSpace::copy_entries(const dealii::SparseMatrix<double>& stiffness, const Unknowns& free,
                              SparseSymmetricMatrix& lower) const {
  auto value = lower.value.begin();
  for (global_dof_index i = 0; i < dofs.n_dofs(); ++i) {
    if (free.of_dof[i] < 0) continue;
    for (auto entry = stiffness.begin(i); entry != stiffness.end(i); ++entry)
      if (free.of_dof[entry->column()] >= free.of_dof[i]) *value++ = entry->value();
  }
}

/// The node of each free unknown, nodes that have one numbered by their first.
std::vector<int> LayerSpace::nodes_of(const Unknowns& free) const {
  std::vector<int> number(dofs.n_dofs(), -1), result;
  int count = 0;
  for (global_dof_index i = 0; i < dofs.n_dofs(); ++i) {
    if (free.of_dof[i] < 0) continue;
    int& node = number[node_of[i]];
    if (node < 0) node = count++;
    result.push_back(node);
  }
  return result;
}

void LayerSpace::dissect(const SparseSymmetricMatrix& matrix, const Unknowns& free) {
  const std::vector<int> node = nodes_of(free);
  const std::vector<int> order = nested_dissection(quotient_graph(matrix, node));
  std::vector<int> rank(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    rank[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  // Nodes that this parity fixes come last: they are fixed in most others too.
  std::vector<int> node_rank(dofs.n_dofs(), static_cast<int>(order.size()));
  for (global_dof_index i = 0; i < dofs.n_dofs(); ++i)
    if (free.of_dof[i] >= 0)
      node_rank[node_of[i]] =
          rank[static_cast<std::size_t>(node[static_cast<std::size_t>(free.of_dof[i])])];
  dissection.resize(dofs.n_dofs());
  std::iota(dissection.begin(), dissection.end(), 0);
  std::stable_sort(dissection.begin(), dissection.end(), [&](int left, int right) {
    return node_rank[node_of[static_cast<std::size_t>(left)]] <
           node_rank[node_of[static_cast<std::size_t>(right)]];
  });
}

std::vector<int> LayerSpace::dissection_of(const Unknowns& free) const {
  std::vector<int> ordering;
  ordering.reserve(static_cast<std::size_t>(free.count));
  for (const int dof : dissection)
    if (const int unknown = free.of_dof[static_cast<std::size_t>(dof)]; unknown >= 0)
      ordering.push_back(unknown);
  return ordering;
}

}  // namespace softfinger::fem
