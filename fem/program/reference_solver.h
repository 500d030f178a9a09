#pragma once

#include "fem/base/progress.h"
#include "fem/problem/problem.h"
#include "fem/problem/result.h"

/// The finite-element reference: a rigid object pressed on an elastic layer that is bonded to a
/// rigid core, then twisted and shifted with friction. Nothing in this header depends on the
/// finite-element library. Nothing behind it depends on the analytic models: a reference must be
/// independent of what is compared with it.
namespace softfinger::fem {

class ModelCache;

/// @param cache  of the caller's run (model_cache.h); null: nothing is kept
/// @throws InputError for a problem outside the ranges (nu > 1/2, load <= 0, a contact wider than
/// the gap's model can bear, ...)
/// @throws ConvergenceError with stage, iteration, residual and hint.
/// @throws Interrupted
Result solve(
    const Problem& problem, const Progress& progress,
    const StopRequested& stop = [] { return false; }, ModelCache* cache = nullptr);

}  // namespace softfinger::fem
