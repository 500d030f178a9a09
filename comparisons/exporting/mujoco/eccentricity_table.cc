#include "comparisons/exporting/mujoco/eccentricity_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "softfinger/accuracy/default_model.h"

namespace softfinger::exporting {
namespace {

constexpr int kDecades = 10, kPerDecade = 32;
constexpr double kFirst = 1e-6;  // in units of E* h³/R
const double kStep = std::log(10.0) / kPerDecade;

}  // namespace

EccentricityTable::EccentricityTable(const ContactProblem& problem) {
  const PressureModel& model = default_model(problem);
  const ElasticLayer& layer = problem.layer;
  const double radius_m = std::sqrt(problem.radii.major_m) * std::sqrt(problem.radii.minor_m);
  const double unit_N = layer.plane_strain_modulus_Pa() * std::pow(layer.thickness_m, 3) / radius_m;
  ContactProblem at_load = problem;
  at_load.load.friction_coefficient = 1;
  log_first_load_ = std::log(kFirst * unit_N);
  for (int i = 0; i <= kDecades * kPerDecade; ++i) {
    at_load.load.normal_force_N = kFirst * unit_N * std::exp(i * kStep);
    const Prediction prediction = model.predict(at_load);
    if (!prediction.has_answer || !(prediction.torque_arm_exact_m > 0)) {
      // The longest row without a gap that begins at the lightest load with an answer.
      if (log_eccentricity_.empty()) {
        log_first_load_ = std::log(at_load.load.normal_force_N) + kStep;
        continue;
      }
      break;
    }
    log_eccentricity_.push_back(std::log(prediction.torque_arm_exact_m));
  }
}

double EccentricityTable::at(double load_N) const {
  // Also for NaN, of a simulation that has diverged.
  if (!(load_N > 0)) return std::exp(log_eccentricity_.front());
  const double last = static_cast<double>(log_eccentricity_.size() - 1);
  const double place = std::clamp((std::log(load_N) - log_first_load_) / kStep, 0.0, last);
  const auto below = static_cast<std::size_t>(place);
  if (below + 1 >= log_eccentricity_.size()) return std::exp(log_eccentricity_.back());
  const double share = place - static_cast<double>(below);
  return std::exp((1 - share) * log_eccentricity_[below] + share * log_eccentricity_[below + 1]);
}

}  // namespace softfinger::exporting
