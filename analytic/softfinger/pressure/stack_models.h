#pragma once

#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// Whether the model is made for stacks of sublayers and layers on both bodies: fast, and for one
/// layer it repeats the answer of `bonded_layer`, so that lists of answers for one layer leave it
/// out.
inline bool is_for_stacks(const PressureModel& model) noexcept {
  return model.knows_stacks() && model.card().hot_path;
}

}  // namespace softfinger
