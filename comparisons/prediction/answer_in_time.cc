#include "comparisons/prediction/answer_in_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/prediction/answer_json.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::prediction {
namespace {

using Drive = ContactHistory::Drive;

/// The library's refusals, at the line of the case.
[[noreturn]] void refuse_at(const input::Case& contact_case, const InputError& error) {
  throw InputError(contact_case.times.where, error.where() + ": " + error.field(), error.value(),
                   error.allowed());
}

/// The case's answer to an elastic problem, where there is a load; else one without an answer.
ModelAnswer elastic_or_none(const PressureModel& model, const input::Case& contact_case,
                            const LocalGeometry& geometry, double load_N,
                            const PredictionInTime& now, std::optional<double> time_budget_ns) {
  if (load_N > 0 && now.prediction.has_answer)
    return ask_model(model, contact_case, geometry, load_N, time_budget_ns);
  ModelAnswer none;
  none.model = &model;
  none.problem = contact_problem(contact_case, geometry, load_N > 0 ? load_N : 1);
  none.shear_law = contact_case.shear_law;
  none.prediction.validity = now.prediction.validity;
  return none;
}

/// Relative changes against rubber that has not relaxed.
struct Change {
  double a, b, area, indentation, peak_pressure, max_torque, load;
};
Change change_of(const AnswerInTime& answer, TorqueRule rule) {
  // A change below the models' rounding is none.
  constexpr double kRounding = 1e-9;
  const auto relative = [](double now, double before) {
    const double change = now / before - 1;
    return std::abs(change) < kRounding ? 0 : change;
  };
  const Prediction& now = answer.now.prediction;
  const Prediction& before = answer.unrelaxed.prediction;
  return {relative(now.a_m, before.a_m),
          relative(now.b_m, before.b_m),
          relative(now.area_m2(), before.area_m2()),
          relative(now.indentation_m, before.indentation_m),
          relative(now.peak_pressure_Pa, before.peak_pressure_Pa),
          relative(answer.now.friction_ellipsoid(rule).max_torque_Nm(),
                   answer.unrelaxed.friction_ellipsoid(rule).max_torque_Nm()),
          relative(answer.now.problem.load.normal_force_N,
                   answer.unrelaxed.problem.load.normal_force_N)};
}

}  // namespace

std::vector<Moment> moments_of(const input::Case& contact_case, std::optional<double> time_s) {
  const input::ContactTimes& times = contact_case.times;
  std::vector<Moment> moments;
  try {
    if (!times.history.empty()) {
      const ContactHistory history = times.of(0);
      moments.push_back({history, time_s.value_or(history.end_s()), false});
    } else {
      for (const double load_N : contact_case.loads_N)
        for (const double at_s : time_s ? std::vector{*time_s} : std::vector{0., double(INFINITY)})
          moments.push_back({times.of(load_N), at_s, true});
    }
    for (const Moment& moment : moments)
      if (!std::isinf(moment.time_s)) moment.history.at(moment.time_s);
  } catch (const InputError& error) {
    refuse_at(contact_case, error);
  }
  return moments;
}

bool is_only_held(const Moment& moment) {
  return moment.history.begin_s() == moment.history.end_s();
}

std::vector<Moment> curve_of(const Moment& moment) {
  const ContactHistory& history = moment.history;
  const auto& terms = history.relaxation().terms();
  const double begin_s = history.begin_s();
  std::vector<double> times_s = {begin_s};
  constexpr int kCurvePoints = 80;
  if (is_only_held(moment)) {
    const double first_s = terms.empty() ? 1e-2 : terms.back().time_s / 20;
    double last_s = terms.empty() ? 1 : 20 * terms.front().time_s;
    if (std::isfinite(moment.time_s)) last_s = std::max(last_s, 2 * (moment.time_s - begin_s));
    for (int i = 0; i <= kCurvePoints; ++i)
      times_s.push_back(begin_s + first_s * std::pow(last_s / first_s, i / double(kCurvePoints)));
  } else {
    const double end_s =
        std::isfinite(moment.time_s) ? std::max(history.end_s(), moment.time_s) : history.end_s();
    for (int i = 1; i <= kCurvePoints; ++i)
      times_s.push_back(begin_s + (end_s - begin_s) * i / kCurvePoints);
    for (const double time_s : history.times_s()) times_s.push_back(time_s);
    std::sort(times_s.begin(), times_s.end());
    times_s.erase(std::unique(times_s.begin(), times_s.end()), times_s.end());
  }
  std::vector<Moment> moments;
  for (const double time_s : times_s) {
    try {
      history.at(time_s);
      moments.push_back({history, time_s, moment.is_held});
    } catch (const InputError&) {
      // A time at which nothing touches, or the contact has grown again: the page says so.
    }
  }
  return moments;
}

Moment moment_under(const input::Case& contact_case, double load_N, double time_s) {
  const input::ContactTimes& times = contact_case.times;
  if (times.drive == Drive::approach)
    throw InputError(times.where, "history by approach_mm", "",
                     "history by load_N here, or load_N alone: an exported contact is pressed by "
                     "loads");
  if (times.history.empty()) return {times.of(load_N), time_s, true};
  try {
    const double there_N =
        ContactHistory(times.relaxation, times.drive, times.history).value(time_s);
    if (!(there_N > 0))
      throw InputError("history", fmt::format("load at {:g} s", time_s), there_N,
                       "a time at which the bodies are pressed");
    std::vector<HistoryPoint> scaled = times.history;
    for (HistoryPoint& point : scaled) point.value *= load_N / there_N;
    return {ContactHistory(times.relaxation, times.drive, scaled), time_s, false};
  } catch (const InputError& error) {
    refuse_at(contact_case, error);
  }
}

std::string in_words(const Moment& moment) {
  if (!moment.is_held) return fmt::format("at {:g} s", moment.time_s);
  if (moment.time_s == 0) return "at once";
  return std::isinf(moment.time_s) ? "held for long" : fmt::format("held {:g} s", moment.time_s);
}

LocalGeometry geometry_at(const input::Case& contact_case, const GeometryResolver& resolver,
                          const Moment& moment) {
  const ContactHistory& history = moment.history;
  const bool rests = std::isinf(moment.time_s);
  const double size = rests ? history.value(moment.time_s) : history.at(moment.time_s).size;
  if (history.drive() == Drive::load)
    return resolver.resolve(rests ? size / history.relaxation().long_time_modulus() : size);
  // The load of an approach follows from the radii, which of meshes follow from the load.
  LocalGeometry geometry = resolver.resolve(1);
  constexpr int kRounds = 5;
  for (int round = 0; round < (geometry.patch ? kRounds : 0); ++round) {
    const double load_N = load_at_approach_N(*find_pressure_model("fingertip_layer"),
                                             contact_problem(contact_case, geometry, 1), size);
    if (!(load_N > 0)) break;
    geometry = resolver.resolve(load_N);
  }
  return geometry;
}

AnswerInTime ask_in_time(const PressureModel& model, const input::Case& contact_case,
                         const LocalGeometry& geometry, const Moment& moment,
                         std::optional<double> time_budget_ns) {
  const ContactProblem problem = contact_problem(contact_case, geometry, 1);
  PredictionInTime now;
  try {
    now = predict_at(model, problem, moment.history, moment.time_s);
  } catch (const InputError& error) {
    refuse_at(contact_case, error);
  }
  AnswerInTime answer;
  answer.effective_load_N = now.effective_load_N;
  answer.elastic =
      elastic_or_none(model, contact_case, geometry, now.effective_load_N, now, time_budget_ns);
  answer.now = answer.elastic;
  if (!now.prediction.has_answer) return answer;
  const Validity validity = answer.elastic.prediction.validity;  // with the case's own checks
  answer.now.prediction = now.prediction;
  answer.now.prediction.validity = validity;
  answer.now.problem.load.normal_force_N = now.load_N;
  const double value = moment.history.value(moment.time_s);
  const double same_N =
      moment.history.drive() == Drive::load ? value : load_at_approach_N(model, problem, value);
  answer.unrelaxed = elastic_or_none(model, contact_case, geometry, same_N, now, std::nullopt);
  return answer;
}

void adopt_errors(AnswerInTime& answer) {
  answer.now.assessment = answer.elastic.assessment;
  answer.now.deviations = answer.elastic.deviations;
  if (!answer.now.deviations) return;
  const auto torque = [](const ModelAnswer& of, TorqueRule rule) {
    return of.friction_ellipsoid(rule).max_torque_Nm();
  };
  const auto part = [&](TorqueRule rule) {
    return torque(answer.now, rule) / torque(answer.elastic, rule);
  };
  auto& deviations = *answer.now.deviations;
  deviations.torque_exact_Nm *= part(TorqueRule::exact);
  deviations.torque_paper_Nm *= part(TorqueRule::paper);
  deviations.peak_pressure_Pa *=
      answer.now.prediction.peak_pressure_Pa / answer.elastic.prediction.peak_pressure_Pa;
}

std::string change_in_words(const AnswerInTime& answer, const Moment& moment, TorqueRule rule) {
  const bool has_answers =
      answer.now.prediction.has_answer && answer.unrelaxed.prediction.has_answer;
  const bool is_elastic = moment.history.relaxation().is_elastic();
  if (!has_answers || is_elastic || (moment.is_held && moment.time_s == 0)) return "";
  const Change change = change_of(answer, rule);
  std::string text = moment.is_held ? "against t = 0: " : "against rubber that has not relaxed: ";
  if (moment.history.drive() == Drive::approach)
    text += fmt::format("load {:+.1f} %, ", 100 * change.load);
  return text + fmt::format(
                    "torque {:+.1f} %, area {:+.1f} %, indentation {:+.1f} %; as large as the "
                    "elastic contact under {:.3g} N",
                    100 * change.max_torque, 100 * change.area, 100 * change.indentation,
                    answer.effective_load_N);
}

nlohmann::json to_json(const AnswerInTime& answer, const Moment& moment, TorqueRule rule,
                       int limit_surface_points) {
  nlohmann::json result = to_json(answer.now, rule, limit_surface_points);
  const nlohmann::json elastic = to_json(answer.elastic, rule, 0);
  for (const char* key : {"normal_stiffness_N_per_m", "torsional_stiffness_Nm_per_rad",
                          "tangential_stiffness_N_per_m"})
    result[key] = elastic[key];
  result["time_s"] = text::finite_or_null(moment.time_s);
  result["effective_load_N"] = nullptr;
  result["change"] = nullptr;
  if (!answer.now.prediction.has_answer) return result;
  result["effective_load_N"] = answer.effective_load_N;
  if (!answer.unrelaxed.prediction.has_answer) return result;
  const Change change = change_of(answer, rule);
  result["change"] = {{"a", text::finite_or_null(change.a)},
                      {"b", text::finite_or_null(change.b)},
                      {"area", text::finite_or_null(change.area)},
                      {"indentation", text::finite_or_null(change.indentation)},
                      {"peak_pressure", text::finite_or_null(change.peak_pressure)},
                      {"max_torque", text::finite_or_null(change.max_torque)},
                      {"load", text::finite_or_null(change.load)}};
  return result;
}

nlohmann::json relaxation_json(const input::ContactTimes& times) {
  nlohmann::json terms = nlohmann::json::array();
  for (const RelaxationTerm& term : times.relaxation.terms())
    terms.push_back({{"share", term.share}, {"time_s", term.time_s}});
  return terms;
}

nlohmann::json history_json(const input::ContactTimes& times) {
  if (times.history.empty()) return nullptr;
  const char* const key = times.drive == Drive::load ? "load_N" : "approach_m";
  nlohmann::json points = nlohmann::json::array();
  for (const HistoryPoint& point : times.history)
    points.push_back({{"time_s", point.time_s}, {key, point.value}});
  return points;
}

}  // namespace softfinger::prediction
