#include "softfinger/layer/growth_exponent.h"

#include <algorithm>
#include <cmath>

#include "softfinger/layer/circular_contact.h"

namespace softfinger {
namespace {

constexpr double kSmallestSize = 0.05, kLargestSize = 20;
constexpr double kSizeStep = 1.25;  ///< ratio; gamma has one minimum, several steps wide

/// With h = 1 and R = 1: P/(E* h²) of any other radius is this times h/R.
CircularLayerContact unit_contact(double s, double poisson_ratio) {
  return circular_layer_contact(s, 1, {{LayerKernel(poisson_ratio), 1, 1}});
}

}  // namespace

double layer_growth_exponent(double s, double poisson_ratio) {
  // The truncation is of the order of the step's square, the rounding that of 1e-10 over the step.
  constexpr double kStep = 1e-3;
  const auto load = [&](double size) {
    return unit_contact(size, poisson_ratio).load_over_modulus_m2;
  };
  return 2 * kStep / std::log(load(s * std::exp(kStep)) / load(s * std::exp(-kStep)));
}

std::optional<double> layer_size_of_exponent(double exponent, double poisson_ratio) {
  double low = kSmallestSize, high = low;
  if (!(layer_growth_exponent(low, poisson_ratio) >= exponent)) return std::nullopt;
  do {
    if (high >= kLargestSize) return std::nullopt;
    low = high;
    high = std::min(high * kSizeStep, kLargestSize);
  } while (layer_growth_exponent(high, poisson_ratio) > exponent);
  // Bisection of ln s, down to the error of gamma itself.
  for (int i = 0; i < 20; ++i) {
    const double middle = std::sqrt(low * high);
    (layer_growth_exponent(middle, poisson_ratio) > exponent ? low : high) = middle;
  }
  return std::sqrt(low * high);
}

double smallest_layer_exponent(double poisson_ratio) {
  double smallest = 1;
  for (double s = kSmallestSize; s <= kLargestSize; s *= kSizeStep)
    smallest = std::min(smallest, layer_growth_exponent(s, poisson_ratio));
  return smallest;
}

std::optional<MatchedLayer> match_layer(double exponent, double a_m, double normal_force_N,
                                        double radius_m, double poisson_ratio) {
  const auto s = layer_size_of_exponent(exponent, poisson_ratio);
  if (!s) return std::nullopt;
  const CircularLayerContact contact = unit_contact(*s, poisson_ratio);
  const double h = a_m / *s;
  const double plane_strain_modulus_Pa =
      normal_force_N * radius_m / (contact.load_over_modulus_m2 * h * h * h);
  return MatchedLayer{*s, h, plane_strain_modulus_Pa * (1 - poisson_ratio * poisson_ratio),
                      contact.torque_arm_m / *s};
}

}  // namespace softfinger
