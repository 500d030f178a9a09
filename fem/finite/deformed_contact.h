#pragma once

#include "fem/finite/finite_pressing.h"

namespace softfinger::fem::finite {

/// A contact as measured on the deformed surface, in units of h and E.
struct DeformedContact {
  double a = 0, b = 0;              ///< semi-axes seen along the load, deformed
  double turn_rad = 0;              ///< of the long one from x; 0 where symmetry holds it
  double block_a = 0, block_b = 0;  ///< along x and y in the undeformed block, for the next mesh
  double area = 0;                  ///< of the deformed, inclined surface in contact
  double peak = 0;                  ///< largest Cauchy pressure
  double torque_arm = 0;            ///< int p r dA / P on the deformed surface
  double projected_arm = 0;         ///< int p n_z r dA / P
  double fit_residual = 0;          ///< of the pressure's fit, relative to the mean pressure
};

/// Measures the contact of the present equilibrium.
///
/// On a quarter, the edge of the pressure is fitted in the undeformed block, where the surface's
/// shape functions are those of a regular grid. The displacements then carry it into the deformed
/// state.
///
/// On a whole layer the contact is only roughly an ellipse. The ellipse that is reported has the
/// contact's area seen along the load, which is known to some tenths of a cell from the touching
/// nodes. Its directions and its ratio of axes are those of the pressure's second moments. The
/// moments alone would give axes 4 to 7 % too long at d/h = 0.2 to 0.4: they need the pressure to
/// be a power of 1 - r², as in linear elasticity, which that of a deeply pressed layer is not.
/// @throws ConvergenceError when the fit leaves the patch
DeformedContact measure(const FinitePressing& pressing);

/// Share of the deformed surface of each surface node.
Eigen::VectorXd nodal_area(const FinitePressing& pressing);

/// Cauchy pressure of each surface node: its force over its share of the deformed surface.
Eigen::VectorXd nodal_pressure(const FinitePressing& pressing);

}  // namespace softfinger::fem::finite
