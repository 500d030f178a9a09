#pragma once

#include "fem/levels/unsolved.h"

namespace softfinger::fem {

/// Solves a contact, whatever its physics, on two meshes that tell its error:
///   1. trial meshes, each pressed and made anew, until mesh and contact agree in size;
///   2. two levels, the elements per semi-axis doubled between them, each discretised, pressed,
///      measured and rubbed, with the contact's edge on cell edges;
///   3. the stated error from their difference (error_model.h).
///
/// When it is stopped after its first level, the last trial mesh takes the coarse level's place.
/// Times and memory of the result are left to the caller.
/// @throws InputError, ConvergenceError, Interrupted
Outcome<Result, Unsolved> solve_on_levels(ContactPhysics& physics, const ContactTask& task);

}  // namespace softfinger::fem
