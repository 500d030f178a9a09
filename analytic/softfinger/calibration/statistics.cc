#include "softfinger/calibration/statistics.h"

#include <cmath>

#include "softfinger/input/constants.h"

namespace softfinger::statistics {

// Abramowitz and Stegun, Handbook of Mathematical Functions, 26.7.3 and 26.7.4: finite sums in the
// angle whose tangent is t / sqrt(freedom).
double student_two_sided(double t, double freedom) noexcept {
  constexpr double kNormalFrom =
      1000;  // Beyond it the normal distribution is right to 1e-3 of a tail.
  if (!(freedom < kNormalFrom)) return std::erfc(std::abs(t) / std::sqrt(2.));
  const int n = int(freedom);
  const double angle = std::atan(std::abs(t) / std::sqrt(double(n)));
  const double sine = std::sin(angle), cosine = std::cos(angle), square = cosine * cosine;
  double sum = 0, term = n % 2 == 1 ? cosine : 1;
  for (int i = n % 2 == 1 ? 3 : 2; i <= n; i += 2) {
    sum += term;
    term *= square * (i - 1) / i;
  }
  const double inside = n % 2 == 1 ? 2 / kPi * (angle + sine * sum) : sine * sum;
  return 1 - inside;
}

double student_quantile(double probability, double freedom) noexcept {
  double low = 0, high = 1;
  while (student_two_sided(high, freedom) > probability && high < 1e12) high *= 2;
  for (int i = 0; i < 200 && high - low > 1e-13 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (student_two_sided(middle, freedom) > probability ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Same source, 26.4.4 and 26.4.5: a Poisson sum for even degrees of freedom; for odd ones the tail
// of the normal distribution plus a sum.
double chi_squared_exceeds(double value, int freedom) noexcept {
  if (!(value > 0)) return 1;
  const bool odd = freedom % 2 == 1;
  double term = odd ? std::sqrt(2 * value / kPi) * std::exp(-0.5 * value) : std::exp(-0.5 * value);
  double sum = odd ? std::erfc(std::sqrt(0.5 * value)) : term;
  if (odd && freedom >= 3) sum += term;
  for (int i = odd ? 3 : 2; i + 2 <= freedom; i += 2) {
    term *= value / i;
    sum += term;
  }
  return sum < 1 ? sum : 1;
}

}  // namespace softfinger::statistics
