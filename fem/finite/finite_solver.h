#pragma once

#include "fem/pressing.h"
#include "fem/reference_solver.h"

namespace softfinger::fem::finite {

/// The answer of `fem::solve` at finite strain: two meshes with the contact's edge on cell edges,
/// their difference for an error.
/// @param problem   checked, with `finite_strain`
/// @param pressing  the same in units of the layer
/// @throws InputError for what finite strain does not have: partial slip on the way to the limit
/// surface, twists about another axis than the centre's; ConvergenceError with the load that was
/// reached; Interrupted
Result solve_finite(const Problem& problem, const Pressing& pressing, const Progress& progress,
                    const StopRequested& stop);

}  // namespace softfinger::fem::finite
