#include "comparisons/prediction/ask_model.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"
#include "softfinger/pressure/equivalent_exponent.h"
#include "softfinger/pressure/rubbed_prediction.h"

namespace softfinger::prediction {
namespace {

double measure_cost_ns(const PressureModel& model, const ContactProblem& problem,
                       double time_budget_ns) {
  using Clock = std::chrono::steady_clock;
  // Batches, because one call may be shorter than the clock's resolution. The sum keeps the
  // compiler from removing the calls.
  double sum = 0;
  const auto time_batch = [&](int calls) {
    const auto start = Clock::now();
    for (int i = 0; i < calls; ++i) sum += model.predict(problem).a_m;
    return std::chrono::duration<double, std::nano>(Clock::now() - start).count() / calls;
  };
  // The first call may have to load code and data.
  double rough_ns = time_batch(1);
  for (int i = 0; i < 4; ++i) rough_ns = std::max(std::min(rough_ns, time_batch(1)), 1.0);
  constexpr int kBatches = 7;
  const int calls = static_cast<int>(std::clamp(time_budget_ns / kBatches / rough_ns, 1.0, 1000.0));
  std::vector<double> times;
  double spent_ns = rough_ns;
  // At least three, because the machine may have been busy during one of them.
  for (int batch = 0; batch < kBatches && (times.size() < 3 || spent_ns < time_budget_ns);
       ++batch) {
    times.push_back(time_batch(calls));
    spent_ns += times.back() * calls;
  }
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  volatile double sink = sum;
  (void)sink;
  return times[times.size() / 2];
}

}  // namespace

PressedEllipse ModelAnswer::pressed_ellipse(TorqueRule rule) const {
  const double mean_m = std::sqrt(prediction.a_m) * std::sqrt(prediction.b_m);
  const bool paper = rule == TorqueRule::paper;
  return {paper ? mean_m : prediction.a_m, paper ? mean_m : prediction.b_m,
          equivalent_exponent(prediction), problem.load.normal_force_N};
}

FrictionEllipsoid ModelAnswer::friction_ellipsoid(TorqueRule rule) const {
  if (shear_law.kind == ShearLaw::Kind::coulomb || !prediction.has_answer)
    return {shear_law.friction_coefficient * problem.load.normal_force_N, eccentricity_m(rule)};
  return softfinger::friction_ellipsoid(shear_law, pressed_ellipse(rule));
}

std::vector<const PressureModel*> models_by_name(const std::string& names) {
  std::vector<const PressureModel*> models;
  std::vector<std::string> known;
  for (const PressureModel* model : all_pressure_models()) {
    known.emplace_back(model->card().name);
    if (names == "everything" || (names == "all" && model->card().hot_path))
      models.push_back(model);
  }
  if (!models.empty()) return models;
  known.insert(known.end(), {"all", "everything"});
  for (std::size_t start = 0; start <= names.size();) {
    const std::size_t end = std::min(names.find(',', start), names.size());
    const std::string name = names.substr(start, end - start);
    const PressureModel* model = find_pressure_model(name);
    if (!model)
      throw InputError("command line",
                       "unknown model \"" + name + "\"" + text::did_you_mean(name, known), "",
                       text::joined(known));
    if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
    start = end + 1;
  }
  return models;
}

std::vector<std::string> slow_models() {
  std::vector<std::string> names;
  for (const PressureModel* model : all_pressure_models())
    if (!model->card().hot_path) names.emplace_back(model->card().name);
  return names;
}

ModelAnswer ask_model(const PressureModel& model, const ContactProblem& problem,
                      std::optional<double> time_budget_ns) {
  using Clock = std::chrono::steady_clock;
  ModelAnswer answer;
  answer.model = &model;
  answer.problem = problem;
  answer.shear_law = ShearLaw::coulomb(problem.load.friction_coefficient);
  const auto start = Clock::now();
  answer.prediction = model.predict(problem);
  if (!model.card().hot_path)
    answer.cost_ns = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
  else if (time_budget_ns)
    answer.cost_ns = measure_cost_ns(model, problem, *time_budget_ns);
  return answer;
}

namespace {

/// Sets the contact as it is pressed with friction, or a check that fails where the model leaves
/// out what counts.
void press_with_friction(const input::Case& contact_case, ModelAnswer& answer) {
  answer.pressing = contact_case.pressing;
  if (answer.pressing == PressingFriction::none || !answer.prediction.has_answer) return;
  const double mu = contact_case.pressing_friction_coefficient();
  const bool is_one_layer = answer.problem.stack.count == 0 && !answer.problem.has_object_layer();
  if (knows_pressing_friction(*answer.model) && is_one_layer)
    answer.rubbed = softfinger::rubbed(*answer.model, answer.prediction, answer.problem, mu);
  else
    answer.prediction.validity.add(
        check_frictionless_pressing(*answer.model, answer.prediction, answer.problem, mu));
}

}  // namespace

ModelAnswer ask_model(const PressureModel& model, const input::Case& contact_case,
                      const LocalGeometry& geometry, double load_N,
                      std::optional<double> time_budget_ns) {
  ModelAnswer answer =
      ask_model(model, contact_problem(contact_case, geometry, load_N), time_budget_ns);
  answer.shear_law = contact_case.shear_law;
  press_with_friction(contact_case, answer);
  if (!model.knows_stacks() || answer.problem.stack.count == 0)
    check_homogeneity(contact_case, answer.prediction.validity);
  if (model.card().finite_strain) check_energy(contact_case, answer.prediction.validity);
  return answer;
}

void check_energy(const input::Case& contact_case, Validity& validity) {
  if (!contact_case.fem_finite) return;
  const bool known = contact_case.fem_finite->material == "neo_hookean" &&
                     contact_case.fem_finite->volumetric == "quadratic";
  if (!known)
    validity.add({"fitted_energy", 0, 1, false,
                  "the correction was fitted to neo-Hookean layers of quadratic volume energy, "
                  "which this one is not: ask finite elements"});
}

void check_homogeneity(const input::Case& contact_case, Validity& validity) {
  if (contact_case.sublayers.empty()) return;
  double contrast = 1;
  for (const input::Sublayer& one : contact_case.sublayers)
    for (const input::Sublayer& other : contact_case.sublayers) {
      const auto bulk_modulus_Pa = [](const ElasticLayer& layer) {
        return layer.youngs_modulus_Pa / (3 * (1 - 2 * std::min(layer.poisson_ratio, 0.4999)));
      };
      contrast = std::max({contrast, one.layer.youngs_modulus_Pa / other.layer.youngs_modulus_Pa,
                           bulk_modulus_Pa(one.layer) / bulk_modulus_Pa(other.layer)});
    }
  // A contact much smaller than the outermost sublayer depends on that one only; a much larger one
  // on all of them in series. Therefore no mean of sublayers that differ by more than 10 % holds to
  // 10 % for all sizes of contacts.
  validity.add(
      {"homogeneous", contrast, 1.1, true,
       "this model knows one homogeneous layer, here one with 1/E and nu averaged over the "
       "sublayers' thickness: stack_layer, layer_fft and, for round contacts, layer_fredholm "
       "know up to eight"});
}

ContactProblem with_radii(ContactProblem problem, const RelativeRadii& radii) {
  const double x = problem.radii.major_m / radii.major_m;
  const double y = problem.radii.minor_m / radii.minor_m;
  problem.finger_curvature.xx_per_m *= x;
  problem.finger_curvature.yy_per_m *= y;
  problem.finger_curvature.xy_per_m *= std::sqrt(x * y);
  problem.radii = radii;
  return problem;
}

void propagate_radii_uncertainty(const RelativeCurvature& relative, ModelAnswer& answer) {
  if (!answer.prediction.has_answer || !answer.model->card().hot_path) return;
  const Eigen::VectorXd std = propagated_std(relative, [&](const RelativeRadii& radii) {
    ModelAnswer there = answer;
    there.prediction = answer.model->predict(with_radii(answer.problem, radii));
    const Prediction& moved = there.prediction;
    Eigen::VectorXd quantities(7);
    quantities << moved.a_m, moved.b_m, moved.indentation_m, moved.area_m2(),
        moved.peak_pressure_Pa, there.friction_ellipsoid(TorqueRule::exact).max_torque_Nm(),
        there.friction_ellipsoid(TorqueRule::paper).max_torque_Nm();
    if (!moved.has_answer) quantities.setConstant(std::numeric_limits<double>::quiet_NaN());
    return quantities;
  });
  answer.deviations = {std[0], std[1], std[2], std[3], std[4], std[5], std[6]};
}

}  // namespace softfinger::prediction
