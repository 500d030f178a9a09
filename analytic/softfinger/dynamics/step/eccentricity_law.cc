#include "softfinger/dynamics/step/eccentricity_law.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "softfinger/input/errors.h"

namespace softfinger {

PowerEccentricity::PowerEccentricity(double eccentricity_at_1N_m, double exponent)
    : coefficient_m_(eccentricity_at_1N_m), exponent_(exponent) {
  const auto allowed = [](double value) { return value >= 0 && std::isfinite(value); };
  if (!allowed(coefficient_m_) || !allowed(exponent_))
    throw InputError("eccentricity law", "coefficient, exponent",
                     std::to_string(coefficient_m_) + ", " + std::to_string(exponent_),
                     "finite numbers >= 0");
}

double PowerEccentricity::eccentricity_m(double load_N) const noexcept {
  return coefficient_m_ * std::pow(std::max(load_N, 0.), exponent_);
}

SampledEccentricity::SampledEccentricity(double lowest_load_N, double highest_load_N,
                                         const std::vector<double>& eccentricity_m) {
  const auto refuse = [](const char* field, const std::string& value, const char* allowed) {
    throw InputError("eccentricity law", field, value, allowed);
  };
  if (!(lowest_load_N > 0 && highest_load_N > lowest_load_N && std::isfinite(highest_load_N)))
    refuse("loads", std::to_string(lowest_load_N) + " to " + std::to_string(highest_load_N),
           "0 < lowest < highest");
  if (eccentricity_m.size() < 2)
    refuse("samples", std::to_string(eccentricity_m.size()), "at least two");
  log_lowest_ = std::log(lowest_load_N);
  log_step_ = (std::log(highest_load_N) - log_lowest_) / double(eccentricity_m.size() - 1);
  for (const double value : eccentricity_m) {
    if (!(value > 0 && std::isfinite(value)))
      refuse("samples", std::to_string(value), "finite numbers > 0");
    log_eccentricity_.push_back(std::log(value));
  }
}

SampledEccentricity SampledEccentricity::of_model(const PressureModel& model,
                                                  ContactProblem problem, double lowest_load_N,
                                                  double highest_load_N, int count) {
  std::vector<double> samples;
  for (int i = 0; i < count; ++i) {
    problem.load.normal_force_N =
        lowest_load_N * std::pow(highest_load_N / lowest_load_N, i / (count - 1.));
    const Prediction prediction = model.predict(problem);
    if (!prediction.has_answer)
      throw InputError("eccentricity law", std::string(model.card().name),
                       std::to_string(problem.load.normal_force_N) + " N",
                       "a load that the model can answer");
    samples.push_back(prediction.torque_arm_exact_m);
  }
  return SampledEccentricity(lowest_load_N, highest_load_N, samples);
}

double SampledEccentricity::eccentricity_m(double load_N) const noexcept {
  if (!(load_N > 0)) return 0;
  const int intervals = int(log_eccentricity_.size()) - 1;
  const double place = (std::log(load_N) - log_lowest_) / log_step_;
  const int i = int(std::clamp(std::floor(place), 0., intervals - 1.));
  const double from = log_eccentricity_[std::size_t(i)], to = log_eccentricity_[std::size_t(i) + 1];
  return std::exp(from + (place - i) * (to - from));
}

ConsistentContactSolver::ConsistentContactSolver(int largest_contacts, int largest_vertices)
    : solver_(largest_contacts, largest_vertices),
      eccentricity_m_(largest_contacts),
      friction_(largest_contacts) {
  itself_.reserve(std::size_t(largest_contacts));
}

/// Relative difference of what a law wants from what was used.
double ConsistentContactSolver::Followed::compare(int contact, double used, double wanted) {
  mismatch[contact] = wanted >= 0 && std::isfinite(wanted) ? wanted - used : 0;
  if (mismatch[contact] == 0) return 0;
  return std::abs(mismatch[contact]) / std::max(wanted, used);
}

double ConsistentContactSolver::Followed::next(int contact, double used, double fraction,
                                               bool is_first) {
  double step = mismatch[contact];
  if (!is_first && step != 0) {
    const double change = mismatch[contact] - last_mismatch[contact];
    const double secant = change != 0 ? -(used - last[contact]) / change : 0;
    step *= secant >= 0.25 && secant <= 4 ? secant : 1;
  }
  last[contact] = used;
  last_mismatch[contact] = mismatch[contact];
  // It stays positive, wherever the secant points: at least half of the used and the wanted one.
  return std::max(used + fraction * step, 0.5 * std::min(used, used + mismatch[contact]));
}

ConsistentResult ConsistentContactSolver::solve(ContactLcp& problem,
                                                const std::vector<const EccentricityLaw*>& laws,
                                                double time_step_s, ContactSolution& solution,
                                                const Options& options,
                                                const std::vector<int>* continued) {
  const int nc = problem.contacts();
  if (int(laws.size()) != nc)
    throw InputError("contact problem", "laws", std::to_string(laws.size()), "one per contact");
  if (!(time_step_s > 0 && std::isfinite(time_step_s)))
    throw InputError("contact problem", "time step", time_step_s, "> 0");
  ConsistentResult result;
  double last = std::numeric_limits<double>::infinity(), fraction = 1;
  for (;;) {
    const LcpResult lcp = solver_.solve(problem, solution, continued);
    if (!continued || continued != &itself_) {
      itself_.resize(std::size_t(nc));
      std::iota(itself_.begin(), itself_.end(), 0);
      continued = &itself_;
    }
    const int pivots = result.lcp.pivots, newton = result.lcp.newton_iterations;
    result.lcp = lcp;
    result.lcp.pivots += pivots;
    result.lcp.newton_iterations += newton;
    ++result.iterations;
    result.inconsistency = 0;
    if (lcp.status != LcpStatus::solved) return result;
    for (int i = 0; i < nc; ++i) {
      const double load_N = solution.impulse[4 * i] / time_step_s;
      const double arm_m = problem.eccentricity_m[i], friction = problem.friction_coefficient[i];
      const EccentricityLaw* law = load_N > 0 ? laws[std::size_t(i)] : nullptr;
      const double of_arm =
          eccentricity_m_.compare(i, arm_m, law ? law->eccentricity_m(load_N) : arm_m);
      const double of_friction = friction_.compare(
          i, friction, law ? law->friction_coefficient(load_N).value_or(friction) : friction);
      result.inconsistency = std::max({result.inconsistency, of_arm, of_friction});
    }
    if (result.inconsistency <= options.tolerance || result.iterations >= options.most_iterations)
      return result;
    // Compared with the last solution, not with the best one: that may have been another one of
    // several, to which no step leads back.
    fraction = result.inconsistency < last ? std::min(1., 2 * fraction) : 0.5 * fraction;
    last = result.inconsistency;
    for (int i = 0; i < nc; ++i) {
      const bool is_first = result.iterations == 1;
      problem.eccentricity_m[i] =
          eccentricity_m_.next(i, problem.eccentricity_m[i], fraction, is_first);
      problem.friction_coefficient[i] =
          friction_.next(i, problem.friction_coefficient[i], fraction, is_first);
    }
  }
}

}  // namespace softfinger
