#pragma once

#include <string>

#include "softfinger/calibration/calibrate.h"

namespace softfinger::calibration {

/// A sentence for a Young's modulus or a friction coefficient that no soft fingertip has: the
/// numbers of the file are then rarely in the units of its columns. It names the units that give
/// plausible values, where one of the usual mistakes does: loads in g, kg or mN, lengths in m,
/// diameters in place of semi-axes, torques in N·m. Empty where the fit is plausible.
/// Cost: none for a plausible fit, else that of some ten further ones.
std::string unit_doubt(const CalibrationProblem& problem, const Calibration& found);

/// "Taken as g, the loads give E = 556 kPa and mu = 0.8.", for each of the usual mistakes after
/// which some model explains the data with plausible values; empty: none does.
std::string better_units(const CalibrationProblem& problem);

}  // namespace softfinger::calibration
