#include "comparisons/explorer/explorer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "comparisons/explorer/json_parts.h"
#include "comparisons/exporting/contact_stiffness.h"
#include "comparisons/exporting/simulator.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/accuracy/pressing_error.h"
#include "softfinger/friction/ellipsoid_deviation.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/pressure/equivalent_exponent.h"
#include "softfinger/pressure/rubbed_prediction.h"
#include "softfinger/pressure/stack_models.h"

namespace softfinger::explorer {
namespace {

struct Answer {
  Prediction prediction;  ///< of frictionless pressing, which the largest torque is that of
  Prediction pressed;     ///< with friction, where the model knows it
  ErrorBound bound;

  double worst() const { return worst_of(bound.bound); }
};

std::string model_json(const PressureModel& model, const Answer& answer, const Question& question) {
  const Prediction& prediction = answer.prediction;
  const Prediction& pressed = answer.pressed;
  const ContactLoad& load = question.problem.load;
  const double torque_Nm =
      load.friction_coefficient * load.normal_force_N * prediction.torque_arm_exact_m;
  const auto told = [&](double value) { return json_number(prediction.has_answer ? value : kNaN); };
  List bounds, objections;
  for (const double bound : answer.bound.bound) bounds.add(json_number(bound));
  for (const ValidityCheck& check : prediction.validity)
    if (!check.holds()) objections.add(json_string(check.message));
  const bool usable = answer.bound.known && answer.worst() <= question.tolerance;
  return fmt::format(
      "{{\"name\":{},\"has_answer\":{},\"a_m\":{},\"b_m\":{},\"indentation_m\":{},\"area_m2\":{},"
      "\"peak_pressure_Pa\":{},\"max_torque_Nm\":{},\"eccentricity_m\":{},\"bound\":{},"
      "\"outside\":{},\"usable\":{},\"objections\":{}}}",
      json_string(model.card().name), prediction.has_answer, told(pressed.a_m), told(pressed.b_m),
      told(pressed.indentation_m), told(pressed.area_m2()), told(pressed.peak_pressure_Pa),
      told(torque_Nm), told(prediction.torque_arm_exact_m),
      answer.bound.known ? bounds.text() : "null", json_string(answer.bound.outside), usable,
      objections.text());
}

std::string profile_json(const PressureModel& model, const ContactProblem& problem,
                         const Prediction& pressed) {
  // Steps that are shorter towards the edge, where the pressure of most models falls steeply.
  constexpr int kSteps = 48;
  List position, along_long, along_short;
  for (int i = 0; i <= kSteps; ++i) {
    const double part = std::sin(kPi / 2 * i / kSteps);
    position.add(json_number(part));
    along_long.add(json_number(model.pressure_Pa(problem, pressed, part * pressed.a_m, 0)));
    along_short.add(json_number(model.pressure_Pa(problem, pressed, 0, part * pressed.b_m)));
  }
  return fmt::format("{{\"position\":{},\"long_Pa\":{},\"short_Pa\":{}}}", position.text(),
                     along_long.text(), along_short.text());
}

/// Forces along one axis of the ellipse from pure force to pure torque. By the symmetry of the
/// ellipse, a twist that slides along the axis and turns needs no force across it.
std::string section_json(const LimitSurface& surface, bool along_long, double eccentricity_m) {
  constexpr int kSteps = 40;
  List points;
  for (int i = 0; i <= kSteps; ++i) {
    const double angle_rad = kPi / 2 * i / kSteps;
    const double slide = i == kSteps ? 0 : std::cos(angle_rad);
    const LimitWrench wrench = surface.wrench_for_twist(
        {along_long ? slide : 0, along_long ? 0 : slide, std::sin(angle_rad) / eccentricity_m});
    points.add(fmt::format("[{},{}]", json_number(along_long ? wrench.force_x_N : wrench.force_y_N),
                           json_number(wrench.torque_Nm)));
  }
  return points.text();
}

std::string limit_json(const ContactProblem& problem, const Prediction& prediction) {
  const double max_force_N = problem.load.friction_coefficient * problem.load.normal_force_N;
  const FrictionEllipsoid ellipsoid{max_force_N, prediction.torque_arm_exact_m};
  const double exponent = equivalent_exponent(prediction);
  const LimitSurface surface(prediction.a_m, prediction.b_m, exponent, max_force_N);
  const EllipsoidDeviation deviation = worst_ellipsoid_deviation(surface, ellipsoid);
  return fmt::format(
      "{{\"exponent\":{},\"along_long\":{},\"along_short\":{},\"lowest\":{},\"highest\":{},"
      "\"max_force_N\":{},\"max_torque_Nm\":{}}}",
      json_number(exponent), section_json(surface, true, ellipsoid.eccentricity_m),
      section_json(surface, false, ellipsoid.eccentricity_m), json_number(deviation.lowest),
      json_number(deviation.highest), json_number(ellipsoid.max_force_N),
      json_number(ellipsoid.max_torque_Nm()));
}

std::string simulators_json(const PressureModel& model, const ContactProblem& problem,
                            const Answer& answer) {
  const Prediction& prediction = answer.prediction;
  exporting::SoftContact contact;
  contact.friction_coefficient = problem.load.friction_coefficient;
  contact.load_N = problem.load.normal_force_N;
  contact.eccentricity_m = prediction.torque_arm_exact_m;
  contact.indentation_m = answer.pressed.indentation_m;
  const auto indentation_at = [&](double load_N) {
    ContactProblem other = problem;
    other.load.normal_force_N = load_N;
    return as_pressed(model, model.predict(other), other, other.load.friction_coefficient)
        .indentation_m;
  };
  using exporting::kLoadStep;
  contact.normal_stiffness_N_per_m = exporting::normal_stiffness_N_per_m(
      contact.load_N, contact.indentation_m, indentation_at(contact.load_N / kLoadStep),
      indentation_at(contact.load_N * kLoadStep));
  contact.torsional_stiffness_Nm_per_rad =
      exporting::torsional_stiffness_Nm_per_rad(problem, answer.pressed.a_m, answer.pressed.b_m);
  contact.radii = problem.radii;
  contact.origin = fmt::format("explorer, {}, {:.4g} N", model.card().name, contact.load_N);
  List list;
  for (const exporting::Simulator& simulator : exporting::all_simulators())
    list.add(fmt::format("{{\"name\":{},\"text\":{}}}", json_string(simulator.name),
                         json_string(point_lines(simulator, contact).text)));
  return list.text();
}

}  // namespace

const std::vector<const PressureModel*>& models() {
  static const std::vector<const PressureModel*> fast = [] {
    std::vector<const PressureModel*> found;
    for (const PressureModel* model : all_pressure_models())
      if (model->card().hot_path && !model->card().is_empirical && !is_for_stacks(*model))
        found.push_back(model);
    return found;
  }();
  return fast;
}

std::string answer(const Question& question) {
  const ContactProblem& problem = question.problem;
  std::vector<Answer> answers;
  List list;
  const PressureModel* const recommended = &default_model(problem);
  int nearest = -1, by_default = -1;
  for (const PressureModel* model : models()) {
    const int place = int(answers.size());
    Answer told;
    told.prediction = model->predict(problem);
    told.pressed = as_pressed(*model, told.prediction, problem, problem.load.friction_coefficient);
    told.bound = error_bound(*model, problem, problem.load.friction_coefficient);
    if (told.prediction.has_answer && !knows_pressing_friction(*model))
      told.prediction.validity.add(check_frictionless_pressing(*model, told.prediction, problem,
                                                               problem.load.friction_coefficient));
    answers.push_back(told);
    list.add(model_json(*model, told, question));
    if (model == recommended) by_default = place;
    if (told.bound.known && (nearest < 0 || told.worst() < answers[std::size_t(nearest)].worst()))
      nearest = place;
  }
  int shown = question.shown;
  if (shown == -2)
    shown = -1;
  else if (shown < 0 || shown >= int(answers.size()) ||
           !answers[std::size_t(shown)].prediction.has_answer)
    shown = answers[std::size_t(by_default)].prediction.has_answer ? by_default : -1;
  std::string profile = "null", limit = "null", simulators = "[]";
  if (shown >= 0) {
    const PressureModel& model = *models()[std::size_t(shown)];
    const Answer& told = answers[std::size_t(shown)];
    profile = profile_json(model, problem, told.pressed);
    limit = limit_json(problem, told.prediction);
    simulators = simulators_json(model, problem, told);
  }
  return fmt::format(
      "{{\"models\":{},\"nearest\":{},\"recommended\":{},\"shown\":{},\"profile\":{},\"limit\":{},"
      "\"simulators\":{}}}",
      list.text(), nearest, by_default, shown, profile, limit, simulators);
}

}  // namespace softfinger::explorer
