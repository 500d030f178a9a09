#include "comparisons/exporting/contact_curve.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/exporting/contact_stiffness.h"
#include "comparisons/judgement/assessment.h"
#include "comparisons/judgement/next_step.h"
#include "comparisons/judgement/reason.h"
#include "comparisons/prediction/answer_in_time.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/input/errors.h"

namespace softfinger::exporting {
namespace {

double middle_of(std::vector<double> loads_N) {
  std::sort(loads_N.begin(), loads_N.end());
  const std::size_t half = loads_N.size() / 2;
  return loads_N.size() % 2 ? loads_N[half]
                            : std::sqrt(loads_N[half - 1]) * std::sqrt(loads_N[half]);
}

bool is_load(double load_N) { return std::isfinite(load_N) && load_N > 0; }

LoadPoint ask(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
              const PressureModel& model, double load_N, double time_s,
              const prediction::Demand& demand, const judgement::DoubtedCases* doubted = nullptr) {
  std::optional<prediction::AnswerInTime> in_time;
  if (contact_case.times.are_given())
    in_time = ask_in_time(model, contact_case, geometry,
                          prediction::moment_under(contact_case, load_N, time_s));
  prediction::ModelAnswer answer =
      in_time ? in_time->elastic : prediction::ask_model(model, contact_case, geometry, load_N);
  const Prediction& prediction = answer.prediction;
  if (!prediction.has_answer || !(prediction.torque_arm_exact_m > 0))
    throw InputError(contact_case.id, "--model", std::string(model.card().name),
                     fmt::format("a model with a torque at {:g} N ({})", load_N,
                                 judgement::reason_not_usable(answer, demand)));
  answer.assessment =
      judgement::assess(contact_case, geometry, answer, prediction::TorqueRule::exact, demand);
  const auto inputs = doubted ? doubted->move(answer, prediction::TorqueRule::exact) : std::nullopt;
  if (in_time) {
    in_time->elastic = answer;
    adopt_errors(*in_time);
    answer = in_time->now;
  }
  const Prediction& pressed = answer.pressed();
  const FrictionEllipsoid limit = answer.friction_ellipsoid(prediction::TorqueRule::exact);
  // Under Coulomb's law the coefficient is the case's own, to the last digit.
  const double friction = contact_case.shear_law.has_shear_strength()
                              ? limit.max_force_N / load_N
                              : contact_case.shear_law.friction_coefficient;
  return {load_N,
          friction,
          limit.eccentricity_m,
          pressed.indentation_m,
          pressed.a_m,
          pressed.b_m,
          answer.assessment->usable ? "" : judgement::reason_not_usable(answer, demand),
          *answer.assessment,
          inputs,
          in_time ? in_time->effective_load_N : load_N};
}

}  // namespace

LoadRange choose_loads(const std::vector<double>& case_loads_N, const LoadChoice& choice) {
  if (choice.nominal_N && !is_load(*choice.nominal_N))
    throw InputError("command line", "--load", *choice.nominal_N, "a number > 0, in N");
  LoadRange loads;
  loads.nominal_N = choice.nominal_N.value_or(middle_of(case_loads_N));
  if (choice.range_N) {
    const auto& range_N = *choice.range_N;
    if (range_N.size() != 2 || !is_load(range_N[0]) || !is_load(range_N[1]) ||
        range_N[0] >= range_N[1])
      throw InputError("command line", "--load-range", fmt::format("{:g}", fmt::join(range_N, ",")),
                       "LOW,HIGH in N with 0 < LOW < HIGH");
    loads.lowest_N = range_N[0];
    loads.highest_N = range_N[1];
    const bool inside = loads.lowest_N <= loads.nominal_N && loads.nominal_N <= loads.highest_N;
    if (!inside && choice.nominal_N)
      throw InputError("command line", "--load", loads.nominal_N,
                       fmt::format("a load within --load-range, {:g} to {:g} N", loads.lowest_N,
                                   loads.highest_N));
    if (!inside) loads.nominal_N = middle_of(range_N);
    return loads;
  }
  if (case_loads_N.size() > 1) {
    const auto [low, high] = std::minmax_element(case_loads_N.begin(), case_loads_N.end());
    loads.lowest_N = std::min(*low, loads.nominal_N);
    loads.highest_N = std::max(*high, loads.nominal_N);
  } else {
    loads.lowest_N = loads.nominal_N / 3;
    loads.highest_N = loads.nominal_N * 3;
  }
  return loads;
}

ContactCurve ask_contact_curve(const input::Case& contact_case,
                               const prediction::GeometryResolver& resolver,
                               const PressureModel* chosen, const LoadRange& loads,
                               const prediction::Demand& demand) {
  const bool knows_time = contact_case.times.are_given();
  const auto moment_at = [&](double load_N) {
    return prediction::moment_under(contact_case, load_N, loads.time_s);
  };
  const prediction::LocalGeometry nominal =
      knows_time ? geometry_at(contact_case, resolver, moment_at(loads.nominal_N))
                 : judgement::resolve_or_advise(contact_case, resolver, loads.nominal_N, demand);
  const PressureModel& model =
      chosen ? *chosen
             : default_model(prediction::contact_problem(contact_case, nominal, loads.nominal_N));
  ContactCurve curve;
  curve.case_id = contact_case.id;
  curve.model = std::string(model.card().name);
  curve.shear_law = contact_case.shear_law;
  curve.radii = nominal.radii;
  if (knows_time) curve.when = " " + prediction::in_words(moment_at(loads.nominal_N));
  const auto at = [&](double load_N) {
    return ask(contact_case,
               knows_time ? geometry_at(contact_case, resolver, moment_at(load_N))
                          : resolver.resolve(load_N),
               model, load_N, loads.time_s, demand);
  };
  const judgement::DoubtedCases doubted(contact_case, resolver);
  curve.nominal =
      ask(contact_case, nominal, model, loads.nominal_N, loads.time_s, demand, &doubted);
  if (!curve.nominal.assessment.usable && knows_time) {
    curve.advice = curve.nominal.reason;
  } else if (!curve.nominal.assessment.usable) {
    prediction::ModelAnswer answer =
        prediction::ask_model(model, contact_case, nominal, loads.nominal_N);
    answer.assessment = curve.nominal.assessment;
    curve.advice = judgement::next_step(contact_case, resolver, answer, demand).in_words();
  }

  constexpr int kSteps = 6;
  const double step = std::log(loads.highest_N / loads.lowest_N) / kSteps;
  for (int i = 0; i <= kSteps; ++i) {
    // The ends are exactly the numbers that the user typed, without rounding errors.
    const double load_N = i == 0        ? loads.lowest_N
                          : i == kSteps ? loads.highest_N
                                        : loads.lowest_N * std::exp(i * step);
    // An inner point near the nominal load is left out, as the nominal load stands for it. An end
    // is left out only if it is the nominal load.
    const double apart = std::abs(std::log(load_N / loads.nominal_N));
    if (apart > (i == 0 || i == kSteps ? 1e-9 : step / 3)) curve.points.push_back(at(load_N));
  }
  curve.points.push_back(curve.nominal);
  std::sort(curve.points.begin(), curve.points.end(),
            [](const LoadPoint& one, const LoadPoint& other) { return one.load_N < other.load_N; });

  const LoadPoint above = at(loads.nominal_N * kLoadStep), below = at(loads.nominal_N / kLoadStep);
  const double span = 2 * std::log(kLoadStep);
  curve.load_exponent = std::log(above.eccentricity_m / below.eccentricity_m) / span;
  if (knows_time) {
    // A simulator's contact moves faster than rubber relaxes: the elastic contact of this size.
    const double size_N = curve.nominal.effective_load_N;
    const auto elastic_m = [&](double load_N) {
      return prediction::ask_model(model, contact_case, nominal, load_N).pressed().indentation_m;
    };
    curve.normal_stiffness_N_per_m = normal_stiffness_N_per_m(
        size_N, elastic_m(size_N), elastic_m(size_N / kLoadStep), elastic_m(size_N * kLoadStep));
  } else {
    curve.normal_stiffness_N_per_m =
        normal_stiffness_N_per_m(curve.nominal.load_N, curve.nominal.indentation_m,
                                 below.indentation_m, above.indentation_m);
  }
  curve.torsional_stiffness_Nm_per_rad = torsional_stiffness_Nm_per_rad(
      prediction::contact_problem(contact_case, nominal, loads.nominal_N), curve.nominal.a_m,
      curve.nominal.b_m);
  curve.friction_exponent =
      std::log(above.friction_coefficient / below.friction_coefficient) / span;
  return curve;
}

}  // namespace softfinger::exporting
