#pragma once

#include "fem/verification/check.h"

/// One function per group of checks. `quick`: the cheapest ones of the group.
namespace softfinger::fem::verification {

Checks check_element(bool quick);   ///< patch test, rigid motions, order of convergence
Checks check_hertz(bool quick);     ///< half-space contacts, circular and elliptic, published ones
Checks check_layer(bool quick);     ///< bonded layers of any thickness, and their limits
Checks check_friction(bool quick);  ///< torsion and tangential load, stick to slip
Checks check_invariance(bool quick);  ///< units, symmetries, equilibrium

}  // namespace softfinger::fem::verification
