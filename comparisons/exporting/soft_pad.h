#pragma once

#include "comparisons/exporting/simulator.h"
#include "softfinger/pads/pad_model.h"

namespace softfinger::exporting {

/// A flat pad's contact at the problem's load, by a model; its origin is left empty.
SoftContact soft_pad(const PadModel& model, const PadProblem& problem,
                     const PadPrediction& prediction);

}  // namespace softfinger::exporting
