#pragma once

#include "fem/levels/contact_physics.h"

namespace softfinger::fem::finite {

/// The answer of `fem::solve` at finite strain.
/// @param task  its problem is checked and has `finite_strain`
/// @throws InputError, ConvergenceError with the load that was reached, Interrupted, OffCentre
Result solve_finite(const ContactTask& task);

}  // namespace softfinger::fem::finite
