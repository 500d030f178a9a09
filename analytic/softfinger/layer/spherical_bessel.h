#pragma once

#include <algorithm>
#include <cmath>

namespace softfinger {

/// Spherical Bessel functions of one parity: j_p, j_{p+2}, ..., j_{p+2l} of q >= 0 into `values`
/// (l + 1 of them), `parity` p = 0 or 1. Error about 1e-15. O(l) operations, no allocation.
inline void spherical_bessel(double q, int parity, int l, double* values) {
  const int order = 2 * l + parity;
  if (q > order + 1) {  // upwards: stable where the functions oscillate
    const double s = std::sin(q), c = std::cos(q);
    double previous = s / q, value = s / (q * q) - c / q;
    values[0] = parity ? value : previous;
    for (int n = 1; n < order; ++n) {
      const double next = (2 * n + 1) / q * value - previous;
      previous = value;
      value = next;
      if ((n + 1) % 2 == parity) values[(n + 1) / 2] = next;
    }
    return;
  }
  if (q < 1e-8) {
    values[0] = parity ? q / 3 : 1;
    std::fill(values + 1, values + l + 1, 0.0);
    return;
  }
  // Miller's algorithm: downwards from an order where they are negligible, far enough above for 16
  // digits (the rule of Numerical Recipes' bessj), then scaled to j_0 or j_1. Values are kept
  // between 1e-280 and 1e200, whatever the starting value grows to.
  const int start = order + 20 + int(std::sqrt(40.0 * (order + 1)));
  double above = 0, value = 1e-280;
  for (int n = start; n >= 1; --n) {
    const double below = (2 * n + 1) / q * value - above;
    above = value;
    value = below;
    if (std::abs(value) > 1e200) {
      const double shrink = 1e-250;
      value *= shrink;
      above *= shrink;
      for (int i = (n - parity + 1) / 2; i <= l; ++i) values[i] *= shrink;
    }
    if ((n - 1) % 2 == parity && n - 1 <= order) values[(n - 1) / 2] = value;
  }
  const double j0 = std::sin(q) / q;  // `value` is in proportion to it, `above` to j_1
  const double j1 =
      q < 0.1 ? q / 3 * (1 - q * q / 10 * (1 - q * q / 28)) : (std::sin(q) / q - std::cos(q)) / q;
  const double scale = std::abs(j0) > std::abs(j1) ? j0 / value : j1 / above;
  for (int i = 0; i <= l; ++i) values[i] *= scale;
}

}  // namespace softfinger
