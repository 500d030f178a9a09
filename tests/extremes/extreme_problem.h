#pragma once

#include <gtest/gtest.h>

#include <string>

#include "comparisons/extremes/extreme_problem.h"

namespace softfinger::testing {

using extremes::difference;
using extremes::ExtremeProblems;
using extremes::in_units;
using extremes::in_words;

/// A model's name as a test's.
inline std::string model_test_name(
    const ::testing::TestParamInfo<const PressureModel*>& information) {
  return std::string(information.param->card().name);
}

}  // namespace softfinger::testing
