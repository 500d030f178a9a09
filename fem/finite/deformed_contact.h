#pragma once

#include "fem/finite/finite_pressing.h"

namespace softfinger::fem::finite {

/// A symmetric contact as measured on the deformed surface, in units of h and E.
struct DeformedContact {
  double a = 0, b = 0;              ///< from the centre to the edge along x and y, deformed
  double block_a = 0, block_b = 0;  ///< the same edge in the undeformed block, for the next mesh
  double area = 0;                  ///< of the deformed, inclined surface in contact
  double peak = 0;                  ///< Cauchy pressure at the centre
  double torque_arm = 0;            ///< int p r dA / P on the deformed surface
  double projected_arm = 0;         ///< int p n_z r dA / P
  double fit_residual = 0;          ///< of the pressure's fit, relative to the mean pressure
};

/// Fits the edge of the pressure in the undeformed block, where the surface's shape functions are
/// those of a regular grid, and follows it into the deformed state by the displacements.
/// @throws ConvergenceError when the fit leaves the patch
DeformedContact measure(const FinitePressing& pressing);

/// Share of the deformed surface of each surface node.
Eigen::VectorXd nodal_area(const FinitePressing& pressing);

/// Cauchy pressure of each surface node: its force over its share of the deformed surface.
Eigen::VectorXd nodal_pressure(const FinitePressing& pressing);

}  // namespace softfinger::fem::finite
