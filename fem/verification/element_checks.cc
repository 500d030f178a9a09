// The element alone: deal.II's mesh and solution of a body, the stiffness of `ElementStiffness`,
// the factorisation of `CholeskyFactor`.
#include <deal.II/base/function.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q1.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/tria.h>
#include <deal.II/lac/affine_constraints.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/sparse_matrix.h>
#include <deal.II/lac/vector.h>
#include <deal.II/numerics/vector_tools.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>

#include "fem/algebra/cholesky.h"
#include "fem/layer/element_stiffness.h"
#include "fem/verification/groups.h"
#include "softfinger/input/constants.h"

namespace softfinger::fem::verification {
namespace {

constexpr int dim = 3;
const char* const element_group = "element";

using Point = dealii::Point<dim>;
using Field = std::function<double(const Point&, unsigned int component)>;

std::string named_element(const char* text, double nu) {
  char buffer[80];
  std::snprintf(buffer, sizeof buffer, "%s, nu %.5g", text, nu);
  return buffer;
}

class VectorField : public dealii::Function<dim> {
 public:
  explicit VectorField(Field value) : dealii::Function<dim>(dim), value_(std::move(value)) {}
  double value(const Point& point, unsigned int component) const override {
    return value_(point, component);
  }

 private:
  const Field value_;
};

/// A body of Q2 elements with E = 1.
struct Body {
  dealii::Triangulation<dim> triangulation;
  dealii::FESystem<dim> element{dealii::FE_Q<dim>(2), dim};
  dealii::DoFHandler<dim> dofs{triangulation};
  dealii::MappingQ1<dim> mapping;
  double poisson_ratio = 0;

  /// Displacements under a body force with prescribed values on the boundary.
  dealii::Vector<double> solve(const Field& boundary, const Field& body_force);
};

dealii::Vector<double> Body::solve(const Field& boundary, const Field& body_force) {
  dofs.distribute_dofs(element);
  dealii::AffineConstraints<double> constraints;
  dealii::DoFTools::make_hanging_node_constraints(dofs, constraints);
  dealii::VectorTools::interpolate_boundary_values(mapping, dofs, 0, VectorField(boundary),
                                                   constraints);
  constraints.close();
  dealii::DynamicSparsityPattern dynamic(dofs.n_dofs());
  dealii::DoFTools::make_sparsity_pattern(dofs, dynamic, constraints, true);
  dealii::SparsityPattern pattern;
  pattern.copy_from(dynamic);
  dealii::SparseMatrix<double> stiffness(pattern);
  dealii::Vector<double> load(dofs.n_dofs());
  ElementStiffness of_cell(mapping, element, poisson_ratio, /*bent=*/true);
  dealii::FEValues<dim> values(
      mapping, element, dealii::QGauss<dim>(5),
      dealii::update_values | dealii::update_JxW_values | dealii::update_quadrature_points);
  dealii::Vector<double> of_element(element.n_dofs_per_cell());
  std::vector<dealii::types::global_dof_index> indices(element.n_dofs_per_cell());
  for (const auto& cell : dofs.active_cell_iterators()) {
    cell->get_dof_indices(indices);
    values.reinit(cell);
    of_element = 0;
    for (unsigned int q = 0; q < values.n_quadrature_points; ++q)
      for (unsigned int i = 0; i < indices.size(); ++i)
        of_element[i] +=
            values.shape_value(i, q) * values.JxW(q) *
            body_force(values.quadrature_point(q), element.system_to_component_index(i).first);
    constraints.distribute_local_to_global(of_cell(cell), of_element, indices, stiffness, load);
  }
  SparseSymmetricMatrix lower;
  lower.size = static_cast<int>(dofs.n_dofs());
  lower.column_begin.push_back(0);
  for (dealii::types::global_dof_index i = 0; i < dofs.n_dofs(); ++i) {
    // Row i of a symmetric matrix is its column i; deal.II puts the diagonal first, then ascends.
    for (auto entry = stiffness.begin(i); entry != stiffness.end(i); ++entry)
      if (entry->column() >= i) {
        lower.row.push_back(static_cast<int>(entry->column()));
        lower.value.push_back(entry->value());
      }
    lower.column_begin.push_back(static_cast<int>(lower.row.size()));
  }
  Eigen::VectorXd right(lower.size);
  for (int i = 0; i < lower.size; ++i) right[i] = load[static_cast<unsigned int>(i)];
  const Eigen::VectorXd solution =
      CholeskyFactor(lower, nested_dissection(lower), {lower.size - 1}).solve(right);
  dealii::Vector<double> displacement(dofs.n_dofs());
  for (int i = 0; i < lower.size; ++i) displacement[static_cast<unsigned int>(i)] = solution[i];
  constraints.distribute(displacement);
  return displacement;
}

/// A cube of general hexahedra with hanging nodes: no face of an inner element is parallel to
/// another.
void make_distorted(dealii::Triangulation<dim>& triangulation) {
  dealii::GridGenerator::subdivided_hyper_cube(triangulation, 3);
  dealii::GridTools::distort_random(0.2, triangulation, true, 1);
  triangulation.begin_active()->set_refine_flag();
  triangulation.execute_coarsening_and_refinement();
}

Check patch_test(double nu) {
  Body body;
  body.poisson_ratio = nu;
  make_distorted(body.triangulation);
  const double gradient[3][3] = {{0.3, -0.2, 0.5}, {0.1, 0.4, -0.3}, {-0.6, 0.2, -0.1}};
  const Field linear = [&](const Point& p, unsigned int c) {
    return 0.2 + gradient[c][0] * p[0] + gradient[c][1] * p[1] + gradient[c][2] * p[2];
  };
  const auto displacement = body.solve(linear, [](const Point&, unsigned int) { return 0.0; });
  dealii::Vector<double> exact(displacement);
  dealii::VectorTools::interpolate(body.mapping, body.dofs, VectorField(linear), exact);
  Check check{element_group, named_element("patch test, distorted, hanging nodes", nu),
              "largest error / largest u", 0};
  const double largest = exact.linfty_norm();
  exact -= displacement;
  check.measured = exact.linfty_norm() / largest;
  // Condition: (elements per side)² times the ratio of the two moduli.
  check.tolerance = 100 * kEpsilon * 36 / (1 - 2 * nu);
  check.reason = "round-off x condition, 36/(1 - 2 nu)";
  return check;
}

/// Forces that a rigid motion causes, over what a strain of the same size causes.
Checks rigid_motions(double nu) {
  Body body;
  make_distorted(body.triangulation);
  body.dofs.distribute_dofs(body.element);
  const auto cell = body.dofs.begin_active();
  std::vector<Point> support(body.element.n_dofs_per_cell());
  for (unsigned int i = 0; i < support.size(); ++i)
    support[i] = body.mapping.transform_unit_to_real_cell(cell, body.element.unit_support_point(i));
  ElementStiffness of_cell(body.mapping, body.element, nu, true);
  const dealii::FullMatrix<double> stiffness = of_cell(cell);
  const auto force_of = [&](const Field& field) {
    dealii::Vector<double> motion(support.size()), force(support.size());
    for (unsigned int i = 0; i < support.size(); ++i)
      motion[i] = field(support[i], body.element.system_to_component_index(i).first);
    stiffness.vmult(force, motion);
    return force.linfty_norm();
  };
  const double stretch = force_of([](const Point& p, unsigned int c) { return c == 0 ? p[0] : 0; });
  Checks checks;
  const auto add = [&](const char* motion, const Field& field) {
    Check check{element_group, named_element(motion, nu), "force / that of a stretch", 0,
                force_of(field) / stretch};
    check.tolerance = 81 * kEpsilon * 10;
    check.reason = "round-off of 81 terms, each up to 10 times their sum";
    checks.push_back(check);
  };
  add("rigid translation", [](const Point&, unsigned int c) { return 1.0 + c; });
  add("rigid rotation", [](const Point& p, unsigned int c) {
    const double axis[] = {0.3, -0.5, 0.8};
    return axis[(c + 1) % 3] * p[(c + 2) % 3] - axis[(c + 2) % 3] * p[(c + 1) % 3];
  });
  return checks;
}

/// The stiffness of a turned element is the turned stiffness.
Check turned_element(double nu) {
  Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const auto stiffness_of = [&](bool turned) {
    Body body;
    make_distorted(body.triangulation);
    if (turned)
      dealii::GridTools::transform(
          [&](const Point& p) {
            const Eigen::Vector3d q = turn * Eigen::Vector3d(p[0], p[1], p[2]);
            return Point(q[0], q[1], q[2]);
          },
          body.triangulation);
    body.dofs.distribute_dofs(body.element);
    const auto cell = body.dofs.begin_active();
    const auto matrix = ElementStiffness(body.mapping, body.element, nu, true)(cell);
    // By node, then component.
    Eigen::MatrixXd result(matrix.m(), matrix.n());
    const auto place = [&](unsigned int i) {
      const auto [c, node] = body.element.system_to_component_index(i);
      return static_cast<Eigen::Index>(3 * node + c);
    };
    for (unsigned int i = 0; i < matrix.m(); ++i)
      for (unsigned int j = 0; j < matrix.n(); ++j) result(place(i), place(j)) = matrix(i, j);
    return result;
  };
  const Eigen::MatrixXd plain = stiffness_of(false), turned = stiffness_of(true);
  Eigen::MatrixXd expected = plain;
  for (Eigen::Index i = 0; i < plain.rows(); i += 3)
    for (Eigen::Index j = 0; j < plain.cols(); j += 3)
      expected.block<3, 3>(i, j) = turn * plain.block<3, 3>(i, j) * turn.transpose();
  Check check{element_group, named_element("element turned by 40 degrees", nu),
              "change of the stiffness", 0, (turned - expected).norm() / expected.norm()};
  check.tolerance = 81 * kEpsilon * 10;
  check.reason = "round-off of 81 terms, each up to 10 times their sum";
  return check;
}

struct NormsOfError {
  double l2 = 0, energy = 0;
};

/// u_i = amplitude_i s_i, s = (sin x cos y cos z, cos x sin y cos z, cos x cos y sin z) (pi x).
NormsOfError manufactured(int cells, double nu, const std::array<double, 3>& amplitude) {
  const auto shape = [](const Point& p, unsigned int c) {
    double value = 1;
    for (unsigned int k = 0; k < dim; ++k)
      value *= k == c ? std::sin(M_PI * p[k]) : std::cos(M_PI * p[k]);
    return value;
  };
  const double shear = 0.5 / (1 + nu), lame = nu / ((1 + nu) * (1 - 2 * nu));
  const double sum = amplitude[0] + amplitude[1] + amplitude[2];
  Body body;
  body.poisson_ratio = nu;
  // Boxes of unequal sides, as in a layer.
  dealii::GridGenerator::subdivided_hyper_rectangle(
      body.triangulation,
      {static_cast<unsigned int>(cells), static_cast<unsigned int>(cells),
       static_cast<unsigned int>(cells)},
      Point(0.1, 0.2, 0), Point(1.1, 1, 0.7));
  const Field exact = [&](const Point& p, unsigned int c) { return amplitude[c] * shape(p, c); };
  const auto displacement = body.solve(exact, [&](const Point& p, unsigned int c) {
    return M_PI * M_PI * (3 * shear * amplitude[c] + (shear + lame) * sum) * shape(p, c);
  });
  dealii::FEValues<dim> values(body.mapping, body.element, dealii::QGauss<dim>(5),
                               dealii::update_values | dealii::update_gradients |
                                   dealii::update_JxW_values | dealii::update_quadrature_points);
  NormsOfError norms;
  std::vector<dealii::Vector<double>> found(values.n_quadrature_points,
                                            dealii::Vector<double>(dim));
  std::vector<std::vector<dealii::Tensor<1, dim>>> slope(values.n_quadrature_points,
                                                         std::vector<dealii::Tensor<1, dim>>(dim));
  for (const auto& cell : body.dofs.active_cell_iterators()) {
    values.reinit(cell);
    values.get_function_values(displacement, found);
    values.get_function_gradients(displacement, slope);
    for (unsigned int q = 0; q < values.n_quadrature_points; ++q) {
      const Point& p = values.quadrature_point(q);
      dealii::Tensor<2, dim> gradient;
      for (unsigned int c = 0; c < dim; ++c) {
        const double difference = found[q][c] - exact(p, c);
        norms.l2 += values.JxW(q) * difference * difference;
        for (unsigned int k = 0; k < dim; ++k) {
          double derivative = amplitude[c] * M_PI;
          for (unsigned int m = 0; m < dim; ++m) {
            const bool sine = m == c, derived = m == k;
            derivative *= sine == derived ? std::cos(M_PI * p[m]) : std::sin(M_PI * p[m]);
            if (!sine && derived) derivative *= -1;
          }
          gradient[c][k] = slope[q][c][k] - derivative;
        }
      }
      const auto strain = dealii::symmetrize(gradient);
      norms.energy += values.JxW(q) * 2 * shear * (strain * strain);
    }
  }
  return {std::sqrt(norms.l2), std::sqrt(norms.energy)};
}

/// Orders of convergence observed on meshes of n, 2n and 4n cells.
///
/// Where div u = 0, the order observed at cell size h differs from the theoretical one by a term in
/// h². It is extrapolated to h = 0 and compared with the theoretical order.
///
/// Elsewhere the error has a second part, which is large on coarse meshes and falls faster. The
/// observed order is then above the theoretical one and approaches it slowly, so that only a lower
/// bound is checked. Measured: at nu = 0.3 in energy 2.20 on 4 to 8 cells, 2.16 on 8 to 16; at nu =
/// 0 in L2 3.022 on 3 to 6, 3.009 on 6 to 12.
Checks convergence(int cells, double nu, const std::array<double, 3>& amplitude, const char* what) {
  const bool isochoric = amplitude[0] + amplitude[1] + amplitude[2] == 0;
  const NormsOfError errors[] = {manufactured(cells, nu, amplitude),
                                 manufactured(2 * cells, nu, amplitude),
                                 manufactured(4 * cells, nu, amplitude)};
  Checks checks;
  const auto add = [&](const char* quantity, double order, double NormsOfError::*norm) {
    const double first = std::log2(errors[0].*norm / errors[1].*norm);
    const double second = std::log2(errors[1].*norm / errors[2].*norm);
    const double correction = (second - first) / 3;
    Check check{element_group, named_element(what, nu), quantity, order, second + correction};
    check.tolerance = std::abs(correction) / order;
    check.reason = "as much as the extrapolation to h = 0 corrects the last observed order";
    if (!isochoric) {
      check.measured = second;
      check.relation = Relation::at_least;
      check.reason = "lower bound: a part of the error falls faster, the order comes down slowly";
    }
    checks.push_back(check);
  };
  add("order in L2", 3, &NormsOfError::l2);
  add("order in energy", 2, &NormsOfError::energy);
  return checks;
}

}  // namespace

Checks check_element(bool quick) {
  Checks checks;
  const auto add = [&](const Checks& more) {
    checks.insert(checks.end(), more.begin(), more.end());
  };
  for (const double nu : {0.0, 0.3, 0.4999}) {
    add({patch_test(nu)});
    add(rigid_motions(nu));
    add({turned_element(nu)});
    if (quick) break;
  }
  const int coarsest = quick ? 2 : 3;
  add(convergence(coarsest, 0.3, {1, 1, -2}, "manufactured solution, div u = 0"));
  add(convergence(coarsest, 0.3, {1, 0.5, 0.2}, "manufactured solution"));
  if (quick) return checks;
  add(convergence(coarsest, 0.4999, {1, 1, -2}, "manufactured solution, div u = 0"));
  add(convergence(coarsest, 0, {1, 0.5, 0.2}, "manufactured solution"));
  return checks;
}

}  // namespace softfinger::fem::verification
