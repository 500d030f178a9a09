#include "fem/layer_model.h"

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>

#include <algorithm>
#include <deque>
#include <utility>

#include "fem/cholesky.h"
#include "fem/element_stiffness.h"
#include "fem/layer_space.h"
#include "fem/surface_frame.h"
#include "fem/write_vtu.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

using dealii::types::global_dof_index;

struct LayerModel::Implementation : LayerSpace {
  using LayerSpace::LayerSpace;

  std::vector<ElasticConstants> sublayers;
  dealii::SparsityPattern pattern;
  dealii::SparseMatrix<double> stiffness;  ///< without the symmetries
  std::vector<Eigen::Matrix3d> frames;     ///< of a bent layer's surface nodes
  Unknowns even;                           ///< of the problem that pressing solves
  std::unique_ptr<CholeskyFactor> factor;  ///< none where it is condensed to all displacements
  Eigen::MatrixXd compliance;
  /// With the displacements of nodes that rub, 3 rows for each; empty where none does.
  Eigen::MatrixXd of_rubbing;
  std::vector<int> rubbing_row;  ///< per node, its first of them; -1: none

  void set_frames();
  void factorise(const Rubs& rubs);
  void assemble();
};

namespace {

/// In 3 x 3 blocks: the model's z points out of the layer.
void turn_normals_inwards(Eigen::MatrixXd& blocks) {
  const auto normals = Eigen::seq(2, Eigen::last, 3);
  blocks(normals, Eigen::all) *= -1;
  blocks(Eigen::all, normals) *= -1;
}

}  // namespace

void LayerModel::Implementation::assemble() {
  {
    dealii::DynamicSparsityPattern dynamic(dofs.n_dofs());
    dealii::DoFTools::make_sparsity_pattern(dofs, dynamic, constraints, /*keep_constrained=*/false);
    pattern.copy_from(dynamic);
  }
  stiffness.reinit(pattern);
  std::deque<ElementStiffness> of_sublayer;  // which cannot be moved
  for (const ElasticConstants& constants : sublayers)
    of_sublayer.emplace_back(*mapping, element, constants.poisson_ratio, shape != nullptr);
  dealii::AffineConstraints<double> turned;
  if (!frames.empty()) turned = constraints_in(frames);
  std::vector<global_dof_index> indices(element.n_dofs_per_cell());
  for (const auto& cell : dofs.active_cell_iterators()) {
    cell->get_dof_indices(indices);
    dealii::FullMatrix<double> of_element = of_sublayer[cell->material_id()](cell);
    of_element *= sublayers[cell->material_id()].youngs_ratio;
    if (!frames.empty()) turn_to_frames(frames, indices, of_element);
    (frames.empty() ? constraints : turned)
        .distribute_local_to_global(of_element, indices, stiffness);
  }
}

void LayerModel::Implementation::set_frames() {
  for (const SurfaceNode& node : nodes) frames.push_back(surface_frame(node.normal));
}

long predicted_unknowns(const LayerDiscretisation& discretisation, const meshes::LayerMesh& mesh,
                        double thickness_m) {
  return LayerSpace(discretisation, mesh, thickness_m).free_unknowns(Parity{}).count;
}

LayerModel::LayerModel(const LayerDiscretisation& discretisation, double poisson_ratio,
                       std::shared_ptr<const LayerShape> shape, MirrorPlanes planes)
    : LayerModel(discretisation, std::vector<ElasticConstants>{{1, poisson_ratio}},
                 std::move(shape), planes) {}

LayerModel::LayerModel(const LayerDiscretisation& discretisation,
                       std::vector<ElasticConstants> sublayers,
                       std::shared_ptr<const LayerShape> shape, MirrorPlanes planes,
                       const Rubs& rubs)
    : implementation_(std::make_unique<Implementation>(discretisation, std::move(shape), planes)) {
  implementation_->sublayers = std::move(sublayers);
  if (implementation_->shape) implementation_->set_frames();
  implementation_->factorise(rubs);
}

LayerModel::LayerModel(const LayerDiscretisation& discretisation,
                       std::vector<ElasticConstants> sublayers, const meshes::LayerMesh& mesh,
                       double thickness_m, const Rubs& rubs)
    : implementation_(std::make_unique<Implementation>(discretisation, mesh, thickness_m)) {
  auto& self = *implementation_;
  self.sublayers = std::move(sublayers);
  const auto is_flat = [](const SurfaceNode& node) { return node.normal.z() > 1 - 1e-12; };
  if (!std::all_of(self.nodes.begin(), self.nodes.end(), is_flat)) self.set_frames();
  self.factorise(rubs);
}

void LayerModel::Implementation::factorise(const Rubs& rubs) {
  assemble();
  even = free_unknowns(Parity{});
  std::vector<int> last;
  std::vector<Eigen::Index> normals;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const bool rubbing = rubs(nodes[i]);
    rubbing_row.push_back(rubbing ? static_cast<int>(last.size()) : -1);
    for (std::size_t c = rubbing ? 0 : 2; c < dim; ++c)
      last.push_back(even.of_dof[node_dofs[i][c]]);
    normals.push_back(static_cast<Eigen::Index>(last.size()) - 1);
  }
  const SparseSymmetricMatrix matrix = lower_triangle(stiffness, even);
  // A quarter's other parities need it again. The larger ones rather need the memory.
  if (!planes.both()) {
    stiffness.clear();
    pattern.reinit(0, 0, 0);
  }
  dissect(matrix, even);
  factor = std::make_unique<CholeskyFactor>(matrix, dissection_of(even), last);
  if (last.size() == nodes.size()) {
    compliance = factor->compliance_of_last();
    return;
  }
  // With its rows of all displacements it is the largest of what is held. Only files need it again.
  of_rubbing = std::move(*factor).compliance_of_last();
  factor.reset();
  compliance = of_rubbing(normals, normals);
}

Eigen::MatrixXd LayerModel::vector_compliance(Parity parity, const std::vector<int>& nodes) const {
  auto& self = *implementation_;
  const auto rubbing_row = [&](int node) {
    return self.rubbing_row[static_cast<std::size_t>(node)];
  };
  if (std::all_of(nodes.begin(), nodes.end(), [&](int node) { return rubbing_row(node) >= 0; })) {
    std::vector<Eigen::Index> rows;
    for (const int node : nodes)
      for (int c = 0; c < 3; ++c) rows.push_back(rubbing_row(node) + c);
    Eigen::MatrixXd compliance = self.of_rubbing(rows, rows);
    turn_normals_inwards(compliance);
    return compliance;
  }
  if (self.stiffness.empty()) self.assemble();
  const Unknowns free = self.free_unknowns(parity);
  std::vector<int> last;
  std::vector<Eigen::Index> place;  // of each in the 3 x 3 blocks
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const int unknown = free.of_dof[self.node_dofs[static_cast<std::size_t>(nodes[i])][c]];
      if (unknown < 0) continue;
      last.push_back(unknown);
      place.push_back(static_cast<Eigen::Index>(3 * i + c));
    }
  const Eigen::MatrixXd condensed =
      CholeskyFactor(self.lower_triangle(self.stiffness, free), self.dissection_of(free), last)
          .compliance_of_last();
  const auto size = static_cast<Eigen::Index>(3 * nodes.size());
  Eigen::MatrixXd compliance = Eigen::MatrixXd::Zero(size, size);
  compliance(place, place) = condensed;
  turn_normals_inwards(compliance);
  return compliance;
}

LayerModel::~LayerModel() = default;

const LayerDiscretisation& LayerModel::discretisation() const {
  return implementation_->discretisation;
}
const std::vector<SurfaceNode>& LayerModel::nodes() const { return implementation_->nodes; }
const std::vector<SurfaceFace>& LayerModel::faces() const { return implementation_->faces; }
long LayerModel::unknowns() const { return implementation_->even.count; }
MirrorPlanes LayerModel::planes() const { return implementation_->planes; }
const Eigen::MatrixXd& LayerModel::compliance() const { return implementation_->compliance; }

void LayerModel::write_vtu(const std::string& path, const Eigen::VectorXd& force,
                           double thickness_m, double youngs_modulus_Pa) const {
  auto& self = *implementation_;
  Eigen::VectorXd load = Eigen::VectorXd::Zero(self.even.count);
  for (std::size_t i = 0; i < self.nodes.size(); ++i)
    load[self.even.of_dof[self.node_dofs[i][2]]] = -force[static_cast<Eigen::Index>(i)];
  if (!self.factor) {
    self.assemble();
    self.factor =
        std::make_unique<CholeskyFactor>(self.lower_triangle(self.stiffness, self.even),
                                         self.dissection_of(self.even), std::vector<int>());
  }
  const Eigen::VectorXd solution = self.factor->solve(load);
  dealii::Vector<double> displacement_m(self.dofs.n_dofs()), pressure_Pa(self.dofs.n_dofs());
  for (global_dof_index i = 0; i < self.dofs.n_dofs(); ++i)
    if (self.even.of_dof[i] >= 0) displacement_m[i] = thickness_m * solution[self.even.of_dof[i]];
  for (std::size_t i = 0; i < self.frames.size(); ++i) {
    const auto& dof = self.node_dofs[i];
    const Eigen::Vector3d turned =
        self.frames[i] *
        Eigen::Vector3d(displacement_m[dof[0]], displacement_m[dof[1]], displacement_m[dof[2]]);
    for (const std::size_t c : {0, 1, 2})
      displacement_m[dof[c]] = turned[static_cast<Eigen::Index>(c)];
  }
  self.constraints.distribute(displacement_m);
  for (std::size_t i = 0; i < self.nodes.size(); ++i)
    pressure_Pa[self.node_dofs[i][2]] = youngs_modulus_Pa * force[static_cast<Eigen::Index>(i)] /
                                        (self.nodes[i].weight * self.nodes[i].area_ratio);
  dealii::GridTools::scale(thickness_m, self.triangulation);
  self.bending *= thickness_m;
  write_solution(path, *self.mapping, self.dofs, displacement_m, pressure_Pa, youngs_modulus_Pa,
                 self.sublayers);
  self.bending /= thickness_m;
  dealii::GridTools::scale(1 / thickness_m, self.triangulation);
}

}  // namespace softfinger::fem
