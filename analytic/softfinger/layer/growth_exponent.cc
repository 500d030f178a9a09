#include "softfinger/layer/growth_exponent.h"

#include <algorithm>
#include <cmath>

#include "softfinger/layer/circular_contact.h"

namespace softfinger {
namespace {

constexpr double kSmallestSize = 0.05, kLargestSize = 20;
constexpr double kLogSizeStep = 0.3;  ///< gamma has one minimum over ln s, several steps wide

/// Solves the contact with h = 1 and R = 1: P/(E* h²) of any other radius is this times h/R.
CircularLayerContact unit_contact(double s, double poisson_ratio) {
  return circular_layer_contact(s, 1, {{LayerKernel(poisson_ratio), 1, 1}});
}

}  // namespace

double layer_growth_exponent(double s, double poisson_ratio, Growing what) {
  // The truncation is of the order of the step's square, the rounding that of 1e-10 over the step.
  constexpr double kLogStep = 1e-3;
  const CircularLayerContact small = unit_contact(s * std::exp(-kLogStep), poisson_ratio),
                             large = unit_contact(s * std::exp(kLogStep), poisson_ratio);
  const double growth =
      what == Growing::radius ? large.a_m / small.a_m : large.torque_arm_m / small.torque_arm_m;
  return std::log(growth) / std::log(large.load_over_modulus_m2 / small.load_over_modulus_m2);
}

std::optional<double> layer_size_of_exponent(double exponent, double poisson_ratio, Growing what) {
  // The excess of gamma over ln s, which falls; the first interval in which it changes its sign.
  const auto excess = [&](double log_s) {
    return layer_growth_exponent(std::exp(log_s), poisson_ratio, what) - exponent;
  };
  const double last = std::log(kLargestSize);
  double low = std::log(kSmallestSize), high = low;
  double at_low = excess(low), at_high = at_low;
  if (!(at_low >= 0)) return std::nullopt;
  while (at_high > 0) {
    if (high >= last) return std::nullopt;
    low = high, at_low = at_high;
    high = std::min(high + kLogSizeStep, last);
    at_high = excess(high);
  }
  // False position, with the value of an end that stays halved (Illinois). gamma is known to 1e-6.
  constexpr double kTolerance = 1e-7;
  double log_s = high, found = at_high;
  for (int i = 0, side = 0; i < 50 && std::abs(found) > kTolerance; ++i) {
    log_s = (low * at_high - high * at_low) / (at_high - at_low);
    found = excess(log_s);
    if (found > 0) {
      low = log_s, at_low = found;
      if (side == 1) at_high /= 2;
      side = 1;
    } else {
      high = log_s, at_high = found;
      if (side == -1) at_low /= 2;
      side = -1;
    }
  }
  return std::exp(log_s);
}

double smallest_layer_exponent(double poisson_ratio) {
  // Down to s = 1, gamma only falls.
  double smallest = 1;
  for (double log_s = 0; log_s <= std::log(kLargestSize); log_s += kLogSizeStep)
    smallest = std::min(smallest, layer_growth_exponent(std::exp(log_s), poisson_ratio));
  return smallest;
}

MatchedLayer match_layer(double s, double a_m, double normal_force_N, double radius_m,
                         double poisson_ratio) {
  const CircularLayerContact contact = unit_contact(s, poisson_ratio);
  const double h = a_m / s;
  const double plane_strain_modulus_Pa =
      normal_force_N * radius_m / (contact.load_over_modulus_m2 * h * h * h);
  return {h, plane_strain_modulus_Pa * (1 - poisson_ratio * poisson_ratio),
          contact.torque_arm_m / s};
}

}  // namespace softfinger
