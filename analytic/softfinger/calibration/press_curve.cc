#include "softfinger/calibration/press_curve.h"

#include <algorithm>
#include <cmath>

#include "softfinger/calibration/statistics.h"

namespace softfinger {
namespace {

/// The best line travel = zero + coefficient force^power.
struct TravelLine {
  double zero_m = 0, coefficient = 0, sum_of_squares = 0;
};

TravelLine travel_line(const PressCurve& curve, double power, bool is_zero_known) {
  const double count = double(curve.force_N.size());
  double mean_u = 0, mean_x = 0;
  if (!is_zero_known)
    for (std::size_t i = 0; i < curve.force_N.size(); ++i) {
      mean_u += std::pow(curve.force_N[i], power) / count;
      mean_x += curve.travel_m[i] / count;
    }
  double uu = 0, ux = 0, xx = 0;
  for (std::size_t i = 0; i < curve.force_N.size(); ++i) {
    const double u = std::pow(curve.force_N[i], power) - mean_u, x = curve.travel_m[i] - mean_x;
    uu += u * u;
    ux += u * x;
    xx += x * x;
  }
  TravelLine line;
  line.coefficient = ux / uu;
  line.zero_m = mean_x - line.coefficient * mean_u;
  line.sum_of_squares = std::max(0., xx - ux * ux / uu);
  return line;
}

/// Travel at this force by straight lines between the rows, which rise in force; the first crossing
/// counts where noise makes several.
double travel_at_m(const PressCurve& rising, double force_N) {
  for (std::size_t i = 0; i + 1 < rising.force_N.size(); ++i) {
    const double below = rising.force_N[i], above = rising.force_N[i + 1];
    if (!(below <= force_N && force_N <= above) || !(above > below)) continue;
    return rising.travel_m[i] +
           (force_N - below) / (above - below) * (rising.travel_m[i + 1] - rising.travel_m[i]);
  }
  return std::nan("");
}

double work_J(const PressCurve& curve) {
  double work = 0;
  for (std::size_t i = 0; i + 1 < curve.travel_m.size(); ++i)
    work += 0.5 * (curve.force_N[i] + curve.force_N[i + 1]) *
            (curve.travel_m[i + 1] - curve.travel_m[i]);
  return work;
}

}  // namespace

double CurveExponent::Law::travel_m(double force_N) const noexcept {
  return zero_m + coefficient * std::pow(force_N, 1 / exponent);
}

CurveExponent curve_exponent(const PressCurve& curve, bool is_zero_known) {
  CurveExponent result;
  const std::size_t count = curve.force_N.size();
  if (count < 5) return result;
  const auto [least, most] = std::minmax_element(curve.force_N.begin(), curve.force_N.end());
  if (!(*least > 0) || !(*most >= 1.3 * *least)) return result;
  constexpr double kLeastPower = 0.1, kMostPower = 3, kStep = 0.002;
  double best = kLeastPower, sum = INFINITY;
  for (double power = kLeastPower; power <= kMostPower; power += kStep) {
    const double here = travel_line(curve, power, is_zero_known).sum_of_squares;
    if (here < sum) {
      sum = here;
      best = power;
    }
  }
  // Readings without any scatter are no more exact than a millionth of their span.
  const double freedom = double(count) - (is_zero_known ? 2 : 3);
  const double span_m = std::abs(curve.travel_m.back() - curve.travel_m.front());
  const double t = statistics::student_quantile(0.05, freedom);
  const double limit = std::max(sum, freedom * 1e-12 * span_m * span_m) * (1 + t * t / freedom);
  double low_power = best, high_power = best;
  const auto fits = [&](double power) {
    return travel_line(curve, power, is_zero_known).sum_of_squares <= limit;
  };
  while (low_power > kLeastPower && fits(low_power - kStep)) low_power -= kStep;
  while (high_power < kMostPower && fits(high_power + kStep)) high_power += kStep;
  const auto law = [&](double power) {
    const TravelLine line = travel_line(curve, power, is_zero_known);
    return CurveExponent::Law{1 / power, line.zero_m, line.coefficient};
  };
  result.is_known = true;
  result.best = law(best);
  result.at_low = law(high_power);
  result.at_high = law(low_power);
  result.value = result.best.exponent;
  result.low = result.at_low.exponent;
  result.high = result.at_high.exponent;
  return result;
}

std::size_t first_unloading_row(const std::vector<double>& travel_m) {
  constexpr std::size_t kLeastRows = 3;
  if (travel_m.size() < 2 * kLeastRows) return travel_m.size();
  const auto largest = std::max_element(travel_m.begin(), travel_m.end());
  if (!std::is_sorted(travel_m.begin(), largest) ||
      !std::is_sorted(travel_m.rbegin(), std::make_reverse_iterator(largest)))
    return travel_m.size();
  const std::size_t turn = std::size_t(largest - travel_m.begin()) + 1;
  return turn >= kLeastRows && travel_m.size() - turn >= kLeastRows ? turn : travel_m.size();
}

Loop loop_between(const PressCurve& loading, const PressCurve& unloading) {
  Loop loop;
  if (loading.force_N.size() < 3 || unloading.force_N.size() < 3) return loop;
  PressCurve back = unloading;
  std::reverse(back.travel_m.begin(), back.travel_m.end());
  std::reverse(back.force_N.begin(), back.force_N.end());
  const double largest_N =
      std::min(*std::max_element(loading.force_N.begin(), loading.force_N.end()),
               *std::max_element(back.force_N.begin(), back.force_N.end()));
  for (std::size_t i = 0; i < Loop::kForces.size(); ++i) {
    const double force_N = Loop::kForces[i] * largest_N;
    loop.shift_m[i] = travel_at_m(back, force_N) - travel_at_m(loading, force_N);
    if (!std::isfinite(loop.shift_m[i])) return loop;
  }
  std::array<double, 3> sorted = loop.shift_m;
  std::sort(sorted.begin(), sorted.end());
  loop.backlash_m = std::max(0., -sorted[1]);
  const double in_J = work_J(loading);
  // Work between the same forces: the branch is moved, its forces are not.
  const double out_J = work_J(back);
  // At the turn the drive moves by the backlash while the plate, at the largest force, stands
  // still.
  const double unreturned_J = loop.backlash_m * largest_N;
  if (!(in_J > 0)) return loop;
  loop.hysteresis_share = std::clamp((in_J - out_J + unreturned_J) / in_J, 0., 1.);
  loop.is_known = true;
  return loop;
}

}  // namespace softfinger
