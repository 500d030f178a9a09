#include "comparisons/system/remaining_time.h"

#include <algorithm>

namespace softfinger::system {

RemainingTime::RemainingTime(std::size_t jobs, double expected_s, int parallel)
    : jobs_(jobs), all_s_(expected_s), to_do_s_(expected_s), parallel_(parallel) {
  estimate_s_ = to_do_s_ / workers();
}

double RemainingTime::workers() const {
  return static_cast<double>(std::max<std::size_t>(1, std::min<std::size_t>(parallel_, jobs_)));
}

void RemainingTime::finished(double expected_s, std::optional<double> took_s, double now_s) {
  const double busy_s = now_s * workers();
  // If w jobs began one after the other, evenly spread, the first to end has taken 2/(w + 1) of the
  // time that they have used together.
  used_s_ += took_s.value_or(std::max(0., busy_s - used_s_) * 2 / (workers() + 1));
  jobs_ -= std::min<std::size_t>(1, jobs_);
  to_do_s_ = std::max(0., to_do_s_ - expected_s);
  // The expected times count as much as a tenth of all jobs, so that the first ones to end do not
  // decide the pace alone.
  const double prior_s = 0.1 * all_s_;
  const double pace = (used_s_ + prior_s) / (all_s_ - to_do_s_ + prior_s);
  const double running_s = jobs_ == 0 ? 0 : std::max(0., busy_s - used_s_);
  estimate_s_ = std::max(0., pace * to_do_s_ - running_s) / workers();
  estimated_at_s_ = now_s;
}

double RemainingTime::left_s(double now_s) const {
  return std::max(0., estimate_s_ - (now_s - estimated_at_s_));
}

}  // namespace softfinger::system
