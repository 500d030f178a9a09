#include "softfinger/time/predict_in_time.h"

#include <cmath>

#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

using Drive = ContactHistory::Drive;

/// Elastic answers by the size of the contact.
class ElasticSizes {
 public:
  ElasticSizes(const PressureModel& model, const ContactProblem& problem, Drive drive)
      : model_(model), problem_(problem), drive_(drive) {}

  double load_N(double size) const {
    return drive_ == Drive::load ? size : load_at_approach_N(model_, problem_, size);
  }
  ContactProblem problem(double size) const {
    ContactProblem at = problem_;
    at.load.normal_force_N = load_N(size);
    return at;
  }

 private:
  const PressureModel& model_;
  const ContactProblem& problem_;
  Drive drive_;
};

PredictionInTime refused(const char* check, const char* message) {
  PredictionInTime answer;
  answer.prediction.validity.add({check, 0, 1, false, message});
  return answer;
}

/// The elastic answer under a load, at a modulus that is `softened` times the instantaneous one.
PredictionInTime elastic_answer(const PressureModel& model, ContactProblem problem, double load_N,
                                double softened) {
  problem.load.normal_force_N = load_N;
  problem.layer.youngs_modulus_Pa *= softened;
  PredictionInTime answer;
  if (load_N > 0) answer.prediction = model.predict(problem);
  answer.load_N = load_N;
  answer.effective_load_N = load_N / softened;
  return answer;
}

constexpr int kPoints = 24;
/// Places along the long axis at which the pressure is looked at, over a.
double place(int i) { return std::sin(0.5 * kPi * (i + 0.5) / kPoints); }

}  // namespace

double load_at_approach_N(const PressureModel& model, ContactProblem problem, double approach_m) {
  // The approach grows with a power of the load that changes slowly, hence secants of logarithms.
  double& load_N = problem.load.normal_force_N;
  load_N = problem.layer.youngs_modulus_Pa * std::sqrt(problem.radii.major_m) *
           std::sqrt(problem.radii.minor_m) * approach_m;
  double last_load = kNaN, last_gap = kNaN, power = 1.5;
  constexpr int kMost = 60;
  constexpr double kSame = 2e-15;
  for (int i = 0; i < kMost; ++i) {
    const Prediction found = model.predict(problem);
    if (!found.has_answer || !(found.indentation_m > 0)) return kNaN;
    const double gap = std::log(found.indentation_m / approach_m), at = std::log(load_N);
    if (std::abs(gap) < kSame) break;
    if (i > 0 && gap != last_gap) {
      const double secant = (at - last_load) / (gap - last_gap);
      // Elsewhere than between these powers, rounding speaks.
      if (secant > 0.3 && secant < 6) power = secant;
    }
    const double step = -power * gap;
    last_load = at;
    last_gap = gap;
    load_N *= std::exp(step);
    if (std::abs(step) < kSame) break;
  }
  return load_N;
}

PredictionInTime predict_at(const PressureModel& model, ContactProblem problem,
                            const ContactHistory& history, double time_s) {
  if (model.card().layer_constants == LayerConstants::none)
    return refused("knows_the_modulus",
                   "a measured law does not know the modulus, so that it says nothing of time");
  if (!model.card().hot_path)
    return refused("fast_enough", "this model is too slow to be asked over a history");
  const bool is_load = history.drive() == Drive::load;
  const Relaxation& relaxation = history.relaxation();
  const ElasticSizes elastic(model, problem, history.drive());
  if (std::isinf(time_s) || relaxation.is_elastic()) {
    const double value = history.value(time_s), softened = relaxation.modulus(time_s);
    if (!std::isinf(time_s)) history.at(time_s);  // refuses what nothing touches at
    if (!(value > 0))
      return refused("touches", "nothing touches in the end of this history: ask for a time");
    const double load_N = is_load ? value : elastic.load_N(value) * softened;
    return elastic_answer(model, problem, load_N, softened);
  }

  const ContactHistory::Reach reach = history.at(time_s);
  const double effective_N = elastic.load_N(reach.size);
  PredictionInTime answer = elastic_answer(model, problem, effective_N, 1);
  answer.effective_load_N = effective_N;
  answer.load_N = is_load ? history.value(time_s) : kNaN;
  if (!answer.prediction.has_answer) return answer;
  const double a_m = answer.prediction.a_m;
  bool all_answered = true;
  constexpr int kScalars = 4;  // load, load times both arms, peak
  const Eigen::ArrayXd relaxed = history.relaxed(
      [&](double size) -> Eigen::ArrayXd {
        Eigen::ArrayXd numbers = Eigen::ArrayXd::Zero(kScalars + kPoints);
        if (!(size > 0)) return numbers;
        const ContactProblem at = elastic.problem(size);
        const Prediction found = model.predict(at);
        all_answered = all_answered && found.has_answer;
        const double load_N = at.load.normal_force_N;
        numbers.head<kScalars>() << load_N, load_N * found.torque_arm_exact_m,
            load_N * found.torque_arm_paper_m, found.peak_pressure_Pa;
        for (int i = 0; i < kPoints; ++i)
          numbers[kScalars + i] = model.pressure_Pa(at, found, place(i) * a_m, 0);
        return numbers;
      },
      time_s, reach);
  if (!all_answered || !relaxed.allFinite() || !(relaxed[0] > 0)) {
    answer.prediction.has_answer = false;
    answer.prediction.validity.add(
        {"answers_all_loads", 0, 1, false, "the model has no answer for the smaller contacts"});
    return answer;
  }
  if (!is_load) answer.load_N = relaxed[0];
  Prediction& now = answer.prediction;
  now.torque_arm_exact_m = relaxed[1] / relaxed[0];
  now.torque_arm_paper_m = relaxed[2] / relaxed[0];
  now.peak_pressure_Pa = relaxed.tail<kPoints + 1>().maxCoeff();
  if (!is_load) {
    now.indentation_m = history.value(time_s);
  } else if (history.has_shrunk(time_s)) {
    now.indentation_m = history.shrinking_approach(
        [&](double size) { return model.predict(elastic.problem(size)).indentation_m; }, time_s);
  }
  return answer;
}

}  // namespace softfinger
