#include "softfinger/friction/tilt_limit.h"

#include <cmath>

#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

/// beta - sin beta cos beta, without the difference of equal numbers near 0.
double segment_area(double beta) noexcept {
  if (beta > 0.1) return beta - std::sin(beta) * std::cos(beta);
  // (2 beta - sin 2 beta)/2, by the series of the sine
  const double z = 2 * beta, z2 = z * z;
  return z * z2 / 12 * (1 - z2 / 20 * (1 - z2 / 42 * (1 - z2 / 72 * (1 - z2 / 110))));
}

/// Distance of the segment's centre of area from that of the unit circle.
double segment_arm(double peak_ratio) noexcept {
  if (!(peak_ratio > 1)) return 0;
  if (!std::isfinite(peak_ratio)) return 1;
  double low = 0, high = kPi;
  for (int i = 0; i < 100 && high - low > 0; ++i) {
    const double middle = 0.5 * (low + high);
    (segment_area(middle) * peak_ratio < kPi ? low : high) = middle;
  }
  const double beta = 0.5 * (low + high), sine = std::sin(beta);
  return 2. / 3 * sine * sine * sine / segment_area(beta);
}

}  // namespace

double TiltLimit::utilisation(double moment_x_Nm, double moment_y_Nm) const noexcept {
  const auto part = [](double moment, double limit) {
    return moment == 0 ? 0 : std::abs(moment) / limit;
  };
  return std::hypot(part(moment_x_Nm, about_x_Nm), part(moment_y_Nm, about_y_Nm));
}

TiltLimit tilt_limit(double a_m, double b_m, double load_N, double peak_ratio) noexcept {
  const double arm = segment_arm(peak_ratio) * load_N;
  return {b_m * arm, a_m * arm};
}

}  // namespace softfinger
