#pragma once

#include "fem/contact/contact_shape.h"
#include "fem/finite/finite_pressing.h"

namespace softfinger::fem::finite {

/// A contact as measured on the deformed surface, in units of h and E.
struct DeformedContact {
  ContactShape shape;  ///< deformed, seen along the load; pressures are Cauchy's
  double area = 0;     ///< of the deformed, inclined surface in contact
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< of the pressure
  double torque_arm = 0;  ///< int p r dA / P on the deformed surface, r from the pressure's centre
  double projected_arm = 0;  ///< int p n_z r dA / P
};

/// Measures the contact of the present equilibrium. The edge of the pressure is fitted in the
/// undeformed block, where the surface's shape functions are those of a regular grid. The
/// displacements then carry it into the deformed state.
/// @param surface_modulus  E / (1 - nu²) of the material at the surface, at small strain
/// @param material         the same
Outcome<DeformedContact, Unmeasured> measure(const FinitePressing& pressing, double surface_modulus,
                                             const MaterialChoice& material = {});

/// Share of the deformed surface of each surface node.
Eigen::VectorXd nodal_area(const FiniteLayer& layer);

/// Cauchy pressure of each surface node: its force over its share of the deformed surface.
Eigen::VectorXd nodal_pressure(const FinitePressing& pressing);

}  // namespace softfinger::fem::finite
