#pragma once

#include <vector>

namespace softfinger::fem {

/// Rubber that relaxes, and how it is pressed until the time of the answer: in linear elasticity
/// and without friction.
///
/// The layer is a generalised Maxwell solid: after a step of strain its modulus is
/// E0 (1 - sum_i g_i (1 - exp(-t/tau_i))), Poisson's ratio constant.
struct PressedInTime {
  struct Term {
    double share = 0;   ///< g_i > 0, their sum below 1
    double time_s = 0;  ///< tau_i > 0
  };
  struct Point {
    double time_s = 0;
    double value = 0;  ///< load or approach, >= 0
  };

  std::vector<Term> terms;
  /// Linear between the points; two of the same time are a step, and so is a first one that is not
  /// 0. Times do not fall; the last value is held. Loads, or approaches where the problem has one.
  std::vector<Point> points;
  double time_s = 0;  ///< of the answer; infinite: at rest under the last value
};

/// The load or approach at a time, after a step at this time.
inline double value_at(const PressedInTime& pressed, double time_s) {
  double value = 0;
  const std::vector<PressedInTime::Point>& points = pressed.points;
  for (std::size_t i = 0; i < points.size() && points[i].time_s <= time_s; ++i) {
    value = points[i].value;
    if (i + 1 < points.size() && points[i + 1].time_s > time_s)
      value += (points[i + 1].value - value) * (time_s - points[i].time_s) /
               (points[i + 1].time_s - points[i].time_s);
  }
  return value;
}

}  // namespace softfinger::fem
