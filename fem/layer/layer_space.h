#pragma once

#include <deal.II/base/types.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/mapping.h>
#include <deal.II/grid/tria.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/full_matrix.h>
#include <deal.II/lac/sparse_matrix.h>
#include <deal.II/lac/vector.h>

#include <Eigen/Core>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "fem/algebra/cholesky.h"
#include "fem/layer/dimension.h"
#include "fem/layer/layer_model.h"

namespace softfinger::meshes {
struct HexahedralMesh;
}

namespace softfinger::fem {

class EdgeShape;
struct PlacedMesh;

/// The degrees of freedom that are solved for: those that neither the bond, nor a hanging node, nor
/// a symmetry fixes.
struct Unknowns {
  std::vector<int> of_dof;  ///< -1 where fixed
  int count = 0;
};

/// A layer's mesh with quadratic displacements on it, its bond, its mirror planes and its contact
/// surface: what linear and finite strain share. Lengths in h. Internal to `fem`: only the files
/// that include this header see types of the finite-element library.
struct LayerSpace {
  using Dof = dealii::types::global_dof_index;

  /// If a scan's layer folds everywhere at the contact, `folded` says so, and nothing else may be
  /// asked.
  /// @param bent      shape of a curved layer; null: flat
  /// @param mirrored  at these planes only one side is meshed
  LayerSpace(const LayerDiscretisation& meant, const std::shared_ptr<const LayerShape>& bent,
             MirrorPlanes mirrored);
  /// The whole layer, from a coarse mesh that the user supplies ("from outside").
  LayerSpace(const LayerDiscretisation& meant, const meshes::LayerMesh& mesh, double thickness_m);
  /// One side of the mirror planes, from a mesh that is not refined.
  LayerSpace(const PlacedMesh& mesh, MirrorPlanes mirrored);

  std::optional<FoldedLayer> folded;
  LayerDiscretisation discretisation;
  // deal.II can smooth the refinement further. That would add up to as many cells again, and change
  // no result by as much as its stated error.
  dealii::Triangulation<dim> triangulation{
      dealii::Triangulation<dim>::limit_level_difference_at_vertices};
  dealii::FESystem<dim> element;
  dealii::DoFHandler<dim> dofs{triangulation};
  std::shared_ptr<const LayerShape> shape;
  std::shared_ptr<const EdgeShape> to_edges;  ///< the same where it follows edges; else null
  MirrorPlanes planes;
  bool meshed = false;  ///< from outside
  dealii::Vector<double>
      bending;  ///< of a curved layer: displacement from the block to the layer, per dof
  std::unique_ptr<dealii::Mapping<dim>> mapping;
  dealii::AffineConstraints<double> constraints;  ///< the bond and the hanging nodes
  std::vector<char> on_plane;   ///< per dof: bit 0 on the mirror plane x = 0, bit 1 on y = 0
  std::vector<char> component;  ///< per dof: 0 to 2
  std::vector<Dof> node_of;     ///< per dof: the first dof of its node
  std::vector<std::array<Dof, 3>> node_dofs;  ///< of each surface node
  std::vector<SurfaceNode> nodes;
  std::vector<SurfaceFace> faces;
  /// Dofs and places of all nine nodes of each face, also of nodes that cannot be touched. Places
  /// are in the block; on a mesh from outside they are in space.
  std::vector<std::array<std::array<Dof, 3>, 9>> face_dofs;
  std::vector<std::array<Eigen::Vector3d, 9>> face_places;
  std::vector<int> surface_node;  ///< per dof; -1 elsewhere
  std::vector<int> dissection;    ///< of all dofs, for every parity; empty before `dissect`

  /// The constraints in terms of surface nodes' components along their frames: a hanging node may
  /// be interpolated from nodes of the contact surface.
  dealii::AffineConstraints<double> constraints_in(
      const std::vector<Eigen::Matrix3d>& frames) const;

  /// The surface nodes that tell a field at one of a face's nine places, with their shares: the
  /// node there, or those that it is interpolated from where it hangs.
  std::vector<std::pair<int, double>> node_shares(std::size_t face, std::size_t place) const;

  /// Turns the rows and columns of surface nodes in an element's matrix, so that their unknowns are
  /// the components along their frames: then only the normal ones have to be condensed on.
  void turn_to_frames(const std::vector<Eigen::Matrix3d>& frames, const std::vector<Dof>& indices,
                      dealii::FullMatrix<double>& matrix) const;

  Unknowns free_unknowns(Parity parity) const;

  /// The rows and columns of the free unknowns alone: where entries are.
  SparseSymmetricMatrix lower_triangle(const dealii::SparsityPattern& pattern,
                                       const Unknowns& free) const;
  /// The entries, of such a triangle.
  void copy_entries(const dealii::SparseMatrix<double>& stiffness, const Unknowns& free,
                    SparseSymmetricMatrix& lower) const;

  /// Finds `dissection`, an order of elimination with little fill. The problems of all
  /// parities differ only in components on the mirror planes: an order of the nodes that is good
  /// for one of them is good for all.
  /// Three unknowns of a node have the same neighbours: nodes are ordered, in a ninth of the graph.
  void dissect(const SparseSymmetricMatrix& matrix, const Unknowns& free);
  std::vector<int> dissection_of(const Unknowns& free) const;

 private:
  /// The part of the block under the contact that is left, up to the finger's edges.
  enum class Left { all, part, nothing };
  std::vector<dealii::Point<dim>> support_points() const;
  void bend(const std::vector<dealii::Point<dim>>& support);
  void place_nodes(const PlacedMesh& mesh, std::vector<dealii::Point<dim>>& support);
  void constrain(const std::vector<dealii::Point<dim>>& support);
  void collect_surface(const std::vector<dealii::Point<dim>>& support);
  void collect_meshed_surface(const std::vector<dealii::Point<dim>>& support);
  std::vector<char> dofs_on(const std::function<bool(dealii::types::boundary_id)>& is_meant) const;
  bool is_at_rim(const dealii::Point<dim>& face, const dealii::Point<dim>& cell) const;
  Left leave_out_uncovered(meshes::HexahedralMesh& block) const;
  bool reaches_over_edge(const std::pair<dealii::Point<dim>, dealii::Point<dim>>& box) const;
  /// Coarse cells seen from above, by their lowest corner.
  using Columns =
      std::map<std::pair<long, long>, std::pair<dealii::Point<dim>, dealii::Point<dim>>>;
  Left mesh_block(double coarsest, const std::shared_ptr<const LayerShape>& bent,
                  std::vector<dealii::Point<dim>>& support);
  void clear_mesh();
  Columns folded_columns() const;
  void leave_out_folded(const Columns& folding, meshes::HexahedralMesh& block) const;
  enum class Walls {
    on_edges,      ///< where the finger ends at a sharp edge
    beside_edges,  ///< all others
    inside,        ///< beside which the finger goes on
  };
  std::vector<char> dofs_on_walls(Walls walls) const;
  template <class Face>
  bool is_on_edge(const Face& face) const;
  void number_surface();
  std::vector<int> nodes_of(const Unknowns& free) const;
};

}  // namespace softfinger::fem
