#pragma once

#include "fem/base/progress.h"
#include "fem/pad/pad_problem.h"
#include "fem/pad/pad_result.h"

namespace softfinger::fem {

/// Solves a rectangular pad, a block of rubber of thickness h bonded to a rigid backing with free
/// side walls, that a rigid curved object presses without friction, in linear elasticity. The
/// object moves along the normal and does not turn.
///
/// Coarse meshes find how far the contact reaches; two finer ones around it are solved, that of
/// `level` and the next coarser one, and errors are told by their difference.
/// @throws InputError for what is not solved for, and values out of range
/// @throws ConvergenceError, Interrupted
PadResult solve_curved_object(const PadProblem& problem, const Progress& progress,
                              const StopRequested& stop);

}  // namespace softfinger::fem
