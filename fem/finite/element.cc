#include "fem/finite/element.h"

#include <Eigen/LU>
#include <algorithm>
#include <vector>

namespace softfinger::fem::finite {

using Eigen::Index;

namespace {

/// The gradient of a field at a point, du_i/dX_J.
Eigen::Matrix3d gradient_at(const ElementGeometry& geometry, const UnitGradient& field,
                            Index point) {
  return (geometry.to_unit.middleCols<3>(3 * point).transpose() * field.middleRows<3>(3 * point))
      .transpose();
}

Eigen::Matrix3d deformation_at(const ElementGeometry& geometry, const UnitGradient& displacement,
                               Index point) {
  return Eigen::Matrix3d::Identity() + gradient_at(geometry, displacement, point);
}

/// F of all points, transposed: F_iJ of point p at (3 p + J, i).
Eigen::MatrixX3d deformations(const ElementGeometry& geometry, const UnitGradient& displacement) {
  Eigen::MatrixX3d result(displacement.rows(), 3);
  for (Index point = 0; point < geometry.weight.size(); ++point)
    result.middleRows<3>(3 * point) = deformation_at(geometry, displacement, point).transpose();
  return result;
}

Eigen::Matrix3d at_point(const Eigen::MatrixX3d& gradients, Index point) {
  return gradients.middleRows<3>(3 * point).transpose();
}

constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

/// Sums over the points of the gradients times the tangent times the gradients, for each pair of
/// components, as one product of large matrices.
template <class Scalar>
class TangentSum {
 public:
  using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  explicit TangentSum(const Eigen::MatrixXd& gradients)
      : gradients_(gradients.cast<Scalar>()), weighted_(6 * gradients.rows(), gradients.cols()) {}

  void set(Index point, const Matrix9d& of_point) {
    const Eigen::Matrix<Scalar, 9, 9> tangent = of_point.cast<Scalar>();
    const Index nodes = gradients_.rows();
    const auto gradients = gradients_.template middleCols<3>(3 * point);
    for (Index pair = 0; pair < 6; ++pair)
      for (Index J = 0; J < 3; ++J) {
        const auto row = tangent.row(pairs[pair][0] + 3 * J);
        const Index k = pairs[pair][1];
        weighted_.block(pair * nodes, 3 * point + J, nodes, 1) = row[k] * gradients.col(0) +
                                                                 row[k + 3] * gradients.col(1) +
                                                                 row[k + 6] * gradients.col(2);
      }
  }

  void add_to(Eigen::MatrixXd& stiffness) const {
    const Index nodes = gradients_.rows();
    const Matrix blocks = gradients_ * weighted_.transpose();
    for (Index pair = 0; pair < 6; ++pair) {
      const Index i = pairs[pair][0], k = pairs[pair][1];
      const auto block = blocks.middleCols(pair * nodes, nodes).template cast<double>();
      stiffness.block(i * nodes, k * nodes, nodes, nodes) += block;
      if (i != k) stiffness.block(k * nodes, i * nodes, nodes, nodes) += block.transpose();
    }
  }

 private:
  const Matrix gradients_;
  Matrix weighted_;
};

double smallest_of_field(const ElementGeometry& geometry, const ElementState& state) {
  return (geometry.linear.transpose() * state.volume_ratio).minCoeff();
}

}  // namespace

void ElementGeometry::set_mass() {
  mass = linear * weight.asDiagonal() * linear.transpose();
  inverse_mass = mass.inverse();
}

Eigen::MatrixXd ElementGeometry::gradients() const {
  Eigen::MatrixXd result(unit_gradients->rows(), unit_gradients->cols());
  for (Index point = 0; point < weight.size(); ++point)
    result.middleCols<3>(3 * point).noalias() =
        unit_gradients->middleCols<3>(3 * point).lazyProduct(to_unit.middleCols<3>(3 * point));
  return result;
}

ElementAdvance advance(const ElementGeometry& geometry, const ElementBalance& balance,
                       const ElementState& from, const UnitGradient& step, double fraction) {
  ElementAdvance result{from, 1};
  Eigen::Vector4d rate = Eigen::Vector4d::Zero();
  for (Index point = 0; point < geometry.weight.size(); ++point) {
    const Deformation deformation(at_point(balance.deformation, point), false);
    const Eigen::Matrix3d change = gradient_at(geometry, step, point);
    rate += geometry.weight[point] * deformation.cofactor.cwiseProduct(change).sum() *
            geometry.linear.col(point);
    result.smallest_volume_ratio =
        std::min(result.smallest_volume_ratio,
                 Deformation(deformation.gradient + fraction * change, false).volume_ratio);
  }
  const Eigen::Vector4d volume = balance.volume_mismatch + geometry.inverse_mass * rate;
  result.state.volume_ratio += fraction * volume;
  result.state.pressure += fraction * (balance.pressure_mismatch + balance.bulk * volume);
  result.smallest_volume_ratio =
      std::min(result.smallest_volume_ratio, smallest_of_field(geometry, result.state));
  return result;
}

double smallest_volume_ratio(const ElementGeometry& geometry, const ElementState& state,
                             const UnitGradient& displacement) {
  double smallest = smallest_of_field(geometry, state);
  for (Index point = 0; point < geometry.weight.size(); ++point)
    smallest = std::min(
        smallest, Deformation(deformation_at(geometry, displacement, point), false).volume_ratio);
  return smallest;
}

ElementBalance balance(const ElementGeometry& geometry, const Material& material,
                       const ElementState& state, const UnitGradient& displacement,
                       Eigen::Ref<Eigen::MatrixX3d> stress) {
  const Index points = geometry.weight.size();
  ElementBalance result;
  result.deformation = deformations(geometry, displacement);
  Eigen::Vector4d volume = Eigen::Vector4d::Zero(), pressure = Eigen::Vector4d::Zero();
  Eigen::Matrix4d stiffness_of_volume = Eigen::Matrix4d::Zero();
  Eigen::Matrix3Xd cofactors(3, 3 * points);
  for (Index point = 0; point < points; ++point) {
    const double weight = geometry.weight[point];
    const Eigen::Vector4d linear = geometry.linear.col(point);
    const Deformation deformation(at_point(result.deformation, point), false);
    const double own_volume_ratio = linear.dot(state.volume_ratio);
    const VolumetricResponse volumetric = material.respond_to_volume(own_volume_ratio);
    volume += weight * (deformation.volume_ratio - own_volume_ratio) * linear;
    pressure += weight * (volumetric.pressure - linear.dot(state.pressure)) * linear;
    stiffness_of_volume += weight * volumetric.modulus * linear * linear.transpose();
    cofactors.middleCols<3>(3 * point) = deformation.cofactor;
    stress.middleRows<3>(3 * point) = material.respond(deformation, false).stress;
  }
  result.volume_mismatch = geometry.inverse_mass * volume;
  result.pressure_mismatch = geometry.inverse_mass * pressure;
  result.bulk = geometry.inverse_mass * stiffness_of_volume;
  const Eigen::Vector4d next =
      state.pressure + result.pressure_mismatch + result.bulk * result.volume_mismatch;
  for (Index point = 0; point < points; ++point) {
    auto at_this = stress.middleRows<3>(3 * point);
    const Eigen::Matrix3d whole =
        geometry.weight[point] *
        (at_this + geometry.linear.col(point).dot(next) * cofactors.middleCols<3>(3 * point));
    at_this = geometry.to_unit.middleCols<3>(3 * point) * whole.transpose();
  }
  return result;
}

namespace {

template <class Scalar>
ElementLinearisation linearise_in(const ElementGeometry& geometry, const Material& material,
                                  const ElementState& state, const UnitGradient& displacement) {
  const Eigen::MatrixXd all_gradients = geometry.gradients();
  const Index nodes = all_gradients.rows(), points = geometry.weight.size();
  ElementLinearisation result;
  result.deformation = deformations(geometry, displacement);
  Eigen::Vector4d volume = Eigen::Vector4d::Zero(), pressure = Eigen::Vector4d::Zero();
  Eigen::Matrix4d stiffness_of_volume = Eigen::Matrix4d::Zero();
  // Factors of the gradients at the points, so that sums over these are products of large matrices:
  // for forces the stress, and for int phi_k dJ the cofactor times phi_k.
  Eigen::MatrixXd stresses(3 * points, 15);
  TangentSum<Scalar> tangents(all_gradients);

  for (Index point = 0; point < points; ++point) {
    const double weight = geometry.weight[point];
    const Eigen::Vector4d linear = geometry.linear.col(point);
    const Deformation deformation(at_point(result.deformation, point));
    const double own_pressure = linear.dot(state.pressure);
    const double own_volume_ratio = linear.dot(state.volume_ratio);
    const Response response = material.respond(deformation);
    const VolumetricResponse volumetric = material.respond_to_volume(own_volume_ratio);

    volume += weight * (deformation.volume_ratio - own_volume_ratio) * linear;
    pressure += weight * (volumetric.pressure - own_pressure) * linear;
    stiffness_of_volume += weight * volumetric.modulus * linear * linear.transpose();
    auto at_this = stresses.middleRows<3>(3 * point);
    at_this.leftCols<3>() =
        weight * (response.stress + own_pressure * deformation.cofactor).transpose();
    for (Index k = 0; k < 4; ++k)
      at_this.middleCols<3>(3 + 3 * k) = weight * linear[k] * deformation.cofactor.transpose();
    tangents.set(point, weight * (response.tangent + own_pressure * deformation.second));
  }

  const Eigen::MatrixXd forces = all_gradients * stresses;
  const Eigen::Map<const Eigen::MatrixX4d> volume_by_displacement(forces.data() + 3 * nodes,
                                                                  3 * nodes, 4);  // int phi dJ
  result.force = forces.leftCols<3>().reshaped();
  result.volume_mismatch = geometry.inverse_mass * volume;
  result.pressure_mismatch = geometry.inverse_mass * pressure;
  result.bulk = geometry.inverse_mass * stiffness_of_volume;
  result.residual = result.force + volume_by_displacement * (result.pressure_mismatch +
                                                             result.bulk * result.volume_mismatch);
  const Eigen::Matrix4Xd volume_rate = geometry.inverse_mass * volume_by_displacement.transpose();
  result.stiffness.noalias() = volume_rate.transpose() * (stiffness_of_volume * volume_rate);
  tangents.add_to(result.stiffness);
  return result;
}

}  // namespace

ElementLinearisation linearise(const ElementGeometry& geometry, const Material& material,
                               const ElementState& state, const UnitGradient& displacement,
                               Precision of_stiffness) {
  return of_stiffness == Precision::single
             ? linearise_in<float>(geometry, material, state, displacement)
             : linearise_in<double>(geometry, material, state, displacement);
}

double strain_energy(const ElementGeometry& geometry, const Material& material,
                     const ElementState& state, const UnitGradient& displacement) {
  double energy = 0;
  for (Index point = 0; point < geometry.weight.size(); ++point) {
    const Deformation deformation(deformation_at(geometry, displacement, point), false);
    const double volume_ratio = geometry.linear.col(point).dot(state.volume_ratio);
    energy += geometry.weight[point] * (material.respond(deformation, false).energy +
                                        material.respond_to_volume(volume_ratio).energy);
  }
  return energy;
}

}  // namespace softfinger::fem::finite
