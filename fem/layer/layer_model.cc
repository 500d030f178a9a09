#include "fem/layer/layer_model.h"

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "fem/algebra/cholesky.h"
#include "fem/base/threads.h"
#include "fem/layer/element_stiffness.h"
#include "fem/layer/layer_solution.h"
#include "fem/layer/layer_space.h"
#include "fem/layer/mesh_in_metres.h"
#include "fem/layer/surface_frame.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

using dealii::types::global_dof_index;

struct LayerModel::Implementation : LayerSpace {
  using LayerSpace::LayerSpace;

  std::vector<ElasticConstants> sublayers;
  dealii::SparsityPattern pattern;
  dealii::SparseMatrix<double> stiffness;  ///< without the symmetries
  std::vector<Eigen::Matrix3d> frames;     ///< of a curved layer's surface nodes
  Unknowns even;                           ///< of the problem that pressing solves
  std::unique_ptr<CholeskyFactor> factor;  ///< none where it is condensed to all displacements
  Eigen::MatrixXd compliance;
  /// The compliance with the displacements of nodes that rub, 3 rows for each; empty where none
  /// does.
  Eigen::MatrixXd of_rubbing;
  std::vector<int> rubbing_row;  ///< per node, its first of them; -1: none
  /// The layer on the object, in units of its own thickness and modulus; null: the object is rigid.
  std::shared_ptr<const LayerModel> opposite;
  double opposite_compliance = 0;   ///< its unit of compliance, over this layer's
  std::vector<int> opposite_nodes;  ///< per node, the one at the same place

  void set_up(std::vector<ElasticConstants> of_sublayers, const Rubs& rubs);
  void set_frames();
  void factorise(const Rubs& rubs);
  void make_pattern();
  void assemble();
  SparseSymmetricMatrix lower_triangle_of(const Unknowns& free) const {
    SparseSymmetricMatrix result = lower_triangle(pattern, free);
    copy_entries(stiffness, free, result);
    return result;
  }
  /// A parity's problem with the unknowns of some nodes last: analysed, for `condense`.
  struct Condensation;
  Condensation analyse(Parity parity, const std::vector<int>& of_nodes) const;
};

namespace {

/// Turns the normals of 3 x 3 blocks round: the model's z points out of the layer.
void turn_normals(Eigen::MatrixXd& blocks) {
  const auto normals = Eigen::seq(2, Eigen::last, 3);
  blocks(normals, Eigen::all) *= -1;
  blocks(Eigen::all, normals) *= -1;
}

/// For each node the one of the other layer at the same place.
/// @param scale  of the other layer's unit of length
std::vector<int> nodes_at_same_places(const std::vector<SurfaceNode>& nodes,
                                      const std::vector<SurfaceNode>& others, double scale,
                                      double spacing) {
  constexpr double fine = 1e3;  // of a spacing: places differ by rounding alone
  const auto place = [&](double x, double y) {
    return std::pair(std::lround(fine * x / spacing), std::lround(fine * y / spacing));
  };
  std::map<std::pair<long, long>, int> at;
  for (std::size_t i = 0; i < others.size(); ++i)
    at[place(scale * others[i].x, scale * others[i].y)] = static_cast<int>(i);
  std::vector<int> result;
  for (const SurfaceNode& node : nodes) {
    const auto found = at.find(place(node.x, node.y));
    if (found == at.end())
      throw std::logic_error("the surface meshes of two layers in contact differ");
    result.push_back(found->second);
  }
  return result;
}

}  // namespace

void LayerModel::Implementation::make_pattern() {
  dealii::DynamicSparsityPattern dynamic(dofs.n_dofs());
  dealii::DoFTools::make_sparsity_pattern(dofs, dynamic, constraints, /*keep_constrained=*/false);
  pattern.copy_from(dynamic);
}

void LayerModel::Implementation::assemble() {
  stiffness.reinit(pattern);
  dealii::AffineConstraints<double> turned;
  if (!frames.empty()) turned = constraints_in(frames);
  const auto& of_unknowns = frames.empty() ? constraints : turned;
  // One for each sublayer. They cannot be moved.
  using Elements = std::deque<ElementStiffness>;
  Pool<Elements> elements([&] {
    auto result = std::make_unique<Elements>();
    for (const ElasticConstants& constants : sublayers)
      result->emplace_back(*mapping, element, constants.poisson_ratio, shape != nullptr);
    return result;
  });
  struct Entries {
    std::vector<global_dof_index> indices;
    dealii::FullMatrix<double> stiffness;
  };
  const auto find = [&](const auto& cell, Entries& entries) {
    entries.indices.resize(element.n_dofs_per_cell());
    cell->get_dof_indices(entries.indices);
    elements.with(
        [&](Elements& of_sublayer) { entries.stiffness = of_sublayer[cell->material_id()](cell); });
    entries.stiffness *= sublayers[cell->material_id()].youngs_ratio;
    if (!frames.empty()) turn_to_frames(frames, entries.indices, entries.stiffness);
  };
  const auto add = [&](const Entries& entries) {
    of_unknowns.distribute_local_to_global(entries.stiffness, entries.indices, stiffness);
  };
  if (!shape) {
    // Elements of one shape are integrated once, which takes no time.
    Entries entries;
    for (const auto& cell : dofs.active_cell_iterators()) {
      find(cell, entries);
      add(entries);
    }
    return;
  }
  constexpr int batch = 32;
  std::vector<dealii::DoFHandler<dim>::active_cell_iterator> cells;
  for (const auto& cell : dofs.active_cell_iterators()) cells.push_back(cell);
  std::vector<Entries> entries(2 * batch);
  const auto of = [&](int i) -> Entries& {
    return entries[static_cast<std::size_t>(i) % entries.size()];
  };
  in_order(
      static_cast<int>(cells.size()), batch,
      [&](int i) { find(cells[static_cast<std::size_t>(i)], of(i)); }, [&](int i) { add(of(i)); });
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
  if (implementation_->folded) throw implementation_->folded->refusal;
  implementation_->set_up(std::move(sublayers), rubs);
}

LayerModel::LayerModel(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}

Outcome<std::shared_ptr<const LayerModel>, FoldedLayer> LayerModel::made(
    const LayerDiscretisation& discretisation, std::vector<ElasticConstants> sublayers,
    std::shared_ptr<const LayerShape> shape, MirrorPlanes planes, const Rubs& rubs) {
  auto made = std::make_unique<Implementation>(discretisation, std::move(shape), planes);
  if (made->folded) return *made->folded;
  made->set_up(std::move(sublayers), rubs);
  return std::shared_ptr<const LayerModel>(new LayerModel(std::move(made)));
}

std::shared_ptr<const LayerModel> LayerModel::facing(const LayerDiscretisation& discretisation,
                                                     std::vector<ElasticConstants> sublayers,
                                                     const OppositeLayer& opposite) {
  auto result = std::make_shared<LayerModel>(discretisation, std::move(sublayers));
  result->add_opposite(opposite);
  return result;
}

void LayerModel::add_opposite(const OppositeLayer& opposite) {
  auto& self = *implementation_;
  LayerDiscretisation there = self.discretisation;
  there.a /= opposite.thickness;
  there.b /= opposite.thickness;
  there.interfaces.clear();
  // Nodes on the patch's edge belong to it in both units.
  constexpr double rounding = 1e-9;
  there.patch *= 1 + rounding;
  self.opposite = std::make_shared<const LayerModel>(there, opposite.constants.poisson_ratio);
  self.opposite_compliance = 1 / (opposite.constants.youngs_ratio * opposite.thickness);
  self.opposite_nodes =
      nodes_at_same_places(self.nodes, self.opposite->nodes(), opposite.thickness,
                           self.discretisation.b / self.discretisation.elements_along_b());
  std::vector<Eigen::Index> rows(self.opposite_nodes.begin(), self.opposite_nodes.end());
  self.compliance += self.opposite_compliance * self.opposite->compliance()(rows, rows);
}

void LayerModel::Implementation::set_up(std::vector<ElasticConstants> of_sublayers,
                                        const Rubs& rubs) {
  sublayers = std::move(of_sublayers);
  if (shape) set_frames();
  factorise(rubs);
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
  make_pattern();
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
  SparseSymmetricMatrix matrix = lower_triangle(pattern, even);
  // The order of elimination does not depend on the values of the entries.
  side_by_side(
      [&] {
        assemble();
        copy_entries(stiffness, even, matrix);
      },
      [&] {
        dissect(matrix, even);
        factor = CholeskyFactor::analysed(matrix, dissection_of(even), last);
      });
  // A quarter's other parities need it again. The larger ones rather need the memory.
  if (!planes.both()) {
    stiffness.clear();
    pattern.reinit(0, 0, 0);
  }
  factor->factorise(matrix);
  if (last.size() == nodes.size()) {
    compliance = factor->compliance_of_last();
    return;
  }
  // With its rows of all displacements it is the largest of what is held. Only files need it again.
  of_rubbing = std::move(*factor).compliance_of_last();
  factor.reset();
  compliance = of_rubbing(normals, normals);
}

/// A parity's problem, analysed with the unknowns of some nodes last.
struct LayerModel::Implementation::Condensation {
  SparseSymmetricMatrix matrix;
  std::unique_ptr<CholeskyFactor> factor;
  std::vector<Eigen::Index> place;  ///< of each of the last unknowns in the 3 x 3 blocks
};

auto LayerModel::Implementation::analyse(Parity parity, const std::vector<int>& of_nodes) const
    -> Condensation {
  const Unknowns free = free_unknowns(parity);
  Condensation result;
  std::vector<int> last;
  for (std::size_t i = 0; i < of_nodes.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const int unknown = free.of_dof[node_dofs[static_cast<std::size_t>(of_nodes[i])][c]];
      if (unknown < 0) continue;
      last.push_back(unknown);
      result.place.push_back(static_cast<Eigen::Index>(3 * i + c));
    }
  result.matrix = lower_triangle_of(free);
  result.factor = CholeskyFactor::analysed(result.matrix, dissection_of(free), last);
  return result;
}

std::vector<Eigen::MatrixXd> LayerModel::vector_compliances(const std::vector<Parity>& parities,
                                                            const std::vector<int>& nodes) const {
  auto& self = *implementation_;
  const auto rubbing_row = [&](int node) {
    return self.rubbing_row[static_cast<std::size_t>(node)];
  };
  // Then there are no mirror planes, and one parity.
  if (std::all_of(nodes.begin(), nodes.end(), [&](int node) { return rubbing_row(node) >= 0; })) {
    std::vector<Eigen::Index> rows;
    for (const int node : nodes)
      for (int c = 0; c < 3; ++c) rows.push_back(rubbing_row(node) + c);
    Eigen::MatrixXd compliance = self.of_rubbing(rows, rows);
    turn_normals(compliance);
    return {compliance};
  }
  if (self.stiffness.empty()) {
    self.make_pattern();
    self.assemble();
  }
  const auto size = static_cast<Eigen::Index>(3 * nodes.size());
  std::vector<Eigen::MatrixXd> compliances(parities.size());
  Implementation::Condensation next = self.analyse(parities.front(), nodes);
  // One factor at a time has room, beside the next one's analysis.
  for (std::size_t i = 0; i < parities.size(); ++i) {
    Implementation::Condensation present = std::exchange(next, {});
    side_by_side(
        [&] {
          present.factor->factorise(present.matrix);
          compliances[i] = Eigen::MatrixXd::Zero(size, size);
          compliances[i](present.place, present.place) =
              std::move(*present.factor).compliance_of_last();
          turn_normals(compliances[i]);
        },
        [&] {
          if (i + 1 < parities.size()) next = self.analyse(parities[i + 1], nodes);
        });
  }
  if (self.opposite) add_opposite_to(compliances, parities, nodes);
  return compliances;
}

void LayerModel::add_opposite_to(std::vector<Eigen::MatrixXd>& compliances,
                                 const std::vector<Parity>& parities,
                                 const std::vector<int>& nodes) const {
  const auto& self = *implementation_;
  std::vector<int> there;
  for (const int node : nodes) there.push_back(self.opposite_nodes[static_cast<std::size_t>(node)]);
  std::vector<Eigen::MatrixXd> others = self.opposite->vector_compliances(parities, there);
  for (std::size_t i = 0; i < others.size(); ++i) {
    turn_normals(others[i]);
    compliances[i] += self.opposite_compliance * others[i];
  }
}

Eigen::MatrixXd LayerModel::vector_compliance(Parity parity, const std::vector<int>& nodes) const {
  return vector_compliances({parity}, nodes).front();
}

LayerModel::~LayerModel() = default;

const LayerDiscretisation& LayerModel::discretisation() const {
  return implementation_->discretisation;
}
const std::vector<SurfaceNode>& LayerModel::nodes() const { return implementation_->nodes; }
const std::vector<SurfaceFace>& LayerModel::faces() const { return implementation_->faces; }
long LayerModel::unknowns() const {
  return implementation_->even.count +
         (implementation_->opposite ? implementation_->opposite->unknowns() : 0);
}
MirrorPlanes LayerModel::planes() const { return implementation_->planes; }
const Eigen::MatrixXd& LayerModel::compliance() const { return implementation_->compliance; }

void LayerModel::with_solution(const Eigen::VectorXd& force, double thickness_m,
                               double youngs_modulus_Pa,
                               const std::function<void(const LayerSolution&)>& use) const {
  auto& self = *implementation_;
  Eigen::VectorXd load = Eigen::VectorXd::Zero(self.even.count);
  for (std::size_t i = 0; i < self.nodes.size(); ++i)
    load[self.even.of_dof[self.node_dofs[i][2]]] = -force[static_cast<Eigen::Index>(i)];
  if (!self.factor) {
    self.make_pattern();
    self.assemble();
    self.factor = std::make_unique<CholeskyFactor>(
        self.lower_triangle_of(self.even), self.dissection_of(self.even), std::vector<int>());
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
  const MeshInMetres in_metres(self, thickness_m);
  use({self, self.sublayers, youngs_modulus_Pa, std::move(displacement_m), std::move(pressure_Pa)});
}

}  // namespace softfinger::fem
