#pragma once

#include <Eigen/Core>

#include "softfinger/dynamics/contacts/contact_operator.h"

/// Internal: impulses close to those of a problem that no path solves.
namespace softfinger::internal {

/// Non-smooth Gauss-Seidel (Jean, Comput. Methods Appl. Mech. Eng. 177, 1999): contact by contact,
/// the normal impulse and then the friction that keep its law while all others stay as they are,
/// forwards and backwards in turn. Repeated contacts do not trouble it, but it converges slowly.
/// @param impulse   scaled; improved
/// @param velocity  room for 4 rows per contact
void sweep(const ContactOperator& contacts, int sweeps, Eigen::VectorXd& impulse,
           Eigen::VectorXd& velocity);

}  // namespace softfinger::internal
