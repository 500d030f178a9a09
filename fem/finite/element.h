#pragma once

#include <Eigen/Core>

#include "fem/finite/material.h"

namespace softfinger::fem::finite {

/// An element in the reference state: what does not change with the deformation. Displacements of
/// its n nodes are ordered by component: x of all nodes, then y, then z.
struct ElementGeometry {
  Eigen::MatrixXd gradients;  ///< n x 3 q: dN_a/dX_J of point p in column 3 p + J
  Eigen::VectorXd weight;     ///< q: volume of each quadrature point, > 0
  Eigen::MatrixXd linear;     ///< 4 x q: 1 and three linear functions of X
  Eigen::Matrix4d mass;       ///< their Gram matrix in the element

  void set_mass() { mass = linear * weight.asDiagonal() * linear.transpose(); }
};

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
/// linearised about a state, with the changes of t and p eliminated:
///   dt = volume_mismatch + volume_rate du,  dp = pressure_mismatch + bulk dt.
struct ElementLinearisation {
  Eigen::MatrixXd stiffness;  ///< 3 n x 3 n, symmetric, not always positive definite
  Eigen::VectorXd force;      ///< internal forces at the state's own pressure
  Eigen::VectorXd residual;   ///< the same at the pressure that Newton's step without du leads to
  Eigen::MatrixXd volume_rate;
  Eigen::Vector4d volume_mismatch, pressure_mismatch;
  Eigen::Matrix4d bulk;

  /// The state after a fraction of the step whose displacements are `step` in full.
  ElementState advanced(const ElementState& from, const Eigen::VectorXd& step,
                        double fraction) const;
};

/// @param displacement  3 n
/// @returns the smallest volume ratio at the quadrature points, of the deformation or of the
/// element's own field; nothing else is computed for a value <= 0, which has no energy.
double smallest_volume_ratio(const ElementGeometry& geometry, const ElementState& state,
                             const Eigen::VectorXd& displacement);

/// @pre smallest_volume_ratio > 0
/// @param with_stiffness  false: `stiffness` stays empty, all else is computed
ElementLinearisation linearise(const ElementGeometry& geometry, const Material& material,
                               const ElementState& state, const Eigen::VectorXd& displacement,
                               bool with_stiffness = true);

/// Strain energy with the state's own volume ratio in U.
double strain_energy(const ElementGeometry& geometry, const Material& material,
                     const ElementState& state, const Eigen::VectorXd& displacement);

}  // namespace softfinger::fem::finite
