#include "fem/finite/finite_layer.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "fem/base/threads.h"
#include "fem/finite/tangent_assembly.h"
#include "fem/layer/layer_space.h"
#include "fem/layer/mesh_in_metres.h"
#include "fem/output/write_fields.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {
namespace {

using Dof = LayerSpace::Dof;

/// The diagonal entry, which is the first of its column.
double& diagonal(SparseSymmetricMatrix& matrix, int unknown) {
  return matrix
      .value[static_cast<std::size_t>(matrix.column_begin[static_cast<std::size_t>(unknown)])];
}

/// Adds a spring that all but fixes the unknown. @returns its stiffness
double hold(SparseSymmetricMatrix& matrix, int unknown) {
  // Stiff enough to hold the node. When it is taken off again, two digits of the node's own
  // stiffness are lost.
  constexpr double spring_ratio = 100;
  double& entry = diagonal(matrix, unknown);
  const double spring = spring_ratio * std::abs(entry);
  entry += spring;
  return spring;
}

}  // namespace

struct FiniteLayer::State {
  dealii::Vector<double> displacement;
  std::vector<ElementState> elements;
};

struct FiniteLayer::Implementation : LayerSpace {
  using LayerSpace::LayerSpace;

  /// Place and size of a cell's linear functions 1, (X - center)/size.
  struct LinearFrame {
    Eigen::Vector3d center;
    double size;
  };
  std::vector<LinearFrame> frames_of_cells;
  std::vector<Eigen::Matrix3Xd> points_of_cells;  ///< quadrature points in the reference state

  std::vector<std::shared_ptr<const Material>> materials;  ///< of the sublayers
  std::vector<const Material*> material_of_cells;
  std::vector<ElementGeometry> geometries;      ///< per cell
  std::vector<std::vector<Dof>> dofs_of_cells;  ///< ordered by component
  Unknowns free;
  std::unique_ptr<TangentAssembly> tangent;  ///< of these; null before it is needed

  State state;
  // The latest linearisation:
  std::vector<NodeFrame> frames;
  std::vector<ElementBalance> balances;
  Eigen::VectorXd residual;  ///< of the free unknowns, in the frames, with the contact forces
  Eigen::Matrix3Xd borne;    ///< these forces: along the tangents and into the layer
  std::unique_ptr<CholeskyFactor> factor;
  std::vector<int> condensed;  ///< unknowns of the surface that the factor eliminates last
  /// Their rows among all components that the surface is condensed to: a mirror plane fixes some.
  std::vector<Eigen::Index> rows_of_condensed;
  Eigen::Index rows = 0;    ///< number of all those components
  Eigen::VectorXd springs;  ///< that hold the condensed unknowns in the factor; on normals only
  Eigen::MatrixXd held;     ///< stiffness of these with the springs, until it is asked for
  Eigen::VectorXd forward;  ///< half of the solution for the residual
  double shift = 0;
  // The latest step:
  State start;
  dealii::Vector<double> step;

  void set_up(std::vector<std::shared_ptr<const Material>> of_sublayers);
  void set_geometries();
  Eigen::MatrixXd gradients_of(const dealii::Vector<double>& field, std::size_t first,
                               std::size_t count) const;
  template <class Found, class Compute, class Add>
  void for_each_batch(const Compute& compute, const Add& add) const;
  template <class OfElement>
  std::vector<double> of_elements(const dealii::Vector<double>& field,
                                  const OfElement& of_element) const;
  double smallest_volume_ratio() const;
  TangentAssembly& tangent_of_free();
  double assemble(const std::vector<NodeFrame>& node_frames, const Eigen::Matrix3Xd& force,
                  TangentAssembly& assembly, Precision precision);
  void update_residual(const std::vector<NodeFrame>& node_frames, const Eigen::Matrix3Xd& force);
  void set_residual(dealii::Vector<double>& of_dofs);
  Precision precision() const;
  void factorise(Along along);
  Eigen::VectorXd surface_sign() const;
  Eigen::MatrixXd stiffness_of_surface(Eigen::MatrixXd by_springs) const;
  Eigen::VectorXd borne_by_condensed() const;
  dealii::Vector<double> solve(const Eigen::VectorXd& right_hand_side) const;
};

void FiniteLayer::Implementation::set_geometries() {
  const unsigned int nodes_of_cell = element.n_dofs_per_cell() / dim;
  const dealii::QGauss<dim> quadrature(3);
  dealii::FEValues<dim> values(*mapping, element, quadrature,
                               dealii::update_inverse_jacobians | dealii::update_JxW_values |
                                   dealii::update_quadrature_points);
  const auto points = static_cast<Eigen::Index>(quadrature.size());
  Eigen::MatrixXd unit_gradients(nodes_of_cell, 3 * points);
  for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i) {
    const auto [of_component, node] = element.system_to_component_index(i);
    if (of_component != 0) continue;
    for (unsigned int q = 0; q < quadrature.size(); ++q)
      for (unsigned int c = 0; c < dim; ++c)
        unit_gradients(node, 3 * q + c) =
            element.shape_grad_component(i, quadrature.point(q), of_component)[c];
  }
  const auto shared = std::make_shared<const Eigen::MatrixXd>(std::move(unit_gradients));
  for (const auto& cell : dofs.active_cell_iterators()) {
    values.reinit(cell);
    ElementGeometry geometry;
    geometry.unit_gradients = shared;
    geometry.to_unit.resize(3, 3 * points);
    geometry.weight.resize(points);
    geometry.linear.resize(4, points);
    const auto center = values.quadrature_point(quadrature.size() / 2);
    const double size = cell->diameter();
    frames_of_cells.push_back({{center[0], center[1], center[2]}, size});
    Eigen::Matrix3Xd& places = points_of_cells.emplace_back(3, points);
    for (unsigned int q = 0; q < quadrature.size(); ++q) {
      if (!(values.JxW(q) > 0))
        throw InputError(
            "mesh", "element", "of no or negative volume",
            "a layer that does not fold; is it too thick for the surface's curvature?");
      geometry.weight[q] = values.JxW(q);
      for (unsigned int c = 0; c < dim; ++c) places(c, q) = values.quadrature_point(q)[c];
      const auto offset = (values.quadrature_point(q) - center) / size;
      geometry.linear.col(q) << 1, offset[0], offset[1], offset[2];
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int c = 0; c < dim; ++c)
          geometry.to_unit(k, 3 * q + c) = values.inverse_jacobian(q)[k][c];
    }
    geometry.set_mass();
    geometries.push_back(std::move(geometry));
    std::vector<Dof> indices(element.n_dofs_per_cell());
    cell->get_dof_indices(indices);
    std::vector<Dof>& ordered = dofs_of_cells.emplace_back(indices.size());
    for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i) {
      const auto [of_component, node] = element.system_to_component_index(i);
      ordered[of_component * nodes_of_cell + node] = indices[i];
    }
  }
}

/// Gradients in the unit cell of a field of all degrees of freedom, of elements from one on, side
/// by side: products of large matrices.
Eigen::MatrixXd FiniteLayer::Implementation::gradients_of(const dealii::Vector<double>& field,
                                                          std::size_t first,
                                                          std::size_t count) const {
  const Eigen::MatrixXd& unit_gradients = *geometries[first].unit_gradients;
  Eigen::MatrixXd of_nodes(unit_gradients.rows(), static_cast<Eigen::Index>(3 * count));
  double* value = of_nodes.data();
  for (std::size_t cell = first; cell < first + count; ++cell)
    for (const Dof dof : dofs_of_cells[cell]) *value++ = field[dof];
  return unit_gradients.transpose() * of_nodes;
}

/// Batches of elements, which stay in the cache.
/// @param compute  called with the first element of a batch, their number, and a place for what is
///                 found, which is the batch's own until it is added; several at a time
/// @param add      called with the first element and that place, in the order of the elements
template <class Found, class Compute, class Add>
void FiniteLayer::Implementation::for_each_batch(const Compute& compute, const Add& add) const {
  constexpr std::size_t most = 8;
  constexpr int at_a_time = 4;
  std::vector<Found> found(2 * at_a_time);
  const auto place = [&](int batch) -> Found& {
    return found[static_cast<std::size_t>(batch) % found.size()];
  };
  const auto first = [](int batch) { return most * static_cast<std::size_t>(batch); };
  in_order(
      static_cast<int>((geometries.size() + most - 1) / most), at_a_time,
      [&](int batch) {
        compute(first(batch), std::min(most, geometries.size() - first(batch)), place(batch));
      },
      [&](int batch) { add(first(batch), place(batch)); });
}

/// @param of_element  of each element and the field's gradient in it; several at a time
/// @returns in the order of the elements
template <class OfElement>
std::vector<double> FiniteLayer::Implementation::of_elements(const dealii::Vector<double>& field,
                                                             const OfElement& of_element) const {
  std::vector<double> result;
  for_each_batch<std::vector<double>>(
      [&](std::size_t first, std::size_t count, std::vector<double>& found) {
        const Eigen::MatrixXd gradients = gradients_of(field, first, count);
        found.clear();
        for (std::size_t k = 0; k < count; ++k)
          found.push_back(
              of_element(first + k, gradients.middleCols<3>(3 * static_cast<Eigen::Index>(k))));
      },
      [&](std::size_t, const std::vector<double>& found) {
        result.insert(result.end(), found.begin(), found.end());
      });
  return result;
}

namespace {

/// The smallest of the volume ratios, at most 1, which an undeformed element has.
double smallest_of(const std::vector<double>& ratios) {
  double smallest = 1;
  for (const double ratio : ratios) smallest = std::min(smallest, ratio);
  return smallest;
}

}  // namespace

double FiniteLayer::Implementation::smallest_volume_ratio() const {
  return smallest_of(
      of_elements(state.displacement, [&](std::size_t cell, const UnitGradient& displacement) {
        return finite::smallest_volume_ratio(geometries[cell], state.elements[cell], displacement);
      }));
}

FiniteLayer::FiniteLayer(const LayerDiscretisation& discretisation,
                         std::shared_ptr<const LayerShape> shape, MirrorPlanes planes,
                         std::vector<std::shared_ptr<const Material>> materials)
    : implementation_(std::make_unique<Implementation>(discretisation, std::move(shape), planes)) {
  if (implementation_->folded) throw implementation_->folded->refusal;
  implementation_->set_up(std::move(materials));
}

FiniteLayer::FiniteLayer(std::unique_ptr<Implementation> implementation)
    : implementation_(std::move(implementation)) {}

Outcome<std::shared_ptr<FiniteLayer>, FoldedLayer> FiniteLayer::made(
    const LayerDiscretisation& discretisation, std::shared_ptr<const LayerShape> shape,
    MirrorPlanes planes, std::vector<std::shared_ptr<const Material>> materials) {
  auto made = std::make_unique<Implementation>(discretisation, std::move(shape), planes);
  if (made->folded) return *made->folded;
  made->set_up(std::move(materials));
  return std::shared_ptr<FiniteLayer>(new FiniteLayer(std::move(made)));
}

FiniteLayer::FiniteLayer(const LayerDiscretisation& discretisation, const meshes::LayerMesh& mesh,
                         double thickness_m, std::vector<std::shared_ptr<const Material>> materials)
    : implementation_(std::make_unique<Implementation>(discretisation, mesh, thickness_m)) {
  implementation_->set_up(std::move(materials));
}

void FiniteLayer::Implementation::set_up(
    std::vector<std::shared_ptr<const Material>> of_sublayers) {
  materials = std::move(of_sublayers);
  set_geometries();
  for (const auto& cell : dofs.active_cell_iterators())
    material_of_cells.push_back(materials[cell->material_id()].get());
  free = free_unknowns(Parity{});
  state.displacement.reinit(dofs.n_dofs());
  state.elements.resize(geometries.size());
}

FiniteLayer::~FiniteLayer() = default;

const LayerDiscretisation& FiniteLayer::discretisation() const {
  return implementation_->discretisation;
}
const std::vector<SurfaceNode>& FiniteLayer::nodes() const { return implementation_->nodes; }
const std::vector<SurfaceFace>& FiniteLayer::faces() const { return implementation_->faces; }
long FiniteLayer::unknowns() const { return implementation_->free.count; }
MirrorPlanes FiniteLayer::planes() const { return implementation_->planes; }
bool FiniteLayer::has_grid() const { return !implementation_->meshed; }
std::size_t FiniteLayer::sublayers() const { return implementation_->materials.size(); }
double FiniteLayer::shift() const { return implementation_->shift; }

Eigen::Vector3d FiniteLayer::position(std::size_t node) const {
  const auto& self = *implementation_;
  Eigen::Vector3d result = self.nodes[node].position;
  for (std::size_t c = 0; c < 3; ++c)
    result[static_cast<Eigen::Index>(c)] += self.state.displacement[self.node_dofs[node][c]];
  return result;
}

std::array<Eigen::Vector3d, 9> FiniteLayer::face_positions(std::size_t face) const {
  const auto& self = *implementation_;
  std::array<Eigen::Vector3d, 9> result;
  for (std::size_t k = 0; k < 9; ++k) {
    result[k] = self.face_places[face][k];
    for (std::size_t c = 0; c < 3; ++c) {
      const Dof dof = self.face_dofs[face][k][c];
      result[k][static_cast<Eigen::Index>(c)] +=
          self.state.displacement[dof] + (self.shape ? self.bending[dof] : 0);
    }
  }
  return result;
}

std::vector<std::pair<int, double>> FiniteLayer::node_shares(std::size_t face,
                                                             std::size_t place) const {
  return implementation_->node_shares(face, place);
}

double FiniteLayer::smallest_volume_ratio() const {
  return implementation_->smallest_volume_ratio();
}

double FiniteLayer::strain_energy() const {
  const auto& self = *implementation_;
  const std::vector<double> energies = self.of_elements(
      self.state.displacement, [&](std::size_t cell, const UnitGradient& displacement) {
        return finite::strain_energy(self.geometries[cell], *self.material_of_cells[cell],
                                     self.state.elements[cell], displacement);
      });
  return std::accumulate(energies.begin(), energies.end(), 0.0);
}

namespace {

/// Forces along the frames' axes of which only the normal ones are given, into the layer.
Eigen::Matrix3Xd along_normals(const Eigen::VectorXd& force) {
  Eigen::Matrix3Xd result = Eigen::Matrix3Xd::Zero(3, force.size());
  result.row(2) = force.transpose();
  return result;
}

}  // namespace

double FiniteLayer::linearise(const std::vector<NodeFrame>& frames, const Eigen::VectorXd& force) {
  return linearise(frames, along_normals(force), Along::normals);
}

double FiniteLayer::linearise(const std::vector<NodeFrame>& frames, const Eigen::Matrix3Xd& force,
                              Along along) {
  const double out_of_balance = implementation_->assemble(
      frames, force, implementation_->tangent_of_free(), implementation_->precision());
  implementation_->factorise(along);
  implementation_->forward = implementation_->factor->forward(-implementation_->residual);
  return out_of_balance;
}

double FiniteLayer::update_residual(const std::vector<NodeFrame>& frames,
                                    const Eigen::VectorXd& force) {
  return update_residual(frames, along_normals(force));
}

double FiniteLayer::update_residual(const std::vector<NodeFrame>& frames,
                                    const Eigen::Matrix3Xd& force) {
  implementation_->update_residual(frames, force);
  implementation_->forward = implementation_->factor->forward(-implementation_->residual);
  return implementation_->residual.lpNorm<Eigen::Infinity>();
}

/// Tangent and residual. @returns the largest nodal force out of balance
double FiniteLayer::Implementation::assemble(const std::vector<NodeFrame>& node_frames,
                                             const Eigen::Matrix3Xd& force,
                                             TangentAssembly& assembly, Precision of_stiffness) {
  frames = node_frames;
  borne = force;
  balances.resize(geometries.size());
  dealii::Vector<double> residual_of_dofs(dofs.n_dofs()), internal(dofs.n_dofs());
  std::vector<Eigen::Matrix3d> axes;
  for (const NodeFrame& frame : frames) axes.push_back(frame.axes);
  assembly.start(axes);
  using Linearisations = std::vector<ElementLinearisation>;
  for_each_batch<Linearisations>(
      [&](std::size_t first, std::size_t count, Linearisations& found) {
        const Eigen::MatrixXd gradients = gradients_of(state.displacement, first, count);
        found.clear();
        for (std::size_t k = 0; k < count; ++k)
          found.push_back(finite::linearise(
              geometries[first + k], *material_of_cells[first + k], state.elements[first + k],
              gradients.middleCols<3>(3 * static_cast<Eigen::Index>(k)), of_stiffness));
      },
      [&](std::size_t first, Linearisations& found) {
        for (std::size_t k = 0; k < found.size(); ++k) {
          const std::vector<Dof>& indices = dofs_of_cells[first + k];
          for (std::size_t i = 0; i < indices.size(); ++i) {
            residual_of_dofs[indices[i]] += found[k].residual[static_cast<Eigen::Index>(i)];
            internal[indices[i]] += found[k].force[static_cast<Eigen::Index>(i)];
          }
          assembly.add(first + k, std::move(found[k].stiffness));
          balances[first + k] = std::move(found[k]);
        }
      });
  constraints.condense(internal);
  set_residual(residual_of_dofs);

  double out_of_balance = 0;
  std::vector<char> is_surface(dofs.n_dofs(), 0);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto& dof = node_dofs[i];
    Eigen::Vector3d turned;
    for (std::size_t c = 0; c < 3; ++c) {
      turned[static_cast<Eigen::Index>(c)] = internal[dof[c]];
      is_surface[dof[c]] = 1;
    }
    turned = axes[i].transpose() * turned;
    const auto on_node = force.col(static_cast<Eigen::Index>(i));
    turned += Eigen::Vector3d(-on_node.x(), -on_node.y(), on_node.z());
    Eigen::Matrix3d stiffness_of_curvature = Eigen::Matrix3d::Zero();
    stiffness_of_curvature.topLeftCorner<2, 2>() = -frames[i].curvature_force;
    stiffness_of_curvature = axes[i].transpose() * stiffness_of_curvature * axes[i];
    for (std::size_t c = 0; c < 3; ++c) {
      const auto row = static_cast<Eigen::Index>(c);
      if (free.of_dof[dof[c]] >= 0)
        out_of_balance = std::max(out_of_balance, std::abs(turned[row]));
    }
    assembly.add(dof, stiffness_of_curvature);
  }
  for (Dof i = 0; i < dofs.n_dofs(); ++i)
    if (free.of_dof[i] >= 0 && !is_surface[i])
      out_of_balance = std::max(out_of_balance, std::abs(internal[i]));
  return out_of_balance;
}

TangentAssembly& FiniteLayer::Implementation::tangent_of_free() {
  if (!tangent) tangent = std::make_unique<TangentAssembly>(*this, dofs_of_cells, free);
  return *tangent;
}

void FiniteLayer::Implementation::update_residual(const std::vector<NodeFrame>& node_frames,
                                                  const Eigen::Matrix3Xd& force) {
  frames = node_frames;
  borne = force;
  dealii::Vector<double> residual_of_dofs(dofs.n_dofs());
  for_each_batch<Eigen::MatrixXd>(
      [&](std::size_t first, std::size_t count, Eigen::MatrixXd& forces) {
        const Eigen::MatrixXd gradients = gradients_of(state.displacement, first, count);
        Eigen::MatrixXd stresses(gradients.rows(), gradients.cols());
        for (std::size_t k = 0; k < count; ++k) {
          const auto own = 3 * static_cast<Eigen::Index>(k);
          balances[first + k] = balance(geometries[first + k], *material_of_cells[first + k],
                                        state.elements[first + k], gradients.middleCols<3>(own),
                                        stresses.middleCols<3>(own));
        }
        forces.noalias() = *geometries[first].unit_gradients * stresses;
      },
      [&](std::size_t first, const Eigen::MatrixXd& forces) {
        const double* entry = forces.data();
        for (std::size_t cell = first; entry < forces.data() + forces.size(); ++cell)
          for (const Dof dof : dofs_of_cells[cell]) residual_of_dofs[dof] += *entry++;
      });
  set_residual(residual_of_dofs);
}

/// The residual of the free unknowns, those of surface nodes along their frames, with what hangs on
/// them. It vanishes in equilibrium: a step in single precision is off by a share of what is left,
/// not by one of the pressure.
void FiniteLayer::Implementation::set_residual(dealii::Vector<double>& of_dofs) {
  constraints.condense(of_dofs);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto& dof = node_dofs[i];
    const Eigen::Vector3d turned =
        frames[i].axes.transpose() *
            Eigen::Vector3d(of_dofs[dof[0]], of_dofs[dof[1]], of_dofs[dof[2]]) +
        Eigen::Vector3d(-1, -1, 1).cwiseProduct(borne.col(static_cast<Eigen::Index>(i)));
    for (std::size_t c = 0; c < 3; ++c) of_dofs[dof[c]] = turned[static_cast<Eigen::Index>(c)];
  }
  residual.resize(free.count);
  for (Dof i = 0; i < dofs.n_dofs(); ++i)
    if (free.of_dof[i] >= 0) residual[free.of_dof[i]] = of_dofs[i];
}

/// Newton's steps, whose residual is exact, and how a pressed surface resists small motions may be
/// found in single precision where that is enough: the matrix's condition number grows with the
/// largest bulk modulus over the smallest shear modulus of the layer. Up to 500 of it no iteration
/// more was needed, and the wrenches of superposed motions changed by less than 3e-5 of the
/// largest.
Precision FiniteLayer::Implementation::precision() const {
  constexpr double largest_ratio = 500;
  const Deformation none(Eigen::Matrix3d::Identity());
  double bulk = 0, shear = std::numeric_limits<double>::infinity();
  for (const auto& material : materials) {
    bulk = std::max(bulk, material->respond_to_volume(1).modulus);
    shear = std::min(shear, material->respond(none).tangent(1, 1));  // by dF_yx twice
  }
  return bulk <= largest_ratio * shear ? Precision::single : Precision::full;
}

/// Springs hold the surface nodes while the matrix is factorised; `surface_response` takes them off
/// again. Without them the matrix is indefinite under a pressure of the order of the shear modulus:
/// the surface is unstable under constant forces, though not under a rigid object that holds it.
/// With springs the matrix may still be indefinite, far from equilibrium or at a bifurcation. Then
/// a share of its diagonal is added, which shortens the step along the unstable directions.
void FiniteLayer::Implementation::factorise(Along along) {
  SparseSymmetricMatrix& matrix = tangent_of_free().matrix();
  if (dissection.empty()) dissect(matrix, free);
  const std::vector<int> ordering = dissection_of(free);
  std::vector<int> last;
  rows_of_condensed.clear();
  rows = 0;
  std::vector<double> held_by;
  for (const auto& dofs_of_node : node_dofs)
    for (std::size_t c = along == Along::normals ? 2 : 0; c < 3; ++c, ++rows) {
      const int unknown = free.of_dof[dofs_of_node[c]];
      if (unknown < 0) continue;
      last.push_back(unknown);
      rows_of_condensed.push_back(rows);
      held_by.push_back(c == 2 ? hold(matrix, unknown) : 0);
    }
  if (last != condensed) factor.reset();  // before the next one takes its memory
  condensed = std::move(last);
  springs =
      Eigen::Map<const Eigen::VectorXd>(held_by.data(), static_cast<Eigen::Index>(held_by.size()));
  // Friction rather goes from another start or in shorter steps.
  const double first_shift = 1e-3, largest_shift = along == Along::all ? 0 : 1;
  shift = 0;
  for (;;) {
    try {
      if (factor)
        factor->factorise(matrix);
      else
        factor = std::make_unique<CholeskyFactor>(matrix, ordering, condensed, precision());
      break;
    } catch (const ConvergenceError&) {
      const double next = shift == 0 ? first_shift : 10 * shift;
      if (next > largest_shift) {
        factor.reset();
        throw;
      }
      for (int unknown = 0; unknown < matrix.size; ++unknown)
        diagonal(matrix, unknown) +=
            (next - shift) * std::abs(diagonal(matrix, unknown)) / (1 + shift);
      shift = next;
    }
  }
  held = factor->stiffness_of_last();
}

/// Displacements and forces of the surface count along the tangents and into the layer, against the
/// frames' normals.
Eigen::VectorXd FiniteLayer::Implementation::surface_sign() const {
  Eigen::VectorXd result = Eigen::VectorXd::Ones(springs.size());
  for (Eigen::Index row = 0; row < springs.size(); ++row)
    if (springs[row] > 0) result[row] = -1;
  return result;
}

Eigen::VectorXd FiniteLayer::Implementation::borne_by_condensed() const {
  if (rows == borne.cols()) return borne.row(2).transpose()(rows_of_condensed);
  return borne.reshaped()(rows_of_condensed);
}

Eigen::VectorXd FiniteLayer::surface_force() const {
  const auto& self = *implementation_;
  Eigen::VectorXd result = Eigen::VectorXd::Zero(self.rows);
  result(self.rows_of_condensed) =
      self.surface_sign().cwiseProduct(self.factor->force_on_last(self.forward)) -
      self.borne_by_condensed();
  return result;
}

SurfaceResponse FiniteLayer::surface_response() const {
  return {implementation_->stiffness_of_surface(implementation_->held), surface_force()};
}

Eigen::MatrixXd FiniteLayer::take_surface_stiffness() {
  return implementation_->stiffness_of_surface(std::move(implementation_->held));
}

Eigen::MatrixXd FiniteLayer::Implementation::stiffness_of_surface(
    Eigen::MatrixXd by_springs) const {
  const Eigen::VectorXd sign = surface_sign();
  by_springs.array().colwise() *= sign.array();
  by_springs.array().rowwise() *= sign.transpose().array();
  by_springs.diagonal() -= springs;
  if (springs.size() == rows) return by_springs;
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows, rows);
  all(rows_of_condensed, rows_of_condensed) = by_springs;
  return all;
}

Eigen::MatrixXd FiniteLayer::superposed_stiffness(const std::vector<NodeFrame>& frames,
                                                  const Eigen::VectorXd& force, Parity parity,
                                                  const std::vector<int>& nodes) {
  auto& self = *implementation_;
  self.factor.reset();  // before the next one takes its memory
  // A whole layer has the same unknowns whatever the parity.
  std::unique_ptr<TangentAssembly> own;
  if (self.planes.any())
    own = std::make_unique<TangentAssembly>(self, self.dofs_of_cells, self.free_unknowns(parity));
  TangentAssembly& assembly = own ? *own : self.tangent_of_free();
  const Unknowns& unknowns = assembly.unknowns();
  // Nothing corrects what rounding does to these stiffnesses, 3e-5 of them in single precision: it
  // is taken where doubles would need hundreds of megabytes.
  constexpr int large = 30000;
  const Precision precision = unknowns.count < large ? Precision::full : self.precision();
  self.assemble(frames, along_normals(force), assembly, precision);
  SparseSymmetricMatrix& matrix = assembly.matrix();
  if (self.dissection.empty()) self.dissect(matrix, unknowns);
  std::vector<int> last;
  std::vector<Eigen::Index> place;  // of each in the 3 x 3 blocks
  std::vector<double> springs;
  for (std::size_t i = 0; i < nodes.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const int unknown = unknowns.of_dof[self.node_dofs[static_cast<std::size_t>(nodes[i])][c]];
      if (unknown < 0) continue;
      last.push_back(unknown);
      place.push_back(static_cast<Eigen::Index>(3 * i + c));
      // The object holds the normals: without it the pressed surface would be unstable.
      springs.push_back(c == 2 ? hold(matrix, unknown) : 0);
    }
  Eigen::MatrixXd held =
      CholeskyFactor(matrix, self.dissection_of(unknowns), last, precision).stiffness_of_last();
  held.diagonal() -= Eigen::Map<const Eigen::VectorXd>(springs.data(), held.rows());
  const auto size = static_cast<Eigen::Index>(3 * nodes.size());
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(size, size);
  stiffness(place, place) = held;
  return stiffness;
}

double FiniteLayer::find_step(const Eigen::VectorXd& force, const Eigen::VectorXd& displacement) {
  auto& self = *implementation_;
  const Eigen::VectorXd sign = self.surface_sign();
  Eigen::VectorXd forward = self.forward;
  self.factor->add_to_last(
      sign.cwiseProduct(force(self.rows_of_condensed) - self.borne_by_condensed() +
                        self.springs.cwiseProduct(displacement(self.rows_of_condensed))),
      forward);
  const Eigen::VectorXd solution = self.factor->backward(forward);
  self.step.reinit(self.dofs.n_dofs());
  for (Dof i = 0; i < self.dofs.n_dofs(); ++i)
    if (self.free.of_dof[i] >= 0) self.step[i] = solution[self.free.of_dof[i]];
  for (std::size_t i = 0; i < self.nodes.size(); ++i) {
    const auto& dof = self.node_dofs[i];
    const Eigen::Vector3d turned =
        self.frames[i].axes *
        Eigen::Vector3d(self.step[dof[0]], self.step[dof[1]], self.step[dof[2]]);
    for (std::size_t c = 0; c < 3; ++c) self.step[dof[c]] = turned[static_cast<Eigen::Index>(c)];
  }
  self.constraints.distribute(self.step);
  self.start = self.state;
  return self.step.linfty_norm();
}

double FiniteLayer::take_step(double fraction) {
  auto& self = *implementation_;
  self.state.displacement = self.start.displacement;
  self.state.displacement.add(fraction, self.step);
  return smallest_of(self.of_elements(self.step, [&](std::size_t cell, const UnitGradient& step) {
    const ElementAdvance advanced = advance(self.geometries[cell], self.balances[cell],
                                            self.start.elements[cell], step, fraction);
    self.state.elements[cell] = advanced.state;
    return advanced.smallest_volume_ratio;
  }));
}

namespace {

/// Finds the cell of a block's mesh that holds a point, by a lattice of columns.
class CellFinder {
 public:
  using Cell = dealii::DoFHandler<dim>::active_cell_iterator;

  explicit CellFinder(const dealii::DoFHandler<dim>& dofs) {
    for (const auto& cell : dofs.active_cell_iterators()) {
      const auto box = cell->bounding_box();
      const auto &low = box.get_boundary_points().first, &high = box.get_boundary_points().second;
      for (int i = column(low[0]); i <= column(high[0]); ++i)
        for (int j = column(low[1]); j <= column(high[1]); ++j)
          columns_[{i, j}].push_back({cell, low, high});
    }
  }

  /// The side of the box that the cell is in the block.
  static dealii::Tensor<1, dim> side_of(const Cell& cell, unsigned int direction) {
    return cell->vertex(1u << direction) - cell->vertex(0);
  }
  static dealii::Point<dim> point_of(const Cell& cell, const dealii::Point<dim>& unit) {
    dealii::Point<dim> at = cell->vertex(0);
    for (unsigned int c = 0; c < dim; ++c) at += unit[c] * side_of(cell, c);
    return at;
  }

  struct Place {
    Cell cell;
    dealii::Point<dim> unit;  ///< in the cell's own coordinates
  };
  /// None where no cell is within a thousandth of the thickness.
  std::optional<Place> find(const dealii::Point<dim>& at) const {
    const auto found = columns_.find({column(at[0]), column(at[1])});
    if (found == columns_.end()) return std::nullopt;
    for (const Entry& entry : found->second) {
      Place place{entry.cell, {}};
      bool inside = true;
      for (unsigned int c = 0; c < dim; ++c) {
        constexpr double near = 1e-3;
        inside = inside && at[c] > entry.low[c] - near && at[c] < entry.high[c] + near;
      }
      if (!inside) continue;
      // A cell's own axes are the block's in any order.
      for (unsigned int c = 0; c < dim; ++c) {
        const auto side = side_of(entry.cell, c);
        place.unit[c] =
            std::clamp((at - entry.cell->vertex(0)) * side / side.norm_square(), 0.0, 1.0);
      }
      return place;
    }
    return std::nullopt;
  }

 private:
  struct Entry {
    Cell cell;
    dealii::Point<dim> low, high;
  };
  static int column(double x) { return static_cast<int>(std::floor(2 * x)); }
  std::map<std::pair<int, int>, std::vector<Entry>> columns_;
};

}  // namespace

void FiniteLayer::release_factor() {
  implementation_->factor.reset();
  implementation_->tangent.reset();
  implementation_->held = {};
}

void FiniteLayer::continue_from(const FiniteLayer& other) {
  auto& self = *implementation_;
  const auto& from = *other.implementation_;
  const CellFinder finder(from.dofs);
  // The other layer may mesh a single image of this one: its fields are even about the mirror
  // planes, and a displacement across a plane is odd.
  const std::array<bool, dim> folds{from.planes.x && !self.planes.x,
                                    from.planes.y && !self.planes.y, false};
  const auto folded = [&](dealii::Point<dim> at) {
    for (unsigned int c = 0; c < dim; ++c)
      if (folds[c]) at[c] = std::abs(at[c]);
    return at;
  };
  const unsigned int count = self.element.n_dofs_per_cell();
  std::vector<Dof> indices(count), their_indices(count);
  std::vector<char> is_done(self.dofs.n_dofs(), 0);
  for (const auto& cell : self.dofs.active_cell_iterators()) {
    cell->get_dof_indices(indices);
    const auto place = [&](const dealii::Point<dim>& unit) {
      return finder.find(folded(CellFinder::point_of(cell, unit)));
    };
    for (unsigned int i = 0; i < count; ++i) {
      if (is_done[indices[i]]) continue;
      is_done[indices[i]] = 1;
      const auto found = place(self.element.unit_support_point(i));
      if (!found) continue;
      found->cell->get_dof_indices(their_indices);
      double value = 0;
      for (unsigned int k = 0; k < count; ++k)
        if (self.element.system_to_component_index(k).first ==
            static_cast<unsigned int>(self.component[indices[i]]))
          value +=
              from.state.displacement[their_indices[k]] * from.element.shape_value(k, found->unit);
      const auto of_component = static_cast<unsigned int>(self.component[indices[i]]);
      const bool is_mirrored =
          folds[of_component] &&
          CellFinder::point_of(cell, self.element.unit_support_point(i))[of_component] < 0;
      self.state.displacement[indices[i]] = is_mirrored ? -value : value;
    }
    const auto middle = place(dealii::Point<dim>(0.5, 0.5, 0.5));
    if (!middle) continue;
    const std::size_t here = cell->active_cell_index(), there = middle->cell->active_cell_index();
    const auto& frame = from.frames_of_cells[there];
    const ElementGeometry& geometry = self.geometries[here];
    Eigen::Matrix4Xd their_linear(4, geometry.weight.size());
    their_linear.row(0).setOnes();
    Eigen::Matrix3Xd points = self.points_of_cells[here];
    for (Eigen::Index c = 0; c < dim; ++c)
      if (folds[static_cast<std::size_t>(c)]) points.row(c) = points.row(c).cwiseAbs();
    their_linear.bottomRows<3>() = (points.colwise() - frame.center) / frame.size;
    // The other cell's linear fields, in this one's functions.
    const Eigen::Matrix4d change = geometry.mass.ldlt().solve(
        geometry.linear * geometry.weight.asDiagonal() * their_linear.transpose());
    self.state.elements[here].pressure = change * from.state.elements[there].pressure;
    self.state.elements[here].volume_ratio = change * from.state.elements[there].volume_ratio;
  }
  self.constraints.distribute(self.state.displacement);
}

void FiniteLayer::write_vtu(const std::string& path, const Eigen::VectorXd& pressure,
                            double thickness_m, double youngs_modulus_Pa) const {
  auto& self = *implementation_;
  dealii::Vector<double> displacement_m(self.state.displacement), pressure_Pa(self.dofs.n_dofs());
  displacement_m *= thickness_m;
  for (std::size_t i = 0; i < self.nodes.size(); ++i)
    pressure_Pa[self.node_dofs[i][2]] = youngs_modulus_Pa * pressure[static_cast<Eigen::Index>(i)];
  dealii::Vector<double> volume_ratio(self.triangulation.n_active_cells());
  for (std::size_t i = 0; i < self.geometries.size(); ++i)
    volume_ratio[static_cast<unsigned int>(i)] =
        (self.geometries[i].linear.transpose() * self.state.elements[i].volume_ratio)
            .dot(self.geometries[i].weight) /
        self.geometries[i].weight.sum();
  const MeshInMetres in_metres(self, thickness_m);
  write_fields(path, {self, displacement_m, pressure_Pa, nullptr, "volume_ratio", volume_ratio});
}

std::shared_ptr<const FiniteLayer::State> FiniteLayer::state() const {
  return std::make_shared<const State>(implementation_->state);
}

void FiniteLayer::restore(const State& state) { implementation_->state = state; }

void FiniteLayer::restore(const std::vector<std::shared_ptr<const State>>& states,
                          const Eigen::VectorXd& weights) {
  State& own = implementation_->state;
  own.displacement = 0;
  for (ElementState& element : own.elements)
    element.pressure = element.volume_ratio = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < states.size(); ++i) {
    const double weight = weights[static_cast<Eigen::Index>(i)];
    own.displacement.add(weight, states[i]->displacement);
    for (std::size_t e = 0; e < own.elements.size(); ++e) {
      own.elements[e].pressure += weight * states[i]->elements[e].pressure;
      own.elements[e].volume_ratio += weight * states[i]->elements[e].volume_ratio;
    }
  }
}

Eigen::VectorXd FiniteLayer::displacements() const {
  const dealii::Vector<double>& all = implementation_->state.displacement;
  return Eigen::Map<const Eigen::VectorXd>(all.begin(), static_cast<Eigen::Index>(all.size()));
}

}  // namespace softfinger::fem::finite
