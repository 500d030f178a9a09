#include "fem/pad/pad_model.h"

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>

#include <cmath>

#include "fem/algebra/cholesky.h"
#include "fem/layer/element_limits.h"
#include "fem/layer/element_stiffness.h"
#include "fem/layer/layer_space.h"

namespace softfinger::fem {

struct PadModel::Implementation : LayerSpace {
  using LayerSpace::LayerSpace;

  dealii::SparsityPattern pattern;
  dealii::SparseMatrix<double> stiffness;  ///< without the symmetries

  void assemble(double poisson_ratio, bool curved);
};

void PadModel::Implementation::assemble(double poisson_ratio, bool curved) {
  dealii::DynamicSparsityPattern dynamic(dofs.n_dofs());
  dealii::DoFTools::make_sparsity_pattern(dofs, dynamic, constraints, /*keep_constrained=*/false);
  pattern.copy_from(dynamic);
  stiffness.reinit(pattern);
  ElementStiffness of_element(*mapping, element, compressible(poisson_ratio), curved);
  std::vector<Dof> indices(element.n_dofs_per_cell());
  for (const auto& cell : dofs.active_cell_iterators()) {
    cell->get_dof_indices(indices);
    constraints.distribute_local_to_global(of_element(cell), indices, stiffness);
  }
}

PadModel::PadModel(const PlacedMesh& mesh, MirrorPlanes planes, double poisson_ratio)
    : implementation_(std::make_unique<Implementation>(mesh, planes)) {
  implementation_->assemble(poisson_ratio, mesh.curved);
}

PadModel::~PadModel() = default;

const std::vector<SurfaceNode>& PadModel::nodes() const { return implementation_->nodes; }
const std::vector<SurfaceFace>& PadModel::faces() const { return implementation_->faces; }
MirrorPlanes PadModel::planes() const { return implementation_->planes; }
long PadModel::unknowns() const { return implementation_->free_unknowns(Parity{}).count; }

FaceStiffness PadModel::face_stiffness(Parity parity) {
  auto& self = *implementation_;
  const Unknowns free = self.free_unknowns(parity);
  FaceStiffness result;
  result.parity = parity;
  std::vector<int> last;
  for (std::size_t i = 0; i < self.nodes.size(); ++i)
    for (int c = 0; c < dim; ++c) {
      const int unknown = free.of_dof[self.node_dofs[i][static_cast<std::size_t>(c)]];
      if (unknown < 0) continue;
      last.push_back(unknown);
      result.node.push_back(static_cast<int>(i));
      result.component.push_back(c);
    }
  SparseSymmetricMatrix matrix = self.lower_triangle(self.pattern, free);
  self.copy_entries(self.stiffness, free, matrix);
  if (self.dissection.empty()) self.dissect(matrix, free);
  const CholeskyFactor factor(matrix, self.dissection_of(free), last);
  result.stiffness = factor.stiffness_of_last();
  // The elements' z points out of the pad.
  for (std::size_t i = 0; i < last.size(); ++i) {
    if (result.component[i] != 2) continue;
    result.stiffness.row(static_cast<Eigen::Index>(i)) *= -1;
    result.stiffness.col(static_cast<Eigen::Index>(i)) *= -1;
  }
  return result;
}

}  // namespace softfinger::fem
