#include "softfinger/friction/friction_ellipsoid.h"

#include <cmath>
#include <limits>

namespace softfinger {
namespace {

/// |load| / limit, where a vanishing limit carries nothing.
double fraction(double load, double limit) {
  if (limit > 0) return std::abs(load) / limit;
  return load == 0 ? 0 : std::numeric_limits<double>::infinity();
}

}  // namespace

double FrictionEllipsoid::utilisation(double force_x_N, double force_y_N,
                                      double torque_Nm) const noexcept {
  // In two steps: the three-argument function of some standard libraries turns infinity into NaN.
  return std::hypot(std::hypot(fraction(force_x_N, max_force_N), fraction(force_y_N, max_force_N)),
                    fraction(torque_Nm, max_torque_Nm()));
}

std::vector<LimitWrench> sample_section(const FrictionEllipsoid& ellipsoid, double direction_rad,
                                        int count) {
  constexpr double kTwoPi = 6.28318530717958647692;
  std::vector<LimitWrench> section(count > 0 ? count : 0);
  for (int i = 0; i < count; ++i) {
    const double angle = kTwoPi * i / count;
    const double force_N = ellipsoid.max_force_N * std::cos(angle);
    section[i] = {force_N * std::cos(direction_rad), force_N * std::sin(direction_rad),
                  ellipsoid.max_torque_Nm() * std::sin(angle)};
  }
  return section;
}

}  // namespace softfinger
