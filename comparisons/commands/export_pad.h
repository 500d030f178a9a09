#pragma once

#include "comparisons/commands/contact_choice.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/input/case.h"

namespace softfinger::commands {

/// `softfinger export` of a flat pad: the lines for a box whose corners have the pad's torque, and
/// for one contact point in its middle. Torque over load does not depend on the load.
/// @param meters_per_unit  of a USD stage
/// @return exit status
/// @throws InputError for a model of curved contacts, and for a range of loads
int export_pad(const exporting::Simulator& simulator, const input::Case& contact_case,
               const ContactChoice& choice, double meters_per_unit, bool json);

}  // namespace softfinger::commands
