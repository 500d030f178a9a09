#pragma once

#include <Eigen/Core>
#include <memory>

#include "fem/algebra/cholesky.h"
#include "fem/finite/material.h"

namespace softfinger::fem::finite {

/// An element in the reference state: what does not change with the deformation. Displacements of
/// its n nodes are ordered by component: x of all nodes, then y, then z.
struct ElementGeometry {
  /// n x 3 q: dN_a/dxi_k of point p in column 3 p + k. Those of the unit cell, which all elements
  /// share: read for each anew, they would cost more than what is done with them.
  std::shared_ptr<const Eigen::MatrixXd> unit_gradients;
  Eigen::Matrix3Xd to_unit;  ///< 3 x 3 q: dxi_k/dX_J of point p at (k, 3 p + J)
  Eigen::VectorXd weight;    ///< q: volume of each quadrature point, > 0
  Eigen::MatrixXd linear;    ///< 4 x q: 1 and three linear functions of X
  Eigen::Matrix4d mass;      ///< their Gram matrix in the element
  Eigen::Matrix4d inverse_mass;

  void set_mass();
  /// n x 3 q: dN_a/dX_J of point p in column 3 p + J
  Eigen::MatrixXd gradients() const;
};

/// A field's gradient in the unit cell: du_i/dxi_k of point p at (3 p + k, i).
using UnitGradient = Eigen::Ref<const Eigen::MatrixX3d>;

/// Pressure and volume ratio of an element, linear in X and discontinuous between elements:
/// unknowns of their own in Newton's method. As functions of the displacements they make it fail at
/// nu = 0.4999.
struct ElementState {
  Eigen::Vector4d pressure = Eigen::Vector4d::Zero();
  Eigen::Vector4d volume_ratio = Eigen::Vector4d::UnitX();
};

/// The three-field energy (J. C. Simo, R. L. Taylor, K. S. Pister, Comput. Methods Appl. Mech.
/// Engrg. 51, 1985)
///   int Psi(F) + p (J(F) - t) + U(t) dV
/// about a state, with the changes of t and p eliminated, A the inverse of `mass`:
///   dt = volume_mismatch + A int linear (cof F : grad du) dV,  dp = pressure_mismatch + bulk dt.
struct ElementBalance {
  Eigen::MatrixX3d deformation;  ///< F_iJ of point p at (3 p + J, i)
  Eigen::Vector4d volume_mismatch, pressure_mismatch;
  Eigen::Matrix4d bulk;
};

/// An element's balance with its derivative by the displacements.
struct ElementLinearisation : ElementBalance {
  Eigen::MatrixXd stiffness;  ///< 3 n x 3 n, symmetric, not always positive definite
  Eigen::VectorXd force;      ///< internal forces at the state's own pressure
  Eigen::VectorXd residual;   ///< the same at the pressure that Newton's step without du leads to
};

/// A fraction of a step from a state.
struct ElementAdvance {
  ElementState state;
  /// The smallest volume ratio at the quadrature points, of the deformation or of the element's own
  /// field. Where it is not positive there is no energy.
  double smallest_volume_ratio;
};

/// @param step  displacements of the whole step
ElementAdvance advance(const ElementGeometry& geometry, const ElementBalance& balance,
                       const ElementState& from, const UnitGradient& step, double fraction);

/// @returns as `ElementAdvance` has it
double smallest_volume_ratio(const ElementGeometry& geometry, const ElementState& state,
                             const UnitGradient& displacement);

/// @pre smallest_volume_ratio > 0
/// @param stress  what `unit_gradients` times it is the residual of `ElementLinearisation`,
///                3 q x 3, one column per component
ElementBalance balance(const ElementGeometry& geometry, const Material& material,
                       const ElementState& state, const UnitGradient& displacement,
                       Eigen::Ref<Eigen::MatrixX3d> stress);

/// @pre smallest_volume_ratio > 0
ElementLinearisation linearise(const ElementGeometry& geometry, const Material& material,
                               const ElementState& state, const UnitGradient& displacement,
                               Precision of_stiffness = Precision::full);

/// Strain energy with the state's own volume ratio in U.
double strain_energy(const ElementGeometry& geometry, const Material& material,
                     const ElementState& state, const UnitGradient& displacement);

}  // namespace softfinger::fem::finite
