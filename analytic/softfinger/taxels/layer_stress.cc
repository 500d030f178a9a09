#include "softfinger/taxels/layer_stress.h"

#include <cmath>

namespace softfinger::taxels {

LayerStress::Wave LayerStress::stress(double x) const noexcept {
  const double y = x * depth_;
  const Wave more = excess(x);
  return {more.normal + (1 + y) * std::exp(-y), more.shear + y * std::exp(-y)};
}

LayerStress::Terms LayerStress::terms(double x) const noexcept {
  const double H = x, y = x * depth_, kappa2 = kappa_ * kappa_;
  const double decay = std::exp(-2 * H), up = std::exp(y - 2 * H), down = std::exp(-y);
  return {H,
          y,
          decay,
          up,
          down,
          0.5 * (up + decay * down),
          0.5 * (up - decay * down),
          4 * H * (H - y),
          decay * (4 * H * H + 1 + kappa2),
          kappa_ * (1 + decay * decay) + decay * (4 * H * H + 1 + kappa2)};
}

LayerStress::Wave LayerStress::excess(double x) const noexcept {
  const auto [H, y, decay, up, down, cosh_y, sinh_y, from_base, all, denominator] = terms(x);
  const double kappa2 = kappa_ * kappa_;
  const double normal = kappa_ * decay * ((1 - y) * up - (1 + y) * decay * down) +
                        (1 + kappa2 + from_base) * cosh_y + 2 * (2 * H - y) * sinh_y -
                        (1 + y) * down * all;
  const double shear = 2 * kappa_ * y * decay * sinh_y + 2 * y * cosh_y -
                       (kappa2 - 1 + from_base) * sinh_y - y * down * all;
  return {normal / denominator, shear / denominator};
}

LayerStress::ShearWave LayerStress::shear_excess(double x) const noexcept {
  const auto [H, y, decay, up, down, cosh_y, sinh_y, from_base, all, denominator] = terms(x);
  const double kappa2 = kappa_ * kappa_;
  const double normal = 2 * kappa_ * y * decay * sinh_y + 2 * y * cosh_y +
                        (kappa2 - 1 + from_base) * sinh_y - y * down * all;
  const double along = kappa_ * decay * ((1 + y) * up - (1 - y) * decay * down) +
                       (1 + kappa2 + from_base) * cosh_y - 2 * (2 * H - y) * sinh_y -
                       (1 - y) * down * all;
  return {normal / denominator, along / denominator, 2 * sinh_y / (1 + decay)};
}

double LayerStress::lift(double x) const noexcept {
  const Terms wave = terms(x);
  const double rise = std::expm1(-2 * x);
  return (0.25 * kappa_ * (kappa_ - 1) * rise * rise - 2 * x * x * wave.decay) / wave.denominator;
}

}  // namespace softfinger::taxels
