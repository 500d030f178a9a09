#include "softfinger/pads/pad_law.h"

#include <algorithm>
#include <cmath>

namespace softfinger::pads {

double lift_off_factor(double size_m, double half_extent_m, const ElasticLayer& layer,
                       bool is_frictionless) noexcept {
  const double nu = layer.poisson_ratio, x = half_extent_m / layer.thickness_m;
  // A stuck rim presses more, a frictionless one less than the column there.
  if (!is_frictionless) return 1 + (1.055 * nu - 0.08) / (1 + 0.4334 * x);
  const double s = size_m / layer.thickness_m;
  return std::max(0.05, 1 - nu * (0.2703 + 0.7152 * nu) * s * std::pow(s / x, 0.186) /
                                (1 + 0.8574 * (1 - 2 * nu) * s * s));
}

}  // namespace softfinger::pads
