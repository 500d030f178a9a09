#include "comparisons/extremes/survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <vector>

#include "comparisons/extremes/extreme_problem.h"
#include "comparisons/extremes/jumps.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/text/json_text.h"
#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/pressure/equivalent_exponent.h"
#include "softfinger/pressure/soundness.h"

namespace softfinger::extremes {
namespace {

using nlohmann::json;

/// A number of the problem over which answers and refusals are counted, decade by decade.
struct Axis {
  const char* key;
  const char* name;
  double (*value)(const ContactProblem&);
  bool logarithmic;
};

double half_space_contact_m(const ContactProblem& problem) {
  return std::cbrt(problem.load.normal_force_N / problem.layer.youngs_modulus_Pa) *
         std::cbrt(std::sqrt(problem.radii.major_m) * std::sqrt(problem.radii.minor_m));
}

const std::array<Axis, 7> kAxes{
    {{"relative_size", "contact size over thickness",
      [](const ContactProblem& p) { return half_space_contact_m(p) / p.layer.thickness_m; }, true},
     {"load_N", "load, N", [](const ContactProblem& p) { return p.load.normal_force_N; }, true},
     {"radius_m", "R'', m", [](const ContactProblem& p) { return p.radii.minor_m; }, true},
     {"radii_ratio", "R'/R''",
      [](const ContactProblem& p) { return p.radii.major_m / p.radii.minor_m; }, true},
     {"youngs_modulus_Pa", "Young's modulus, Pa",
      [](const ContactProblem& p) { return p.layer.youngs_modulus_Pa; }, true},
     {"friction_coefficient", "friction coefficient",
      [](const ContactProblem& p) { return p.load.friction_coefficient; }, true},
     {"poisson_ratio", "Poisson's ratio",
      [](const ContactProblem& p) { return p.layer.poisson_ratio; }, false}}};

/// valid: the model's assumptions hold; answered: it gave an answer although they do not hold;
/// refused: no answer, with a reason.
struct Counts {
  int valid = 0, answered = 0, refused = 0;
};

/// The number of the bin: a bin is a decade of a logarithmic axis, and 0.05 of Poisson's ratio.
int bin_of(const Axis& axis, double value) {
  return int(std::floor(axis.logarithmic ? std::log10(value) : 20 * value));
}
double start_of(const Axis& axis, int bin) {
  return axis.logarithmic ? std::pow(10, bin) : bin / 20.;
}

struct Range {
  double least = INFINITY, largest = -INFINITY;
};

/// Whether ellipsoid and exact limit surface of the contact are finite, and within the largest
/// force and torque, however strong the friction.
bool has_sound_friction(const ContactProblem& problem, const Prediction& prediction) {
  const double max_force_N = problem.load.friction_coefficient * problem.load.normal_force_N;
  const double arm_m = prediction.torque_arm_exact_m;
  const FrictionEllipsoid ellipsoid{max_force_N, arm_m};
  const LimitSurface surface(prediction.a_m, prediction.b_m,
                             std::clamp(equivalent_exponent(prediction), -0.5, 50.), max_force_N);
  const LimitWrench wrench = surface.wrench_for_twist({0.3 * arm_m, -0.2 * arm_m, 1});
  const double used = ellipsoid.utilisation(wrench.force_x_N, wrench.force_y_N, wrench.torque_Nm);
  constexpr double kRounding = 1e-8;
  return std::isfinite(used) && used > 0 && wrench.torque_Nm >= 0 &&
         std::hypot(wrench.force_x_N, wrench.force_y_N) <= max_force_N * (1 + kRounding) &&
         wrench.torque_Nm <= max_force_N * arm_m * (1 + kRounding);
}

class ModelSurvey {
 public:
  explicit ModelSurvey(const PressureModel& model) : model_(model) {}

  void ask(const ContactProblem& problem, ExtremeProblems& second_look) {
    ++tried_;
    const Prediction one = timed(problem);
    if (!is_sound(one)) broken("not_finite_or_positive", problem);
    const double pressure_Pa = model_.pressure_Pa(problem, one, 0.3 * one.a_m, 0.4 * one.b_m);
    if (!(pressure_Pa >= 0 && std::isfinite(pressure_Pa)))
      broken("not_finite_or_positive", problem);
    count(problem, one);

    // Costs a tenth of a millisecond, so only every eighth problem is checked.
    if (one.has_answer && tried_ % 8 == 0 && !has_sound_friction(problem, one))
      broken("friction_limit", problem);

    const double length = second_look.log_uniform(1e-3, 1e3);
    const double force = second_look.log_uniform(1e-3, 1e3);
    const double factor = 1 + second_look.log_uniform(1e-3, 10);
    const Prediction scaled = model_.predict(in_units(problem, length, force));
    if (scaled.has_answer != one.has_answer) broken("depends_on_units", problem);
    if (!one.has_answer || !scaled.has_answer) return;
    const double deviation = difference(one, scaled, length, force);
    units_ = std::max(units_, deviation);
    // A few roundings: models that iterate, too, take the same steps in all units.
    if (!(deviation <= 1e-12)) broken("depends_on_units", problem);
    ContactProblem more = problem;
    more.load.normal_force_N *= factor;
    const Prediction heavier = model_.predict(more);
    if (heavier.has_answer && !(heavier.a_m > one.a_m && heavier.b_m > one.b_m &&
                                heavier.indentation_m > one.indentation_m &&
                                heavier.torque_arm_exact_m > one.torque_arm_exact_m))
      broken("shrinks_under_load", more);
  }

  void ask_nonsense(const ContactProblem& problem) {
    ++nonsense_;
    const Prediction prediction = model_.predict(problem);
    if (!is_sound(prediction)) broken("not_finite_or_positive", problem);
    nonsense_refused_ += !prediction.has_answer;
  }

  /// Only for closed forms: the numbers of models that discretise jump by their discretisation
  /// error.
  void look_for_jumps(ExtremeProblems& problems, int lines) {
    if (!model_.card().hot_path) return;
    jump_ = 0;
    for (int line = 0; line < lines; ++line)
      for (const Path& path : draw_paths(problems, line)) {
        const double jump = largest_jump(model_, path.problem, path.samples);
        jump_ = std::max(jump_, jump);
        // Across the last interval of the bisection a smooth logarithm changes by at most 3e-12,
        // plus rounding.
        if (!(jump < 1e-9)) broken("jumps", path.base);
      }
  }

  json result() const {
    json refusals = json::array(), ranges = json::object(), decades = json::object();
    std::vector<std::pair<std::string, int>> reasons(refusals_.begin(), refusals_.end());
    std::sort(reasons.begin(), reasons.end(),
              [](const auto& left, const auto& right) { return left.second > right.second; });
    for (const auto& [reason, times] : reasons)
      refusals.push_back({{"reason", reason}, {"count", times}});
    for (std::size_t i = 0; i < kAxes.size(); ++i) {
      ranges[kAxes[i].key] = {text::finite_or_null(ranges_[i].least),
                              text::finite_or_null(ranges_[i].largest)};
      json& bins = decades[kAxes[i].key] = json::array();
      for (const auto& [bin, counts] : bins_[i])
        bins.push_back({{"from", start_of(kAxes[i], bin)},
                        {"to", start_of(kAxes[i], bin + 1)},
                        {"valid", counts.valid},
                        {"answered", counts.answered},
                        {"refused", counts.refused}});
    }
    json broken_promises = json::array();
    for (const auto& [invariant, cases] : broken_)
      broken_promises.push_back(
          {{"promise", invariant}, {"count", cases.first}, {"first", cases.second}});
    return {{"model", model_.card().name},
            {"hot_path", model_.card().hot_path},
            {"tried", tried_},
            {"valid", total_.valid},
            {"answered_outside_validity", total_.answered},
            {"refused", total_.refused},
            {"refusals", refusals},
            {"nonsense_tried", nonsense_},
            {"nonsense_refused", nonsense_refused_},
            {"units_worst_deviation", units_},
            {"largest_jump", jump_ < 0 ? json() : json(jump_)},
            {"slowest_call_ns", slowest_ns_},
            {"ranges", ranges},
            {"decades", decades},
            {"broken_promises", broken_promises}};
  }

 private:
  /// Predicts and records the slowest call. A new slowest call is repeated, and its shortest time
  /// counts: one slow call may only show that the machine was busy.
  Prediction timed(const ContactProblem& problem) {
    using Clock = std::chrono::steady_clock;
    Prediction prediction;
    double least_ns = INFINITY;
    // Models that discretise keep their last solution, so that a repetition would measure nothing.
    const int repetitions = model_.card().hot_path ? 3 : 1;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      const auto start = Clock::now();
      prediction = model_.predict(problem);
      least_ns = std::min(least_ns,
                          std::chrono::duration<double, std::nano>(Clock::now() - start).count());
      if (least_ns <= slowest_ns_) return prediction;
    }
    slowest_ns_ = least_ns;
    return prediction;
  }

  void count(const ContactProblem& problem, const Prediction& prediction) {
    const auto add = [&](Counts& counts) {
      ++(prediction.valid()      ? counts.valid
         : prediction.has_answer ? counts.answered
                                 : counts.refused);
    };
    add(total_);
    for (std::size_t i = 0; i < kAxes.size(); ++i) {
      const double value = kAxes[i].value(problem);
      ranges_[i].least = std::min(ranges_[i].least, value);
      ranges_[i].largest = std::max(ranges_[i].largest, value);
      add(bins_[i][bin_of(kAxes[i], value)]);
    }
    if (prediction.has_answer) return;
    for (const ValidityCheck& check : prediction.validity)
      if (!check.holds()) {
        ++refusals_[check.message];
        return;
      }
  }

  void broken(const char* invariant, const ContactProblem& problem) {
    auto& [times, first] = broken_[invariant];
    if (times++ == 0) first = in_words(problem);
  }

  const PressureModel& model_;
  int tried_ = 0, nonsense_ = 0, nonsense_refused_ = 0;
  Counts total_;
  std::map<std::string, int> refusals_;
  std::array<Range, kAxes.size()> ranges_;
  std::array<std::map<int, Counts>, kAxes.size()> bins_;
  double units_ = 0, jump_ = -1, slowest_ns_ = 0;
  std::map<std::string, std::pair<int, std::string>> broken_;  ///< how often, and the first problem
};

}  // namespace

json survey(const SurveyOptions& options) {
  json models = json::array(), axes = json::array();
  for (const Axis& axis : kAxes)
    axes.push_back({{"key", axis.key}, {"name", axis.name}, {"logarithmic", axis.logarithmic}});
  for (const PressureModel* model : all_pressure_models()) {
    const bool fast = model->card().hot_path;
    // Models that discretise get only layers that their grid can resolve.
    ExtremeProblems problems(options.seed, fast ? 1e-9 : 0.2);
    // Separate random numbers: the problems must not depend on the model's answers.
    ExtremeProblems second_look(options.seed + 1), lines(options.seed + 2);
    ModelSurvey found(*model);
    const int points = fast ? options.points : options.slow_points;
    for (int i = 0; i < points; ++i) {
      if (i % 16 == 5)
        found.ask_nonsense(problems.draw_broken());
      else
        found.ask(problems.draw(), second_look);
    }
    found.look_for_jumps(lines, options.lines);
    models.push_back(found.result());
  }
  return {{"seed", options.seed},
          {"points", options.points},
          {"slow_points", options.slow_points},
          {"axes", axes},
          {"models", models}};
}

bool all_invariants_hold(const json& survey) {
  for (const json& model : survey.at("models"))
    if (!model.at("broken_promises").empty()) return false;
  return true;
}

std::string table(const json& survey) {
  std::string text = fmt::format("{:<22}{:>8}{:>10}{:>12}{:>10}{:>12}{:>12}{:>14}  {}\n", "model",
                                 "tried", "valid", "outside it", "refused", "units to", "jumps",
                                 "slowest call", "invariants");
  std::string failures;
  for (const json& model : survey.at("models")) {
    const double tried = std::max(1, model.at("tried").get<int>());
    const auto part = [&](const char* key) {
      return fmt::format("{:.1f} %", 100 * model.at(key).get<double>() / tried);
    };
    const json& jump = model.at("largest_jump");
    const double slowest_us = model.at("slowest_call_ns").get<double>() * 1e-3;
    text += fmt::format("{:<22}{:>8}{:>10}{:>12}{:>10}{:>12}{:>12}{:>14}  {}\n",
                        model.at("model").get<std::string>(), model.at("tried").get<int>(),
                        part("valid"), part("answered_outside_validity"), part("refused"),
                        fmt::format("{:.1e}", model.at("units_worst_deviation").get<double>()),
                        jump.is_null() ? "not tried" : fmt::format("{:.1e}", jump.get<double>()),
                        slowest_us < 1e3 ? fmt::format("{:.3g} us", slowest_us)
                                         : fmt::format("{:.3g} ms", slowest_us * 1e-3),
                        model.at("broken_promises").empty() ? "hold" : "VIOLATED");
    for (const json& broken : model.at("broken_promises"))
      failures +=
          fmt::format("{}: {}, {} times, first at {}\n", model.at("model").get<std::string>(),
                      broken.at("promise").get<std::string>(), broken.at("count").get<int>(),
                      broken.at("first").get<std::string>());
  }
  return text + failures;
}

}  // namespace softfinger::extremes
