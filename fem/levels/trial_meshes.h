#pragma once

#include "fem/levels/unsolved.h"

namespace softfinger::fem {

/// The result of pressing trial meshes.
struct Trial {
  LayerDiscretisation mesh;  ///< made for the contact, for the levels to start from
  int refinement = 1;        ///< of the trial meshes, over the usual one
  Measurement contact;       ///< on the last of them
};

/// Presses trial meshes, each made anew, until mesh and contact agree in size. Where the physics
/// shares meshes it measures the contact on the coarser one.
/// @throws InputError, ConvergenceError, Interrupted
Outcome<Trial, Unsolved> find_trial(ContactPhysics& physics, const ContactTask& task);

}  // namespace softfinger::fem
