#include "comparisons/simulation/contact_creep.h"

#include <algorithm>

namespace softfinger::simulation {

ContactCreep::ContactCreep(const Relaxation& relaxation)
    : rates_per_s_(relaxation.creep_rates_per_s()),
      amounts_(relaxation.creep_amounts_per_s() / relaxation.creep_rates_per_s()),
      lagging_N_(Eigen::ArrayXd::Zero(rates_per_s_.size())) {}

EffectiveLoad ContactCreep::over(double step_s) const {
  const Eigen::ArrayXd kept = (-rates_per_s_ * step_s).exp();
  EffectiveLoad result;
  result.growth = 1 + (amounts_ * (1 - kept)).sum();
  result.crept_N = (amounts_ * kept * lagging_N_).sum();
  if (!(largest_at_N_ > 0)) return result;
  result.largest_at_N = largest_at_N_;
  const double now_N = result.growth * largest_at_N_ + result.crept_N;
  result.largest_ratio = std::max(largest_N_, now_N) / largest_at_N_;
  return result;
}

void ContactCreep::hold(double load_N, double step_s) {
  const double size_N = over(step_s).of(load_N);
  if (!(load_N > 0)) {
    largest_N_ = largest_at_N_ = 0;  // what does not press has no size
  } else if (size_N >= largest_N_) {
    largest_N_ = size_N;
    largest_at_N_ = load_N;
  }
  lagging_N_ += (1 - (-rates_per_s_ * step_s).exp()) * (load_N - lagging_N_);
}

std::optional<Relaxation> common_relaxation(const input::SceneBody& a, const input::SceneBody& b) {
  if (!a.layer) return b.relaxation;
  if (!b.layer) return a.relaxation;
  const auto alike = [](const RelaxationTerm& one, const RelaxationTerm& other) {
    return one.share == other.share && one.time_s == other.time_s;
  };
  const auto &of_a = a.relaxation.terms(), &of_b = b.relaxation.terms();
  if (!std::equal(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), alike)) return std::nullopt;
  return a.relaxation;
}

}  // namespace softfinger::simulation
