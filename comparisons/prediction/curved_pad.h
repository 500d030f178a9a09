#pragma once

#include "comparisons/input/case.h"

namespace softfinger::prediction {

/// The case of an object that is curved in both directions on a flat pad, as the ordinary contact
/// of that object on a layer without an end: right where the ellipse at the largest load stays
/// three thicknesses inside of the pad.
/// @pre the case's geometry is a pad under a sphere or another quadric
/// @throws InputError where the pad's own ends count, which finite elements answer
input::Case without_ends(const input::Case& contact_case);

}  // namespace softfinger::prediction
