#include "fem/layer/element_stiffness.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "softfinger/input/errors.h"

namespace softfinger::fem {

ElementStiffness::ElementStiffness(const dealii::Mapping<dim>& mapping,
                                   const dealii::FiniteElement<dim>& element, double poisson_ratio,
                                   bool bent)
    : shear_(0.5 / (1 + poisson_ratio)),
      lame_(poisson_ratio / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio))),
      bent_(bent),
      quadrature_(3),
      values_(mapping, element, quadrature_,
              dealii::update_gradients | dealii::update_JxW_values |
                  dealii::update_quadrature_points) {}

dealii::FullMatrix<double> ElementStiffness::operator()(
    const dealii::DoFHandler<dim>::active_cell_iterator& cell) {
  if (bent_) return integrate(cell);
  const double size = cell->diameter();
  std::array<long, 3 * 7> shape;
  for (unsigned int v = 1; v < 8; ++v)
    for (unsigned int c = 0; c < dim; ++c)
      shape[3 * (v - 1) + c] = std::lround((cell->vertex(v)[c] - cell->vertex(0)[c]) / size * 1e10);
  auto known = unit_size_.find(shape);
  if (known == unit_size_.end()) {
    auto stiffness = integrate(cell);
    stiffness *= 1 / size;
    known = unit_size_.emplace(shape, std::move(stiffness)).first;
  }
  auto result = known->second;
  result *= size;
  return result;
}

dealii::FullMatrix<double> ElementStiffness::integrate(
    const dealii::DoFHandler<dim>::active_cell_iterator& cell) {
  values_.reinit(cell);
  const auto& element = values_.get_fe();
  const unsigned int dofs = element.n_dofs_per_cell(), points = quadrature_.size();
  const auto center = values_.quadrature_point(points / 2);
  const double size = cell->diameter();
  Eigen::MatrixXd strain = Eigen::MatrixXd::Zero(6 * points, dofs);
  Eigen::MatrixXd divergence = Eigen::MatrixXd::Zero(4, dofs);
  Eigen::Matrix4d mass = Eigen::Matrix4d::Zero();
  for (unsigned int q = 0; q < points; ++q) {
    if (!(values_.JxW(q) > 0))
      throw InputError("mesh", "element", "of no or negative volume",
                       "a layer that does not fold; is it too thick for the surface's curvature?");
    const double weight = values_.JxW(q), root = std::sqrt(2 * shear_ * weight);
    const auto offset = (values_.quadrature_point(q) - center) / size;
    const Eigen::Vector4d linear(1, offset[0], offset[1], offset[2]);
    mass += weight * linear * linear.transpose();
    for (unsigned int i = 0; i < dofs; ++i) {
      const unsigned int c = element.system_to_component_index(i).first;
      const auto& gradient = values_.shape_grad(i, q);
      // Rows: xx, yy, zz, then sqrt(2) times the tensor shear strains xy, yz, zx.
      strain(6 * q + c, i) = root * gradient[c];
      const unsigned int next = (c + 1) % 3, previous = (c + 2) % 3;
      strain(6 * q + 3 + c, i) += root * std::sqrt(0.5) * gradient[next];
      strain(6 * q + 3 + previous, i) += root * std::sqrt(0.5) * gradient[previous];
      divergence.col(i) += weight * gradient[c] * linear;
    }
  }
  const Eigen::MatrixXd stiffness =
      strain.transpose() * strain + lame_ * divergence.transpose() * mass.llt().solve(divergence);
  dealii::FullMatrix<double> result(dofs, dofs);
  for (unsigned int i = 0; i < dofs; ++i)
    for (unsigned int j = 0; j < dofs; ++j)
      result(i, j) = 0.5 * (stiffness(i, j) + stiffness(j, i));
  return result;
}

}  // namespace softfinger::fem
