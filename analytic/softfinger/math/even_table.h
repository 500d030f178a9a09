#pragma once

#include <cstdlib>
#include <vector>

namespace softfinger {

/// Value of an even function between its samples at 0, 1, 2, ..: the polynomial through the six
/// nearest.
/// @param u  in steps, 0 <= u; the table goes on for at least three steps beyond it
inline double at_even_table(const std::vector<double>& table, double u) {
  const int i = static_cast<int>(u);
  const double z = u - i;
  const auto at = [&](int j) { return table[static_cast<std::size_t>(std::abs(i + j))]; };
  const double m2 = z + 2, m1 = z + 1, p1 = z - 1, p2 = z - 2, p3 = z - 3;
  return -m1 * z * p1 * p2 * p3 / 120 * at(-2) + m2 * z * p1 * p2 * p3 / 24 * at(-1) -
         m2 * m1 * p1 * p2 * p3 / 12 * at(0) + m2 * m1 * z * p2 * p3 / 12 * at(1) -
         m2 * m1 * z * p1 * p3 / 24 * at(2) + m2 * m1 * z * p1 * p2 / 120 * at(3);
}

}  // namespace softfinger
