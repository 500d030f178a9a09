#include "softfinger/taxels/layer_stress.h"

#include <cmath>

namespace softfinger::taxels {

LayerStress::Wave LayerStress::stress(double x) const noexcept {
  const double y = x * depth_;
  const Wave more = excess(x);
  return {more.normal + (1 + y) * std::exp(-y), more.shear + y * std::exp(-y)};
}

LayerStress::Wave LayerStress::excess(double x) const noexcept {
  // Everything is divided by exp(2H), so that nothing overflows.
  const double H = x, y = x * depth_, kappa2 = kappa_ * kappa_;
  const double decay = std::exp(-2 * H), up = std::exp(y - 2 * H), down = std::exp(-y);
  const double cosh_y = 0.5 * (up + decay * down), sinh_y = 0.5 * (up - decay * down);
  const double denominator = kappa_ * (1 + decay * decay) + decay * (4 * H * H + 1 + kappa2);
  const double from_base = 4 * H * (H - y), all = decay * (4 * H * H + 1 + kappa2);
  const double normal = kappa_ * decay * ((1 - y) * up - (1 + y) * decay * down) +
                        (1 + kappa2 + from_base) * cosh_y + 2 * (2 * H - y) * sinh_y -
                        (1 + y) * down * all;
  const double shear = 2 * kappa_ * y * decay * sinh_y + 2 * y * cosh_y -
                       (kappa2 - 1 + from_base) * sinh_y - y * down * all;
  return {normal / denominator, shear / denominator};
}

}  // namespace softfinger::taxels
