#pragma once

#include <vector>

#include "fem/levels/contact_physics.h"

namespace softfinger::fem {

/// Whether what lies beyond the layer's side wall may change the contact.
bool wall_is_near(const LayerDiscretisation& mesh);

/// Half of what a clamped side wall changes, from the free one: a free wall yields too much, a
/// clamped one too little.
/// @param mesh   of the level
/// @param free   its answer
/// @param press  starts from its state
/// @throws InputError, ConvergenceError
Outcome<WallChange, Obstacle> measure_wall(const ContactTask& task, LayerDiscretisation mesh,
                                           const LevelResult& free,
                                           const ContactPhysics::PressOther& press);

/// Corrects a level for the wall.
void correct_wall(const WallChange& wall, LevelResult& level);

}  // namespace softfinger::fem
