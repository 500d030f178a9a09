#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/experiments/examine.h"

namespace softfinger::experiments {

void examine_repeated(const Repeated& repeated, Examined& examined) {
  double least = INFINITY, largest = 0, sum = 0;
  int count = 0, outliers = 0;
  for (const Repeated::Pair& pair : repeated.pairs) {
    if (pair.outlier) {
      ++outliers;
      continue;
    }
    const auto& [left_m, right_m] = pair.eccentricity_m;
    const double difference = 2 * std::abs(left_m - right_m) / (left_m + right_m);
    least = std::min(least, difference);
    largest = std::max(largest, difference);
    sum += difference;
    ++count;
  }
  examined.inferred.push_back({"noise_floor",
                               "%",
                               "difference of the two fingers over their mean",
                               {sum / count, least, largest}});
  examined.sentence = fmt::format(
      "The two fingers of one gripper differ by {:.0f} to {:.0f} % on {} objects{}: measured in "
      "hand, a torque is not known better, however precise the theory.",
      100 * least, 100 * largest, count,
      outliers > 0 ? fmt::format(" ({} left out as an outlier)", outliers) : "");
}

}  // namespace softfinger::experiments
