#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "softfinger/pressure/pressure_model.h"

namespace softfinger::testing {

/// Whether every number of a prediction is finite, those of an answer normal and positive, and a
/// missing answer explained by a check that fails.
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

/// The same with the numbers, for a message.
inline ::testing::AssertionResult is_finite_and_consistent(const Prediction& prediction) {
  return is_sound(prediction) ? ::testing::AssertionSuccess()
                              : ::testing::AssertionFailure()
                                    << "a = " << prediction.a_m << " b = " << prediction.b_m
                                    << " d = " << prediction.indentation_m
                                    << " p0 = " << prediction.peak_pressure_Pa
                                    << " arm = " << prediction.torque_arm_exact_m;
}

}  // namespace softfinger::testing
