#include "fem/layer/contact_surface.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <array>
#include <cmath>
#include <utility>

#include "fem/layer/edge_shape.h"
#include "fem/layer/patch_boxes.h"

namespace softfinger::fem {

namespace {

using dealii::types::global_dof_index;

/// Integrals over the unit interval of its three quadratic shape functions (Simpson's weights).
/// Their products are the biquadratic ones' over a face: all positive.
constexpr std::array<double, 3> shape_integrals{1.0 / 6, 4.0 / 6, 1.0 / 6};

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
      // The weight is an area seen along the load, as it is for nodes of the block.
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

  /// Makes a node whose weight and normal are still to be summed over its faces.
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

  /// Finds the dofs of the nodes by their numbers, which the component along the load has: a node
  /// from which others hang may be on none of the faces.
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

void collect_finest_faces(const std::vector<dealii::Point<dim>>& support,
                          const std::vector<char>& at_end, const std::vector<char>& on_edge,
                          LayerSpace& space) {
  SurfaceBuilder(space, support).add_finest_faces(at_end, on_edge);
}

void collect_contact_faces(const std::vector<dealii::Point<dim>>& support,
                           const std::vector<char>& at_end, LayerSpace& space) {
  SurfaceBuilder(space, support).add_contact_faces(at_end);
}

}  // namespace softfinger::fem
