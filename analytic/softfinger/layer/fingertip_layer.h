#pragma once

#include "softfinger/input/contact_problem.h"
#include "softfinger/layer/contact_numbers.h"

namespace softfinger {

/// Contact of a rigid quadric with a neo-Hookean layer of even thickness on the rigid core of a
/// curved finger, at finite strain: `bonded_layer_contact` times exp of corrections that vanish
/// with h/R and d/h, fitted to finite-element runs (fingertip_layer_core.h). Of `problem` it takes
/// the radii of the gap, the finger's own curvature, the layer and the load.
///
/// The arguments must lie in the ranges of contact_problem.h; results that do not fit into a double
/// come out as zero or infinity. Cost: about 0.4 microseconds, no allocation.
ContactNumbers fingertip_layer_contact(const ContactProblem& problem) noexcept;

}  // namespace softfinger
