#pragma once

#include "softfinger/input/contact_problem.h"
#include "softfinger/layer/contact_numbers.h"

namespace softfinger {

/// Contact of a rigid quadric with a bonded elastic layer. `torque_arm_exact_m` is (int p r dA)/P,
/// `torque_arm_paper_m` that of the circle of radius sqrt(ab).
using BondedLayerContact = ContactNumbers;

/// Derivatives of the contact with respect to the load, which a simulator needs for implicit steps.
struct BondedLayerSensitivity {
  double area_m2_per_N = 0;        ///< d(pi a b)/dP
  double indentation_m_per_N = 0;  ///< dd/dP: the normal compliance
  /// d(torque_arm_exact_m)/dP: the largest torque changes by mu (arm + P times this).
  double torque_arm_m_per_N = 0;
};

/// Any thickness, Poisson's ratio 0 to 1/2 and R'/R'': a smooth blend of the exact limits (Hertz,
/// confined Winkler, thin incompressible layer) times tabulated corrections, a twice continuously
/// differentiable spline through 3,552 numerical solutions (bonded_layer_table.cc). For
/// sqrt(ab)/h <= 100 and R'/R'' <= 100 within 0.5 % in a, b and torque arm and 1 % in the
/// indentation; beyond, the corrections fade (thickness) or stay (R'/R'').
///
/// The arguments must lie in the ranges of contact_problem.h; results that do not fit into a double
/// come out as zero or infinity. Cost: about 0.3 microseconds, no allocation.
BondedLayerContact bonded_layer_contact(const RelativeRadii& radii, const ElasticLayer& layer,
                                        double normal_force_N) noexcept;

/// The exact derivatives of what `bonded_layer_contact` returns. Cost: below 1 microsecond.
BondedLayerSensitivity bonded_layer_sensitivity(const RelativeRadii& radii,
                                                const ElasticLayer& layer,
                                                double normal_force_N) noexcept;

}  // namespace softfinger
