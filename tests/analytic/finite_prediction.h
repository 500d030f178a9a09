#pragma once

#include <gtest/gtest.h>

#include "softfinger/pressure/soundness.h"

namespace softfinger::testing {

using softfinger::is_sound;

/// `is_sound` as an assertion whose message shows the numbers.
inline ::testing::AssertionResult is_finite_and_consistent(const Prediction& prediction) {
  return is_sound(prediction) ? ::testing::AssertionSuccess()
                              : ::testing::AssertionFailure()
                                    << "a = " << prediction.a_m << " b = " << prediction.b_m
                                    << " d = " << prediction.indentation_m
                                    << " p0 = " << prediction.peak_pressure_Pa
                                    << " arm = " << prediction.torque_arm_exact_m;
}

}  // namespace softfinger::testing
