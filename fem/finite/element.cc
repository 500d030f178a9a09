#include "fem/finite/element.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

namespace softfinger::fem::finite {

using Eigen::Index;

namespace {

/// F of all points, transposed: F_iJ of point p at (3 p + J, i).
Eigen::MatrixX3d gradients_of(const ElementGeometry& geometry,
                              const Eigen::VectorXd& displacement) {
  const Eigen::Map<const Eigen::MatrixX3d> by_component(displacement.data(),
                                                        geometry.gradients.rows(), 3);
  // For three columns a library's product of matrices mostly copies the gradients.
  Eigen::MatrixX3d result = geometry.gradients.transpose().lazyProduct(by_component);
  for (Index point = 0; point < geometry.weight.size(); ++point)
    result.middleRows<3>(3 * point).diagonal().array() += 1;
  return result;
}

Eigen::Matrix3d at_point(const Eigen::MatrixX3d& gradients, Index point) {
  return gradients.middleRows<3>(3 * point).transpose();
}

}  // namespace

ElementState ElementLinearisation::advanced(const ElementState& from, const Eigen::VectorXd& step,
                                            double fraction) const {
  const Eigen::Vector4d volume = volume_mismatch + volume_rate * step;
  ElementState result = from;
  result.volume_ratio += fraction * volume;
  result.pressure += fraction * (pressure_mismatch + bulk * volume);
  return result;
}

double smallest_volume_ratio(const ElementGeometry& geometry, const ElementState& state,
                             const Eigen::VectorXd& displacement) {
  double smallest = (geometry.linear.transpose() * state.volume_ratio).minCoeff();
  const Eigen::MatrixX3d gradients = gradients_of(geometry, displacement);
  for (Index point = 0; point < geometry.weight.size(); ++point)
    smallest = std::min(smallest, at_point(gradients, point).determinant());
  return smallest;
}

ElementLinearisation linearise(const ElementGeometry& geometry, const Material& material,
                               const ElementState& state, const Eigen::VectorXd& displacement,
                               bool with_stiffness) {
  const Index nodes = geometry.gradients.rows(), points = geometry.weight.size();
  const Eigen::MatrixX3d deformations = gradients_of(geometry, displacement);
  Eigen::Vector4d volume = Eigen::Vector4d::Zero(), pressure = Eigen::Vector4d::Zero();
  Eigen::Matrix4d stiffness_of_volume = Eigen::Matrix4d::Zero();
  // What the gradients are multiplied by at the points, so that sums over these are products of
  // large matrices: for forces the stress, and for int phi_k dJ the cofactor times phi_k; for the
  // stiffness the gradients times the tangent, for each pair of components.
  Eigen::MatrixXd stresses(3 * points, 15);
  constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  Eigen::MatrixXd weighted;
  if (with_stiffness) weighted.resize(6 * nodes, 3 * points);

  for (Index point = 0; point < points; ++point) {
    const double weight = geometry.weight[point];
    const Eigen::Vector4d linear = geometry.linear.col(point);
    const Deformation deformation(at_point(deformations, point), with_stiffness);
    const double own_pressure = linear.dot(state.pressure);
    const double own_volume_ratio = linear.dot(state.volume_ratio);
    const Response response = material.respond(deformation, with_stiffness);
    const VolumetricResponse volumetric = material.respond_to_volume(own_volume_ratio);

    volume += weight * (deformation.volume_ratio - own_volume_ratio) * linear;
    pressure += weight * (volumetric.pressure - own_pressure) * linear;
    stiffness_of_volume += weight * volumetric.modulus * linear * linear.transpose();
    auto at_this = stresses.middleRows<3>(3 * point);
    at_this.leftCols<3>() =
        weight * (response.stress + own_pressure * deformation.cofactor).transpose();
    for (Index k = 0; k < 4; ++k)
      at_this.middleCols<3>(3 + 3 * k) = weight * linear[k] * deformation.cofactor.transpose();
    if (!with_stiffness) continue;
    const Matrix9d tangent = weight * (response.tangent + own_pressure * deformation.second);
    const auto gradients = geometry.gradients.middleCols<3>(3 * point);
    for (Index pair = 0; pair < 6; ++pair)
      for (Index J = 0; J < 3; ++J) {
        const auto row = tangent.row(pairs[pair][0] + 3 * J);
        const Index k = pairs[pair][1];
        weighted.block(pair * nodes, 3 * point + J, nodes, 1) = row[k] * gradients.col(0) +
                                                                row[k + 3] * gradients.col(1) +
                                                                row[k + 6] * gradients.col(2);
      }
  }

  const Eigen::MatrixXd forces = geometry.gradients * stresses;
  const Eigen::Map<const Eigen::MatrixX4d> volume_by_displacement(forces.data() + 3 * nodes,
                                                                  3 * nodes, 4);  // int phi dJ
  const auto mass = geometry.mass.llt();
  ElementLinearisation result;
  result.force = forces.leftCols<3>().reshaped();
  result.volume_rate = mass.solve(volume_by_displacement.transpose());
  result.volume_mismatch = mass.solve(volume);
  result.pressure_mismatch = mass.solve(pressure);
  result.bulk = mass.solve(stiffness_of_volume);
  result.residual = result.force + volume_by_displacement * (result.pressure_mismatch +
                                                             result.bulk * result.volume_mismatch);
  if (!with_stiffness) return result;
  result.stiffness.noalias() =
      result.volume_rate.transpose() * (stiffness_of_volume * result.volume_rate);
  const Eigen::MatrixXd blocks = geometry.gradients * weighted.transpose();
  for (Index pair = 0; pair < 6; ++pair) {
    const Index i = pairs[pair][0], k = pairs[pair][1];
    const auto block = blocks.middleCols(pair * nodes, nodes);
    result.stiffness.block(i * nodes, k * nodes, nodes, nodes) += block;
    if (i != k) result.stiffness.block(k * nodes, i * nodes, nodes, nodes) += block.transpose();
  }
  return result;
}

double strain_energy(const ElementGeometry& geometry, const Material& material,
                     const ElementState& state, const Eigen::VectorXd& displacement) {
  double energy = 0;
  const Eigen::MatrixX3d gradients = gradients_of(geometry, displacement);
  for (Index point = 0; point < geometry.weight.size(); ++point) {
    const double volume_ratio = geometry.linear.col(point).dot(state.volume_ratio);
    energy += geometry.weight[point] *
              (material.respond(Deformation(at_point(gradients, point), false), false).energy +
               material.respond_to_volume(volume_ratio).energy);
  }
  return energy;
}

}  // namespace softfinger::fem::finite
