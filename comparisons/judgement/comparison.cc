#include "comparisons/judgement/comparison.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "comparisons/judgement/assessment.h"
#include "comparisons/reference/fem_process.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/rubbed_prediction.h"
#include "softfinger/pressure/stack_models.h"

namespace softfinger::judgement {
namespace {

using prediction::ModelAnswer;
using prediction::TorqueRule;
using reference::PressureProfile;
using Clock = std::chrono::steady_clock;

constexpr double kCostBudget_ns = 1e5;  // per model and load: milliseconds for the whole suite

/// Whether a profile of the model's pressure may be drawn without being felt: some models solve
/// their problem anew for a point of it.
bool has_cheap_pressure(const ModelAnswer& answer) {
  constexpr double kAffordable_ms = 2;
  if (answer.model->card().hot_path) return true;
  const auto start = Clock::now();
  answer.model->pressure_Pa(answer.problem, answer.pressed(), 0, 0);
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count() < kAffordable_ms;
}

double pressure_Pa(const ModelAnswer& answer, double x_m, double y_m) {
  return answer.rubbed ? rubbed_pressure_Pa(*answer.model, answer.problem, *answer.rubbed, x_m, y_m)
                       : answer.model->pressure_Pa(answer.problem, answer.prediction, x_m, y_m);
}

PressureProfile profile(const ModelAnswer& answer, bool along_x) {
  constexpr int kPoints = 61;
  constexpr double kQuarterTurn_rad = 1.57079632679489662;
  PressureProfile profile;
  const double end_m = along_x ? answer.pressed().a_m : answer.pressed().b_m;
  for (int i = 0; i < kPoints; ++i) {
    // Denser towards the edge, where a Hertz pressure falls steeply.
    const double x_m = end_m * std::sin(kQuarterTurn_rad * i / (kPoints - 1));
    profile.position_m.push_back(x_m);
    profile.pressure_Pa.push_back(pressure_Pa(answer, along_x ? x_m : 0, along_x ? 0 : x_m));
  }
  return profile;
}

/// Linear between the points of a profile, zero beyond them.
double pressure_at(const PressureProfile& profile, double x_m) {
  const auto& x = profile.position_m;
  const auto after = std::upper_bound(x.begin(), x.end(), x_m);
  if (after == x.begin()) return profile.pressure_Pa.front();
  if (after == x.end()) return x_m == x.back() ? profile.pressure_Pa.back() : 0;
  const auto i = std::size_t(after - x.begin());
  const double weight = (x_m - x[i - 1]) / (x[i] - x[i - 1]);
  return (1 - weight) * profile.pressure_Pa[i - 1] + weight * profile.pressure_Pa[i];
}

/// int |p - q| r dr / int q r dr.
double misfit(const PressureProfile& profile, const PressureProfile& truth) {
  if (profile.position_m.empty() || truth.position_m.empty()) return kNaN;
  constexpr int kSteps = 400;
  const double end_m = std::max(profile.position_m.back(), truth.position_m.back());
  double difference = 0, all = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double r_m = (i + 0.5) / kSteps * end_m, expected = pressure_at(truth, r_m);
    difference += std::abs(pressure_at(profile, r_m) - expected) * r_m;
    all += expected * r_m;
  }
  return all > 0 ? difference / all : kNaN;
}

ModelComparison compare_model(const PressureModel& model, const Comparison& load) {
  ModelComparison comparison;
  comparison.answer =
      prediction::ask_model(model, *load.contact_case, load.geometry, load.load_N, kCostBudget_ns);
  if (load.geometry.patch)
    prediction::propagate_radii_uncertainty(load.geometry.patch->relative, comparison.answer);
  comparison.answer.assessment = assess(*load.contact_case, load.geometry, comparison.answer,
                                        TorqueRule::exact, prediction::Demand{});
  if (!comparison.answer.prediction.has_answer) return comparison;
  if (has_cheap_pressure(comparison.answer)) {
    comparison.along_x = profile(comparison.answer, true);
    comparison.along_y = profile(comparison.answer, false);
  }
  if (load.reference) {
    comparison.errors = relative_errors(comparison.answer, *load.reference);
    if (comparison.along_x && comparison.along_y)
      comparison.errors->pressure_misfit = (misfit(*comparison.along_x, load.reference->along_x) +
                                            misfit(*comparison.along_y, load.reference->along_y)) /
                                           2;
  }
  return comparison;
}

/// `power_law` needs a measured law. In a case without one it is left out of the comparison,
/// because its missing answer is no failure.
bool is_applicable(const ModelAnswer& answer) {
  return std::string_view(answer.prediction.validity.begin()->check) != "power_law_known";
}

}  // namespace

std::optional<double> Comparison::size() const {
  if (!reference) return std::nullopt;
  return std::sqrt(reference->a_m * reference->b_m) / contact_case->layer.thickness_m;
}

std::optional<prediction::QuantityErrors> Comparison::geometry_error() const {
  for (const ModelComparison& model : models)
    if (model.answer.model->card().name == "bonded_layer" && model.answer.assessment)
      return model.answer.assessment->geometry;
  return std::nullopt;
}

RelativeErrors relative_errors(const ModelAnswer& answer,
                               const reference::ReferenceResult& reference) {
  const Prediction& prediction = answer.pressed();
  const auto torque_Nm = [&](TorqueRule rule) {
    return answer.friction_ellipsoid(rule).max_torque_Nm();
  };
  const auto error = [](double value, double truth) { return (value - truth) / truth; };
  return {error(prediction.a_m, reference.a_m),
          error(prediction.b_m, reference.b_m),
          error(prediction.area_m2(), reference.area_projected_m2),
          error(prediction.indentation_m, reference.indentation_m),
          error(prediction.peak_pressure_Pa, reference.peak_pressure_Pa),
          error(torque_Nm(TorqueRule::exact), reference.max_torque_Nm),
          error(torque_Nm(TorqueRule::paper), reference.max_torque_Nm),
          kNaN};
}

Comparison compare(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                   double load_N, std::optional<reference::ReferenceResult> reference,
                   const std::string& failure) {
  Comparison comparison;
  comparison.contact_case = &contact_case;
  comparison.load_N = load_N;
  comparison.geometry = geometry;
  comparison.reference = std::move(reference);
  comparison.failure = failure;
  comparison.folder = reference::load_folder(contact_case.id, load_N);
  for (const PressureModel* model : all_pressure_models())
    if ((!model->card().finite_strain || contact_case.fem_finite) &&
        (!is_for_stacks(*model) || has_several_layers(contact_case)))
      comparison.models.push_back(compare_model(*model, comparison));
  return comparison;
}

bool is_sound(const Prediction& prediction, const input::Case& contact_case) {
  constexpr std::array<std::string_view, 6> of_deformation = {
      "small_strain", "small_slope",          "fitted_indentation",
      "fitted_slope", "fitted_poisson_ratio", "round_contact"};
  const auto is_measured = [&](const ValidityCheck& check) {
    if (std::string_view(check.check) == "homogeneous") return !contact_case.sublayers.empty();
    return contact_case.fem_finite && std::find(of_deformation.begin(), of_deformation.end(),
                                                check.check) != of_deformation.end();
  };
  return prediction.has_answer &&
         std::all_of(
             prediction.validity.begin(), prediction.validity.end(),
             [&](const ValidityCheck& check) { return check.holds() || is_measured(check); });
}

std::string reference_in_words(const input::Case& contact_case) {
  const char* const what = contact_case.fem_curved                     ? "the finger"
                           : contact_case.object_layer.thickness_m > 0 ? "two flat layers"
                           : contact_case.fem_mesh.empty()             ? "a flat layer"
                                                                       : "the meshed layer";
  return std::string(what) + (contact_case.fem_finite ? " at finite strain" : " in linear theory") +
         (contact_case.pressing == PressingFriction::none ? "" : ", pressed with friction");
}

LoadErrors errors_of(const Comparison& comparison) {
  LoadErrors errors;
  errors.load_N = comparison.load_N;
  errors.fem_finished = comparison.reference.has_value();
  errors.fem_failure = comparison.failure;
  errors.size = comparison.size();
  if (const auto open = comparison.geometry_error()) {
    errors.geometry_error = worst_of(*open);
  }
  if (comparison.reference) {
    errors.stated = comparison.reference->error;
    errors.fem_trusted = reference::is_trusted(*comparison.reference);
    errors.fem_geometry_error = reference::largest_geometry_error(*comparison.reference);
  }
  for (const ModelComparison& model : comparison.models) {
    ModelError error;
    error.model = model.answer.model->card().name;
    error.has_answer = model.answer.prediction.has_answer;
    error.sound = is_sound(model.answer.prediction, *comparison.contact_case);
    error.hot_path = model.answer.model->card().hot_path;
    error.applicable = is_applicable(model.answer);
    error.contact = error.max_torque = kNaN;
    if (model.errors) {
      error.set_contact(model.errors->a, model.errors->b, model.errors->area);
      error.max_torque = model.errors->max_torque;
    }
    errors.models.push_back(error);
  }
  return errors;
}

CaseComparison compare_case(const input::Case& contact_case, std::vector<Comparison> loads,
                            double tolerance) {
  std::vector<LoadErrors> errors;
  for (const Comparison& load : loads) errors.push_back(errors_of(load));
  return {&contact_case, std::move(loads),
          compose_verdict(errors, tolerance, reference_in_words(contact_case))};
}

}  // namespace softfinger::judgement
