#include "softfinger/friction/ellipsoid_deviation.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace softfinger {
namespace {

constexpr double kHalfPi = 1.57079632679489661923;

/// The point of the surface for a slip of direction `heading` and share `turning` of rotation, both
/// angles from 0 to pi/2, and the ellipsoid's deviation there.
struct Slip {
  double heading = 0, turning = 0;
  Twist twist;
  LimitWrench wrench;
  double deviation = 0;
};

template <class Surface>
Slip slip_at(const Surface& surface, const FrictionEllipsoid& ellipsoid, double heading,
             double turning) noexcept {
  const double sliding = std::cos(turning);
  Slip slip;
  slip.heading = heading;
  slip.turning = turning;
  slip.twist = {sliding * std::cos(heading), sliding * std::sin(heading),
                std::sin(turning) / surface.eccentricity_m()};
  slip.wrench = surface.wrench_for_twist(slip.twist);
  slip.deviation =
      ellipsoid.utilisation(slip.wrench.force_x_N, slip.wrench.force_y_N, slip.wrench.torque_Nm) -
      1;
  return slip;
}

constexpr int kHeadings = 12, kTurnings = 48;

/// Returns the slips of lowest and of highest deviation on a grid of directions.
template <class Surface>
std::pair<Slip, Slip> extremes_of_grid(const Surface& surface,
                                       const FrictionEllipsoid& ellipsoid) noexcept {
  Slip lowest = slip_at(surface, ellipsoid, 0, 0), highest = lowest;
  for (int i = 0; i <= kHeadings; ++i)
    for (int j = 0; j <= kTurnings; ++j) {
      const Slip slip =
          slip_at(surface, ellipsoid, kHalfPi * i / kHeadings, kHalfPi * j / kTurnings);
      if (slip.deviation < lowest.deviation) lowest = slip;
      if (slip.deviation > highest.deviation) highest = slip;
    }
  return {lowest, highest};
}

/// The largest sign * deviation near `best`, by a pattern search.
template <class Surface>
Slip refined(const Surface& surface, const FrictionEllipsoid& ellipsoid, double sign,
             Slip best) noexcept {
  constexpr double kSmallestStep = 1e-7;  // of an angle: its square is far below the stated 1e-8
  double step = kHalfPi / kTurnings;
  for (int i = 0; i < 400 && step > kSmallestStep; ++i) {
    bool improved = false;
    for (const auto& [h, t] : {std::pair<int, int>{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const Slip slip =
          slip_at(surface, ellipsoid, std::clamp(best.heading + h * step, 0.0, kHalfPi),
                  std::clamp(best.turning + t * step, 0.0, kHalfPi));
      if (!(sign * slip.deviation > sign * best.deviation)) continue;
      best = slip;
      improved = true;
    }
    if (!improved) step /= 2;
  }
  return best;
}

template <class Surface>
double deviation_towards(const Surface& surface, const FrictionEllipsoid& ellipsoid,
                         const LimitWrench& direction) noexcept {
  const double exact = surface.utilisation(direction);
  if (!(exact > 0)) return 0;
  return ellipsoid.utilisation(direction.force_x_N, direction.force_y_N, direction.torque_Nm) /
             exact -
         1;
}

template <class Surface>
EllipsoidDeviation worst_deviation(const Surface& surface,
                                   const FrictionEllipsoid& ellipsoid) noexcept {
  EllipsoidDeviation worst;
  if (!(surface.max_torque_Nm() > 0)) return worst;
  const auto [lowest, highest] = extremes_of_grid(surface, ellipsoid);
  const Slip low = refined(surface, ellipsoid, -1, lowest);
  const Slip high = refined(surface, ellipsoid, 1, highest);
  worst.lowest = std::min(low.deviation, 0.0);
  worst.lowest_twist = low.twist;
  worst.lowest_wrench = low.wrench;
  worst.highest = std::max(high.deviation, 0.0);
  worst.highest_twist = high.twist;
  worst.highest_wrench = high.wrench;
  return worst;
}

}  // namespace

double ellipsoid_deviation(const LimitSurface& surface, const FrictionEllipsoid& ellipsoid,
                           const LimitWrench& direction) noexcept {
  return deviation_towards(surface, ellipsoid, direction);
}

double ellipsoid_deviation(const ShearSurface& surface, const FrictionEllipsoid& ellipsoid,
                           const LimitWrench& direction) noexcept {
  return deviation_towards(surface, ellipsoid, direction);
}

EllipsoidDeviation worst_ellipsoid_deviation(const LimitSurface& surface,
                                             const FrictionEllipsoid& ellipsoid) noexcept {
  return worst_deviation(surface, ellipsoid);
}

EllipsoidDeviation worst_ellipsoid_deviation(const ShearSurface& surface,
                                             const FrictionEllipsoid& ellipsoid) noexcept {
  return worst_deviation(surface, ellipsoid);
}

}  // namespace softfinger
