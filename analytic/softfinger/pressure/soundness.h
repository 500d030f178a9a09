#pragma once

#include <cmath>
#include <limits>

#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// The invariants of every prediction, whatever a model is asked: all numbers are finite, those of
/// an answer are normal and positive, and a missing answer is explained by a check that fails.
inline bool is_sound(const Prediction& prediction) {
  bool sound = prediction.a_m >= prediction.b_m;
  for (const double value :
       {prediction.a_m, prediction.b_m, prediction.indentation_m, prediction.peak_pressure_Pa,
        prediction.torque_arm_exact_m, prediction.torque_arm_paper_m, prediction.area_m2()})
    sound = sound && std::isfinite(value) &&
            (prediction.has_answer ? value >= std::numeric_limits<double>::min() : value == 0);
  for (const ValidityCheck& check : prediction.validity)
    sound = sound && std::isfinite(check.value) && std::isfinite(check.limit) && *check.check &&
            *check.message;
  return sound && (prediction.has_answer || !prediction.validity.holds());
}

}  // namespace softfinger
