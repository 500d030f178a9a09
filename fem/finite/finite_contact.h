#pragma once

#include "fem/levels/level_loop.h"

namespace softfinger::fem::finite {

/// The answer of `fem::solve` at finite strain.
/// @param task  its problem is checked and has `finite_strain`
/// @throws InputError, ConvergenceError with the load that was reached, Interrupted
Outcome<Result, Unsolved> solve_finite(const ContactTask& task);

}  // namespace softfinger::fem::finite
