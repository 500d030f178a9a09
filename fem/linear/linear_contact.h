#pragma once

#include "fem/levels/level_loop.h"
#include "fem/linear/model_cache.h"

namespace softfinger::fem {

/// The answer of `fem::solve` in linear elasticity. Where the meshes of an earlier contact of the
/// run serve, the contact is answered on them.
/// @param models  of the run; what this contact leaves behind is added
/// @throws InputError, ConvergenceError, Interrupted, NotEnoughMemory
Outcome<Result, Unsolved> solve_linear(const ContactTask& task, ModelCache& models);

}  // namespace softfinger::fem
