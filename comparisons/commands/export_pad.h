#pragma once

#include "comparisons/commands/contact_choice.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/input/case.h"

namespace softfinger::commands {

/// `softfinger export` of a flat pad: the lines for one contact point in the pad's middle, whose
/// torque over load does not depend on the load. For MuJoCo so far.
/// @return exit status
/// @throws InputError for another simulator, and for a model of curved contacts
int export_pad(const exporting::Simulator& simulator, const input::Case& contact_case,
               const ContactChoice& choice, bool json);

}  // namespace softfinger::commands
