#include "softfinger/time/contact_history.h"

#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/math/gauss_legendre.h"

namespace softfinger {
namespace {

constexpr const char* kHistory = "history";

/// Times from `begin_s` to `end_s`, whose distances from either end halve towards it.
/// @param first, last  how often
std::vector<double> halving_times(double begin_s, double end_s, int first, int last) {
  const double half = (end_s - begin_s) / 2;
  std::vector<double> times = {begin_s};
  for (int k = first; k >= 0; --k) times.push_back(begin_s + std::ldexp(half, -k));
  for (int k = 1; k <= last; ++k) times.push_back(end_s - std::ldexp(half, -k));
  times.push_back(end_s);
  return times;
}

/// Halvings of a half of `length_s` until a quarter of `scale_s` is left.
int halvings_to(double length_s, double scale_s, int most) {
  return int(std::clamp(std::ceil(std::log2(2 * length_s / scale_s)), 0., double(most)));
}

constexpr int kPanelPoints = 10;
const QuadratureRule& panel_rule() {
  static const QuadratureRule rule = gauss_legendre(kPanelPoints);
  return rule;
}

std::string seconds(double time_s) { return internal::number_text(time_s, 6) + " s"; }

void check_points(const std::vector<HistoryPoint>& points) {
  if (points.empty()) throw InputError(kHistory, "points", "none", "at least one");
  double largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [time_s, value] = points[i];
    if (!std::isfinite(time_s)) throw InputError(kHistory, "time_s", time_s, "a finite number");
    if (!(value >= 0) || !std::isfinite(value))
      throw InputError(kHistory, "value at " + seconds(time_s), value, "a finite number >= 0");
    if (i > 0 && time_s < points[i - 1].time_s)
      throw InputError(kHistory, "time_s", time_s,
                       "not before the last one, " + seconds(points[i - 1].time_s));
    if (i > 1 && time_s == points[i - 2].time_s)
      throw InputError(kHistory, "time_s", time_s, "at most two points of one time, for a step");
    largest = std::max(largest, value);
  }
  if (!(largest > 0)) throw InputError(kHistory, "values", "all 0", "a contact that is pressed");
}

}  // namespace

ContactHistory::ContactHistory(Relaxation relaxation, Drive drive, std::vector<HistoryPoint> points)
    : relaxation_(std::move(relaxation)), drive_(drive) {
  check_points(points);
  const auto& terms = relaxation_.terms();
  shares_.resize(Eigen::Index(terms.size()));
  falls_per_s_.resize(shares_.size());
  for (std::size_t i = 0; i < terms.size(); ++i) {
    shares_[Eigen::Index(i)] = terms[i].share;
    falls_per_s_[Eigen::Index(i)] = 1 / terms[i].time_s;
  }
  rates_per_s_ = drive == Drive::load ? relaxation_.creep_rates_per_s() : falls_per_s_;

  Segment segment;
  segment.before = Eigen::ArrayXd::Zero(rates_per_s_.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    segment.begin_s = points[i].time_s;
    const bool is_step = i + 1 < points.size() && points[i + 1].time_s == points[i].time_s;
    if (i > 0) {
      segment.before = memory(segments_.back(), segment.begin_s);
      segment.value_before = points[i].value;
    }
    if (is_step) ++i;
    segment.value = points[i].value;
    segment.after = segment.before + (segment.value - segment.value_before);
    const bool is_last = i + 1 == points.size();
    segment.end_s = is_last ? kInfinity : points[i + 1].time_s;
    segment.slope =
        is_last ? 0 : (points[i + 1].value - segment.value) / (segment.end_s - segment.begin_s);
    if (!std::isfinite(segment.slope))
      throw InputError(kHistory, "slope after " + seconds(segment.begin_s), segment.slope,
                       "a finite number: a step has two points of the same time");
    segments_.push_back(segment);
  }
  find_peak();
}

double ContactHistory::value_of(const Segment& segment, double time_s) const {
  return segment.slope == 0 ? segment.value
                            : segment.value + segment.slope * (time_s - segment.begin_s);
}

Eigen::ArrayXd ContactHistory::memory(const Segment& segment, double time_s) const {
  const double since_s = time_s - segment.begin_s;
  Eigen::ArrayXd result(rates_per_s_.size());
  for (Eigen::Index k = 0; k < result.size(); ++k) {
    const double rate = rates_per_s_[k], lost = -std::expm1(-rate * since_s);
    result[k] = segment.after[k] * (1 - lost) + segment.slope * lost / rate;
  }
  return result;
}

double ContactHistory::size_of(double value, const Eigen::ArrayXd& memory) const {
  if (drive_ == Drive::approach) return value;
  return value + (relaxation_.creep_amounts_per_s() / rates_per_s_ * (value - memory)).sum();
}

double ContactHistory::growth_rate(const Segment& segment, double time_s) const {
  if (drive_ == Drive::approach) return segment.slope;
  return segment.slope + (relaxation_.creep_amounts_per_s() * memory(segment, time_s)).sum();
}

Eigen::ArrayXd ContactHistory::remembered(const Eigen::ArrayXd& memory) const {
  if (drive_ == Drive::approach) return memory;
  return (relaxation_.memory().matrix() * memory.matrix()).array();
}

double ContactHistory::carried(double size, const Eigen::ArrayXd& remembered,
                               double since_s) const {
  return relaxation_.long_time_modulus() * size +
         (shares_ * (-falls_per_s_ * since_s).exp() * remembered).sum();
}

const ContactHistory::Segment& ContactHistory::segment_at(double time_s) const {
  std::size_t last = 0;
  while (last + 1 < segments_.size() && segments_[last + 1].begin_s <= time_s) ++last;
  return segments_[last];
}

double ContactHistory::value(double time_s) const {
  return time_s < begin_s() ? 0 : value_of(segment_at(time_s), time_s);
}

std::vector<double> ContactHistory::times_s() const {
  std::vector<double> times;
  for (const Segment& segment : segments_) times.push_back(segment.begin_s);
  return times;
}

/// The first moment at which the contact shrinks.
void ContactHistory::find_peak() {
  peak_.time_s = kInfinity;
  peak_.segment = segments_.size() - 1;
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const Segment& segment = segments_[i];
    const double size_before = size_of(segment.value_before, segment.before);
    if (segment.value < segment.value_before) {
      // The contact is still as large as before the step.
      peak_ = {segment.begin_s, i, true, size_before};
      return;
    }
    // The rate of growth is a sum of exponentials of the time since the segment's beginning.
    double grows_s = segment.begin_s;
    const double slowest = rates_per_s_.size() ? rates_per_s_.minCoeff() : 1;
    const double fastest = rates_per_s_.size() ? rates_per_s_.maxCoeff() : 1;
    constexpr double kForgotten = 40, kStep = 1.2;
    const double length_s = std::min(segment.end_s - segment.begin_s, kForgotten / slowest);
    for (double since_s = std::min(length_s, 0.01 / fastest);; since_s *= kStep) {
      const double time_s = segment.begin_s + std::min(since_s, length_s);
      if (growth_rate(segment, time_s) < 0) {
        double shrinks_s = time_s;
        for (int k = 0; k < 100; ++k) {
          const double middle_s = (grows_s + shrinks_s) / 2;
          (growth_rate(segment, middle_s) < 0 ? shrinks_s : grows_s) = middle_s;
        }
        peak_ = {grows_s, i, false, size_of(value_of(segment, grows_s), memory(segment, grows_s))};
        return;
      }
      grows_s = time_s;
      if (since_s >= length_s) break;
    }
  }
}

ContactHistory::Reach ContactHistory::shrunk_to(double time_s) const {
  const Segment& now = segment_at(time_s);
  double target = value_of(now, time_s);
  if (drive_ == Drive::approach) target = carried(target, memory(now, time_s), 0);
  if (!(target > 0))
    throw InputError(kHistory, "contact at " + seconds(time_s), "none",
                     "a time at which the bodies touch");
  for (std::size_t i = 0; i <= peak_.segment; ++i) {
    const Segment& segment = segments_[i];
    const double size_before = size_of(segment.value_before, segment.before);
    const double before =
        carried(size_before, remembered(segment.before), time_s - segment.begin_s);
    const bool peaks_here = i == peak_.segment;
    if (target <= before) return {segment.begin_s, i, true, size_before};
    if (peaks_here && peak_.is_in_step) break;
    const double size_after = size_of(segment.value, segment.after);
    const double since = relaxation_.modulus(time_s - segment.begin_s);
    if (target <= before + since * (size_after - size_before))
      return {segment.begin_s, i, true, size_before + (target - before) / since};
    double low_s = segment.begin_s, high_s = peaks_here ? peak_.time_s : segment.end_s;
    const auto carried_at = [&](double reach_s) {
      const Eigen::ArrayXd at = memory(segment, reach_s);
      return carried(size_of(value_of(segment, reach_s), at), remembered(at), time_s - reach_s);
    };
    if (carried_at(high_s) < target) continue;
    for (int k = 0; k < 80; ++k) {
      const double middle_s = (low_s + high_s) / 2;
      (carried_at(middle_s) < target ? low_s : high_s) = middle_s;
    }
    return {high_s, i, false, size_of(value_of(segment, high_s), memory(segment, high_s))};
  }
  return peak_;
}

/// Ting's rule holds while the contact shrinks. Rubber that was unloaded to a lower load and held
/// there yields again under it.
void ContactHistory::check_shrinks_until(double time_s) const {
  constexpr double kSame = 1e-9;
  const auto refuse = [](double at_s) {
    throw InputError(kHistory, "the contact grows a second time, from " + seconds(at_s), "",
                     "one maximum of the contact's size: ask for a time before that, or leave out "
                     "what came before the last loading");
  };
  double last = peak_.size;
  for (std::size_t i = peak_.segment; i < segments_.size(); ++i) {
    const Segment& segment = segments_[i];
    const double from_s = std::max(segment.begin_s, peak_.time_s);
    const double to_s = std::min(segment.end_s, time_s);
    if (from_s > time_s) return;
    if (i > peak_.segment && segment.value > segment.value_before) refuse(segment.begin_s);
    if (!(to_s > from_s)) continue;
    const double scale_s = 1 / falls_per_s_.maxCoeff();
    constexpr int kMostHalvings = 40;
    const int halvings = halvings_to(to_s - from_s, scale_s, kMostHalvings);
    for (const double at_s : halving_times(from_s, to_s, halvings, halvings)) {
      if (at_s == segment.end_s && at_s != time_s) continue;  // the next segment's, after its step
      const double size = shrunk_to(at_s).size;
      if (size > last * (1 + kSame)) refuse(at_s);
      last = size;
    }
  }
}

ContactHistory::Reach ContactHistory::at(double time_s) const {
  if (!(time_s >= begin_s()) || !std::isfinite(time_s))
    throw InputError(kHistory, "time", time_s,
                     "a finite number of seconds, from " + seconds(begin_s()) + " on");
  if (!(value(time_s) > 0))
    throw InputError(
        kHistory,
        drive_ == Drive::load ? "load at " + seconds(time_s) : "approach at " + seconds(time_s),
        value(time_s), "a time at which the bodies are pressed");
  // An elastic contact has no memory.
  if (has_shrunk(time_s) && !relaxation_.is_elastic()) {
    check_shrinks_until(time_s);
    return shrunk_to(time_s);
  }
  const Segment& segment = segment_at(time_s);
  return {time_s, std::size_t(&segment - segments_.data()), false,
          size_of(value_of(segment, time_s), memory(segment, time_s))};
}

Eigen::ArrayXd ContactHistory::relaxed(const Numbers& numbers, double time_s,
                                       const Reach& reach) const {
  constexpr int kMostLevels = 50;
  return relaxed(numbers, time_s, reach, kMostLevels);
}

Eigen::ArrayXd ContactHistory::relaxed(const Numbers& numbers, double time_s, const Reach& reach,
                                       int most_levels) const {
  Eigen::ArrayXd sum = 0 * numbers(0);
  for (std::size_t i = 0; i <= reach.segment; ++i) {
    const Segment& segment = segments_[i];
    const bool is_last = i == reach.segment;
    const double size_before = size_of(segment.value_before, segment.before);
    const double size_after =
        is_last && reach.is_in_step ? reach.size : size_of(segment.value, segment.after);
    const Eigen::ArrayXd begin = numbers(size_after);
    if (size_after != size_before)
      sum += relaxation_.modulus(time_s - segment.begin_s) * (begin - numbers(size_before));
    const double end_s = is_last ? reach.time_s : segment.end_s;
    const double length_s = end_s - segment.begin_s;
    const bool rests = drive_ == Drive::approach && segment.slope == 0;
    if ((is_last && reach.is_in_step) || !(length_s > 0) || rests) continue;
    // Integration by parts needs no derivative of the numbers.
    const auto at = [&](double s) {
      return Eigen::ArrayXd(numbers(size_of(value_of(segment, s), memory(segment, s))) - begin);
    };
    sum += relaxation_.modulus(time_s - end_s) * at(end_s);
    if (relaxation_.is_elastic()) continue;
    const double fastest = rates_per_s_.maxCoeff();
    const int first = size_after == 0 ? std::min(40, most_levels)
                                      : halvings_to(length_s, 1 / fastest, most_levels);
    const int last = halvings_to(length_s, 1 / falls_per_s_.maxCoeff(), most_levels);
    const std::vector<double> ends = halving_times(segment.begin_s, end_s, first, last);
    for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
      const double width_s = ends[k + 1] - ends[k];
      const auto loss = [&](double s) {
        return (shares_ * falls_per_s_ * (-falls_per_s_ * (time_s - s)).exp()).sum();
      };
      constexpr double kForgotten = 1e-17;
      if (!(width_s > 0) || loss(ends[k + 1]) * width_s < kForgotten) continue;
      for (int q = 0; q < kPanelPoints; ++q) {
        const double s = ends[k] + width_s * panel_rule().nodes[q];
        sum -= width_s * panel_rule().weights[q] * loss(s) * at(s);
      }
    }
  }
  return sum;
}

double ContactHistory::shrinking_approach(const std::function<double(double)>& approach,
                                          double time_s) const {
  // Fewer panels than usual: these integrals are nested.
  constexpr int kLevels = 16;
  const Numbers numbers = [&](double size) {
    return Eigen::ArrayXd::Constant(1, size > 0 ? approach(size) : 0);
  };
  const auto pulled = [&](double at_s) {
    return relaxed(numbers, at_s, shrunk_to(at_s), kLevels)[0] -
           relaxed(numbers, at_s, peak_, kLevels)[0];
  };
  double result = approach(peak_.size) + pulled(time_s);
  const auto& amounts = relaxation_.creep_amounts_per_s();
  for (std::size_t i = peak_.segment; i < segments_.size(); ++i) {
    const double from_s = std::max(segments_[i].begin_s, peak_.time_s);
    const double to_s = std::min(segments_[i].end_s, time_s);
    if (!(to_s > from_s)) continue;
    const double scale_s = 1 / rates_per_s_.maxCoeff();
    // However short the shortest time is, its whole weight lies near the end.
    constexpr int kFirst = 8, kMost = 60;
    const int levels = halvings_to(to_s - from_s, scale_s, kMost);
    const std::vector<double> ends = halving_times(from_s, to_s, kFirst, levels);
    for (std::size_t k = 0; k + 1 < ends.size(); ++k)
      for (int q = 0; q < kPanelPoints; ++q) {
        const double width_s = ends[k + 1] - ends[k];
        const double s = ends[k] + width_s * panel_rule().nodes[q];
        result += width_s * panel_rule().weights[q] * pulled(s) *
                  (amounts * (-rates_per_s_ * (time_s - s)).exp()).sum();
      }
  }
  return result;
}

}  // namespace softfinger
