#include "fem/finite/element.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>

namespace softfinger::fem::finite {

using Eigen::Index;

namespace {

/// F at a point.
Eigen::Matrix3d gradient_at(const ElementGeometry& geometry, Index point,
                            const Eigen::VectorXd& displacement) {
  const Index nodes = geometry.gradients.rows();
  const Eigen::Map<const Eigen::MatrixXd> by_component(displacement.data(), nodes, 3);
  return Eigen::Matrix3d::Identity() +
         by_component.transpose() * geometry.gradients.middleCols<3>(3 * point);
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
  for (Index point = 0; point < geometry.weight.size(); ++point)
    smallest = std::min(smallest, gradient_at(geometry, point, displacement).determinant());
  return smallest;
}

ElementLinearisation linearise(const ElementGeometry& geometry, const Material& material,
                               const ElementState& state, const Eigen::VectorXd& displacement,
                               bool with_stiffness) {
  const Index nodes = geometry.gradients.rows(), points = geometry.weight.size();
  ElementLinearisation result;
  result.force = Eigen::VectorXd::Zero(3 * nodes);
  Eigen::MatrixXd volume_by_displacement = Eigen::MatrixXd::Zero(4, 3 * nodes);  // int phi dJ
  Eigen::Vector4d volume = Eigen::Vector4d::Zero(), pressure = Eigen::Vector4d::Zero();
  Eigen::Matrix4d stiffness_of_volume = Eigen::Matrix4d::Zero();
  // Weight x tangent x gradients at all points, for each pair of components. The stiffness then is
  // one product of matrices per pair.
  constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  Eigen::MatrixXd weighted[6];
  for (auto& of_pair : weighted) of_pair.resize(3 * points, nodes);

  for (Index point = 0; point < points; ++point) {
    const double weight = geometry.weight[point];
    const auto gradients = geometry.gradients.middleCols<3>(3 * point);
    const Eigen::Vector4d linear = geometry.linear.col(point);
    const Deformation deformation(gradient_at(geometry, point, displacement));
    const double own_pressure = linear.dot(state.pressure);
    const double own_volume_ratio = linear.dot(state.volume_ratio);
    Response response = material.respond(deformation);
    response.stress += own_pressure * deformation.cofactor;
    response.tangent += own_pressure * deformation.second;
    const VolumetricResponse volumetric = material.respond_to_volume(own_volume_ratio);

    volume += weight * (deformation.volume_ratio - own_volume_ratio) * linear;
    pressure += weight * (volumetric.pressure - own_pressure) * linear;
    stiffness_of_volume += weight * volumetric.modulus * linear * linear.transpose();
    const Eigen::MatrixXd cofactor_gradients = gradients * deformation.cofactor.transpose();
    const Eigen::MatrixXd stress_gradients = gradients * response.stress.transpose();
    for (int i = 0; i < 3; ++i) {
      result.force.segment(i * nodes, nodes) += weight * stress_gradients.col(i);
      volume_by_displacement.middleCols(i * nodes, nodes) +=
          weight * linear * cofactor_gradients.col(i).transpose();
    }
    for (int pair = 0; with_stiffness && pair < 6; ++pair) {
      Eigen::Matrix3d tangent;
      for (int J = 0; J < 3; ++J)
        for (int L = 0; L < 3; ++L)
          tangent(J, L) = response.tangent(pairs[pair][0] + 3 * J, pairs[pair][1] + 3 * L);
      weighted[pair].middleRows<3>(3 * point) = weight * tangent * gradients.transpose();
    }
  }

  const auto mass = geometry.mass.llt();
  result.volume_rate = mass.solve(volume_by_displacement);
  result.volume_mismatch = mass.solve(volume);
  result.pressure_mismatch = mass.solve(pressure);
  result.bulk = mass.solve(stiffness_of_volume);
  result.residual =
      result.force + volume_by_displacement.transpose() *
                         (result.pressure_mismatch + result.bulk * result.volume_mismatch);
  if (!with_stiffness) return result;
  result.stiffness.noalias() =
      result.volume_rate.transpose() * (stiffness_of_volume * result.volume_rate);
  for (int pair = 0; pair < 6; ++pair) {
    const int i = pairs[pair][0], k = pairs[pair][1];
    const Eigen::MatrixXd block = geometry.gradients * weighted[pair];
    result.stiffness.block(i * nodes, k * nodes, nodes, nodes) += block;
    if (i != k) result.stiffness.block(k * nodes, i * nodes, nodes, nodes) += block.transpose();
  }
  return result;
}

double strain_energy(const ElementGeometry& geometry, const Material& material,
                     const ElementState& state, const Eigen::VectorXd& displacement) {
  double energy = 0;
  for (Index point = 0; point < geometry.weight.size(); ++point) {
    const double volume_ratio = geometry.linear.col(point).dot(state.volume_ratio);
    energy += geometry.weight[point] *
              (material.respond(Deformation(gradient_at(geometry, point, displacement))).energy +
               material.respond_to_volume(volume_ratio).energy);
  }
  return energy;
}

}  // namespace softfinger::fem::finite
