#pragma once

#include <algorithm>
#include <vector>

#include "softfinger/input/constants.h"

namespace softfinger::judgement {

/// The median; of an even number of values the mean of the middle two, of none NaN. No value may be
/// NaN.
inline double median(std::vector<double> values) {
  if (values.empty()) return kNaN;
  const auto middle = values.begin() + long(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2) return *middle;
  return (*std::max_element(values.begin(), middle) + *middle) / 2;
}

}  // namespace softfinger::judgement
