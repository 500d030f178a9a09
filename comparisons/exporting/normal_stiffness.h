#pragma once

#include <cmath>

namespace softfinger::exporting {

/// Ratio of neighbouring loads in central differences in ln P: large against the unevenness of the
/// models' tables and small enough for a local exponent.
constexpr double kLoadStep = 1.1;

/// dP/dd = P/(n d), n the exponent of d in P. Exact for a power law, unlike a difference of P over
/// one of d.
/// @param indentation_m   at the load
/// @param below_m, above_m  the same at the load over and times kLoadStep
inline double normal_stiffness_N_per_m(double load_N, double indentation_m, double below_m,
                                       double above_m) {
  const double exponent = std::log(above_m / below_m) / (2 * std::log(kLoadStep));
  return load_N / (exponent * indentation_m);
}

}  // namespace softfinger::exporting
