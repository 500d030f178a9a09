#include "comparisons/experiments/hardness_relations.h"

#include <algorithm>
#include <cmath>

namespace softfinger::experiments {

double modulus_of_shore_a_Pa(double shore_a) {
  return 1e6 * 0.0981 * (56 + 7.62336 * shore_a) / (0.137505 * (254 - 2.54 * shore_a));
}

double shore_a_of_modulus(double youngs_modulus_Pa) {
  const double E_MPa = youngs_modulus_Pa * 1e-6;
  const double typed =
      (0.137505 * 254 * E_MPa - 0.0981 * 56) / (0.0981 * 7.62336 + 0.137505 * 2.54 * E_MPa);
  return std::clamp(typed, 0., 100.);
}

double modulus_of_shore_oo_Pa(double shore_oo, double poisson_ratio) {
  constexpr double kRadius_m = 1.19e-3, kTravel_m = 2.54e-3;
  const double depth_m = kTravel_m * (1 - shore_oo / 100);
  const double force_N = 0.203 + 0.00908 * shore_oo;
  return 0.75 * (1 - poisson_ratio * poisson_ratio) * force_N /
         (std::sqrt(kRadius_m) * std::pow(depth_m, 1.5));
}

double shore_oo_of_modulus(double youngs_modulus_Pa, double poisson_ratio) {
  // The modulus grows with the hardness, to infinity at 100.
  double low = 0, high = 100;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (modulus_of_shore_oo_Pa(middle, poisson_ratio) < youngs_modulus_Pa ? low : high) = middle;
  }
  return (low + high) / 2;
}

}  // namespace softfinger::experiments
