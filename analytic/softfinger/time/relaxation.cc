#include "softfinger/time/relaxation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

constexpr const char* kRelaxation = "relaxation";

/// The terms by falling time, each time once.
std::vector<RelaxationTerm> settled(std::vector<RelaxationTerm> terms) {
  for (const RelaxationTerm& term : terms) {
    if (!(term.share > 0) || !(term.share < 1))
      throw InputError(kRelaxation, "share", term.share, "a number between 0 and 1");
    if (!(term.time_s > 0) || !std::isfinite(term.time_s) || !std::isfinite(1 / term.time_s))
      throw InputError(kRelaxation, "time_s", term.time_s, "a finite number > 0");
  }
  std::sort(terms.begin(), terms.end(), [](const RelaxationTerm& one, const RelaxationTerm& other) {
    return one.time_s > other.time_s;
  });
  std::vector<RelaxationTerm> once;
  for (const RelaxationTerm& term : terms)
    if (!once.empty() && once.back().time_s == term.time_s)
      once.back().share += term.share;
    else
      once.push_back(term);
  return once;
}

/// A zero x of the modulus Q(-x) = rest - sum g_i x/(p_i - x), and p_i - x to full precision even
/// where x is as good as p_i. Q(-x) falls from the lower to the upper end of its interval.
struct CreepZero {
  double rate_per_s;
  Eigen::ArrayXd below_poles;  ///< p_i - x
};

CreepZero creep_zero(const Eigen::ArrayXd& shares, const Eigen::ArrayXd& poles, double rest,
                     double lower, double upper) {
  const auto value = [&](double x, const Eigen::ArrayXd& below) {
    return rest - (shares * x / below).sum();
  };
  const double half = (upper - lower) / 2;
  const bool near_upper = value(lower + half, poles - (lower + half)) > 0;
  // The distance from the nearer end is the unknown, since differences from poles are then exact.
  const double end = near_upper ? upper : lower, sign = near_upper ? -1 : 1;
  const Eigen::ArrayXd from_end = poles - end;
  const auto at = [&](double distance) {
    return CreepZero{end + sign * distance, from_end - sign * distance};
  };
  double least = half * 1e-30, most = half;
  constexpr int kHalvings = 120;  // ln 1e30 is halved to the last digit
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = std::sqrt(least) * std::sqrt(most);
    const CreepZero tried = at(middle);
    const bool is_below_zero = value(tried.rate_per_s, tried.below_poles) < 0;
    (is_below_zero == near_upper ? least : most) = middle;
  }
  return at(most);
}

}  // namespace

Relaxation::Relaxation(std::vector<RelaxationTerm> terms) : terms_(settled(std::move(terms))) {
  const auto count = Eigen::Index(terms_.size());
  Eigen::ArrayXd shares(count), poles(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    shares[i] = terms_[std::size_t(i)].share;
    poles[i] = 1 / terms_[std::size_t(i)].time_s;
  }
  long_time_ = 1 - shares.sum();
  // A thousandth of the modulus has to stay: a fluid has no contact that comes to rest.
  constexpr double kLeastRest = 1e-3;
  if (!(long_time_ >= kLeastRest))
    throw InputError(kRelaxation, "sum of shares", shares.sum(), "at most 0.999");
  rates_per_s_.resize(count);
  amounts_per_s_.resize(count);
  memory_.resize(count, count);
  for (Eigen::Index j = 0; j < count; ++j) {
    const CreepZero zero =
        creep_zero(shares, poles, long_time_, j == 0 ? 0 : poles[j - 1], poles[j]);
    rates_per_s_[j] = zero.rate_per_s;
    amounts_per_s_[j] = 1 / (shares * poles / zero.below_poles.square()).sum();
    memory_.col(j) = amounts_per_s_[j] / zero.below_poles;
  }
}

double Relaxation::modulus(double time_s) const {
  double lost = 0;
  for (const RelaxationTerm& term : terms_) lost -= term.share * std::expm1(-time_s / term.time_s);
  return 1 - lost;
}

double Relaxation::compliance(double time_s) const {
  double gained = 0;
  for (Eigen::Index j = 0; j < rates_per_s_.size(); ++j)
    gained -= amounts_per_s_[j] / rates_per_s_[j] * std::expm1(-rates_per_s_[j] * time_s);
  return 1 + gained;
}

std::vector<RelaxationTerm> power_law_relaxation(double exponent, double time_s, double until_s) {
  if (!(exponent > 0 && exponent <= 0.3))
    throw InputError(kRelaxation, "exponent", exponent, "a number above 0, at most 0.3");
  if (!(time_s > 0) || !std::isfinite(time_s))
    throw InputError(kRelaxation, "time_s", time_s, "a finite number > 0");
  if (!(until_s >= time_s && until_s <= 1e12 * time_s))
    throw InputError(kRelaxation, "until_s", until_s, "1 to 1e12 times time_s");
  // The trapezoidal rule in ln u, whose error falls exponentially with the step.
  const double step = std::log(10.) / 2, fastest = std::log(36.);  // exp(-36) is rounding
  constexpr double kBeyond = 100;  // slower terms change nothing until then
  std::vector<RelaxationTerm> terms;
  double sum = 0;
  int k = int(std::floor(fastest / step));
  for (; time_s * std::exp(-k * step) < kBeyond * until_s; --k) {
    const double v = k * step;
    const double share = step * std::exp(exponent * v - std::exp(v)) / std::tgamma(exponent);
    sum += share;
    constexpr double kLeastShare = 1e-9;
    if (share > kLeastShare) terms.push_back({share, time_s * std::exp(-v)});
  }
  // The terms left out are a geometric series. All together are the whole modulus.
  const double slower =
      step * std::exp(exponent * k * step) / -std::expm1(-exponent * step) / std::tgamma(exponent);
  for (RelaxationTerm& term : terms) term.share /= sum + slower;
  return terms;
}

}  // namespace softfinger
