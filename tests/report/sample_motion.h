#pragma once

#include "comparisons/simulation/recording.h"

namespace softfinger::tests {

/// Two fingers grip a box on a table, lift it and let it turn between them until they slide.
/// Plausible numbers, not simulated: files and page must not depend on how a motion came about.
/// Has soft contacts with elongated ellipses, point contacts that end, and a half-space.
simulation::Recording sample_motion(int steps = 400);

/// The largest motion that the page must carry in full size: 1,800 steps, 27 bodies, among them
/// finely meshed fingertips and an object, and up to 14 contacts.
simulation::Recording large_motion();

/// The largest motion with the fingers moving 1.5 m sideways meanwhile: far more than the objects
/// are large.
simulation::Recording far_motion();

/// Degenerate motions that a page must survive.
simulation::Recording motion_without_contacts();
simulation::Recording motion_of_one_frame();
simulation::Recording empty_motion();

}  // namespace softfinger::tests
