#include "comparisons/simulation/contact_creep.h"

#include <algorithm>
#include <cmath>

namespace softfinger::simulation {

double EffectiveLoad::of(double load_N) const {
  if (carried_N.empty() || load_N <= 0) return growth * load_N;
  if (load_N >= carried_N.back()) return size_N.back() + growth * (load_N - carried_N.back());
  const auto above = std::upper_bound(carried_N.begin(), carried_N.end(), load_N);
  const auto i = std::size_t(above - carried_N.begin());
  const double from_N = i > 0 ? carried_N[i - 1] : 0, size_from_N = i > 0 ? size_N[i - 1] : 0;
  return size_from_N + (size_N[i] - size_from_N) * (load_N - from_N) / (carried_N[i] - from_N);
}

/// E/E0 of a shell.
double ContactCreep::modulus(const Eigen::ArrayXd& unlost) const {
  double result = 1;
  const auto& terms = relaxation_.terms();
  for (std::size_t i = 0; i < terms.size(); ++i)
    result -= terms[i].share * (1 - unlost[Eigen::Index(i)]);
  return result;
}

Eigen::ArrayXd ContactCreep::kept_over(double step_s) const {
  Eigen::ArrayXd result(Eigen::Index(relaxation_.terms().size()));
  for (Eigen::Index i = 0; i < result.size(); ++i)
    result[i] = std::exp(-step_s / relaxation_.terms()[std::size_t(i)].time_s);
  return result;
}

/// At the end of the step in which the shell was added, evenly in time.
Eigen::ArrayXd ContactCreep::of_new_shell(double step_s) const {
  Eigen::ArrayXd result(Eigen::Index(relaxation_.terms().size()));
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const double times = step_s / relaxation_.terms()[std::size_t(i)].time_s;
    result[i] = times > 0 ? -std::expm1(-times) / times : 1;
  }
  return result;
}

EffectiveLoad ContactCreep::over(double step_s) const {
  EffectiveLoad result;
  const Eigen::ArrayXd kept = kept_over(step_s);
  double carried_N = 0, size_N = 0;
  for (const Shell& shell : shells_) {
    carried_N += modulus(kept * shell.unlost) * shell.width_N;
    size_N += shell.width_N;
    result.carried_N.push_back(carried_N);
    result.size_N.push_back(size_N);
  }
  result.growth = 1 / modulus(of_new_shell(step_s));
  return result;
}

void ContactCreep::hold(double load_N, double step_s) {
  const double size_N = over(step_s).of(load_N);
  const Eigen::ArrayXd kept = kept_over(step_s);
  double before_N = 0;
  for (Shell& shell : shells_) {
    shell.unlost *= kept;
    before_N += shell.width_N;
  }
  while (!shells_.empty() && size_N <= before_N - shells_.back().width_N) {
    before_N -= shells_.back().width_N;
    shells_.pop_back();
  }
  if (!(size_N > 0)) {
    shells_.clear();
    return;
  }
  if (size_N <= before_N) {
    shells_.back().width_N -= before_N - size_N;
    return;
  }
  shells_.push_back({size_N - before_N, of_new_shell(step_s)});
  // Thin shells become one with their mean: what all of them carry stays exact.
  constexpr double thin = 1.0 / 64;
  while (shells_.size() > 1) {
    Shell &last = shells_.back(), &other = shells_[shells_.size() - 2];
    const double both_N = last.width_N + other.width_N;
    if (both_N > thin * size_N) break;
    other.unlost = (other.width_N * other.unlost + last.width_N * last.unlost) / both_N;
    other.width_N = both_N;
    shells_.pop_back();
  }
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
