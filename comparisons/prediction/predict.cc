#include "comparisons/prediction/predict.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/input/errors.h"
#include "softfinger/math/pi.h"

namespace softfinger::prediction {
namespace {

constexpr double kRadian = 180 / kPi;  // degrees

double measure_cost_ns(const PressureModel& model, const ContactProblem& problem,
                       double time_budget_ns) {
  using Clock = std::chrono::steady_clock;
  // Batches, because one call may be shorter than the clock's resolution; the sum keeps the calls
  // alive.
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
  // Three at least: in one of them the machine may have been busy with something else.
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

/// As LimitSurface::sample, for the ellipsoid: a Fibonacci spiral over the sphere of the scaled
/// space.
std::vector<LimitWrench> sample_ellipsoid(const FrictionEllipsoid& ellipsoid, int count) {
  const double golden_angle = kPi * (3 - std::sqrt(5.0));
  std::vector<LimitWrench> points;
  for (int i = 0; i < count; ++i) {
    const double height = 1 - (2 * i + 1.0) / count;
    const double force_N = ellipsoid.max_force_N * std::sqrt(1 - height * height);
    points.push_back({force_N * std::cos(golden_angle * i), force_N * std::sin(golden_angle * i),
                      ellipsoid.max_torque_Nm() * height});
  }
  return points;
}

void add_limit_surface(const ModelAnswer& answer, TorqueRule rule, int count,
                       nlohmann::json& result) {
  const Prediction& prediction = answer.prediction;
  nlohmann::json& points = result["limit_surface"] = nlohmann::json::array();
  result["limit_surface_model"] = result["pressure_exponent"] = nullptr;
  if (!prediction.has_answer) return;
  std::vector<LimitWrench> wrenches;
  const FrictionEllipsoid ellipsoid = answer.friction_ellipsoid(rule);
  if (rule == TorqueRule::paper) {
    result["limit_surface_model"] = "ellipsoid";
    wrenches = sample_ellipsoid(ellipsoid, count);
  } else {
    const double exponent = equivalent_exponent(prediction);
    result["limit_surface_model"] = "exact";
    result["pressure_exponent"] = exponent;
    wrenches =
        LimitSurface(prediction.a_m, prediction.b_m, exponent, ellipsoid.max_force_N).sample(count);
  }
  for (const LimitWrench& point : wrenches)
    points.push_back(
        {{"fx_N", point.force_x_N}, {"fy_N", point.force_y_N}, {"torque_Nm", point.torque_Nm}});
}

nlohmann::json vector_json(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

}  // namespace

FrictionEllipsoid ModelAnswer::friction_ellipsoid(TorqueRule rule) const {
  return {problem.load.friction_coefficient * problem.load.normal_force_N, eccentricity_m(rule)};
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
                       "unknown model \"" + name + "\", did you mean \"" +
                           text::nearest_name(name, known) + "\"?",
                       "", text::joined(known));
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
                      double time_budget_ns) {
  using Clock = std::chrono::steady_clock;
  ModelAnswer answer;
  answer.model = &model;
  answer.problem = problem;
  const auto start = Clock::now();
  answer.prediction = model.predict(problem);
  answer.cost_ns = model.card().hot_path
                       ? measure_cost_ns(model, problem, time_budget_ns)
                       : std::chrono::duration<double, std::nano>(Clock::now() - start).count();
  return answer;
}

ModelAnswer ask_model(const PressureModel& model, const input::Case& contact_case,
                      const RelativeRadii& radii, double load_N, double time_budget_ns) {
  ModelAnswer answer = ask_model(model, contact_case.problem(radii, load_N), time_budget_ns);
  check_homogeneity(contact_case, answer.prediction.validity);
  return answer;
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
  // Small contacts feel the outermost sublayer alone, large ones all of them in series: nowhere is
  // the mean of two that differ by more than a tenth good to a tenth.
  validity.add({"homogeneous", contrast, 1.1, true,
                "the models know one homogeneous layer, here one with 1/E and nu averaged over the "
                "sublayers' thickness: ask finite elements"});
}

void propagate_radii_uncertainty(const RelativeCurvature& relative, ModelAnswer& answer) {
  if (!answer.prediction.has_answer || !answer.model->card().hot_path) return;
  const auto deviation = [&](double Prediction::*quantity) {
    return propagated_std(relative, [&](const RelativeRadii& radii) {
      ContactProblem problem = answer.problem;
      problem.radii = radii;
      const Prediction moved = answer.model->predict(problem);
      return moved.has_answer ? moved.*quantity : std::numeric_limits<double>::quiet_NaN();
    });
  };
  answer.deviations = {deviation(&Prediction::a_m), deviation(&Prediction::b_m),
                       deviation(&Prediction::torque_arm_exact_m),
                       deviation(&Prediction::torque_arm_paper_m)};
}

double equivalent_exponent(const Prediction& prediction) {
  if (!prediction.has_answer) return NAN;
  // A circle of radius one has the arm (n+1) B(3/2, n+1), which falls with n; an ellipse has it
  // times a (2/pi) E(m), whatever n.
  const double ellipse_m = torque_arm_exact_m(prediction.a_m, prediction.b_m, 0) / (2.0 / 3);
  const double arm = prediction.torque_arm_exact_m / ellipse_m;
  for (const double named : {0.5, 1.0, 2.0})
    if (std::abs(arm / torque_arm_exact_m(1, 1, named) - 1) < 1e-14) return named;
  double low = -0.99, high = 1000;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (torque_arm_exact_m(1, 1, middle) > arm ? low : high) = middle;
  }
  return (low + high) / 2;
}

nlohmann::json to_json(const Validity& validity) {
  nlohmann::json checks = nlohmann::json::array();
  for (const ValidityCheck& check : validity)
    checks.push_back({{"check", check.check},
                      {"value", text::finite_or_null(check.value)},
                      {"limit", text::finite_or_null(check.limit)},
                      {"holds", check.holds()},
                      {"message", check.message}});
  return checks;
}

nlohmann::json to_json(const ModelAnswer& answer, TorqueRule rule, int limit_surface_points) {
  const Prediction& prediction = answer.prediction;
  const FrictionEllipsoid ellipsoid = answer.friction_ellipsoid(rule);
  const auto number = [&](double value) {
    return prediction.has_answer ? text::finite_or_null(value) : nlohmann::json();
  };
  nlohmann::json result = {
      {"load_N", answer.problem.load.normal_force_N},
      {"model", answer.model->card().name},
      {"a_m", number(prediction.a_m)},
      {"b_m", number(prediction.b_m)},
      {"axis_rad", answer.problem.radii.axis_rad},
      {"indentation_m", number(prediction.indentation_m)},
      {"peak_pressure_Pa", number(prediction.peak_pressure_Pa)},
      {"area_m2", number(prediction.area_m2())},
      {"max_torque_Nm", number(ellipsoid.max_torque_Nm())},
      {"eccentricity_m", number(ellipsoid.eccentricity_m)},
      {"torque_rule", rule == TorqueRule::exact ? "exact" : "paper"},
      {"gap", answer.sampled ? "sampled" : "quadric"},
      {"valid", prediction.valid()},
      {"validity", to_json(prediction.validity)},
      {"error_estimate", answer.error_estimate},
      {"error_estimate_remark",
       answer.no_estimate.empty() ? nlohmann::json() : nlohmann::json(answer.no_estimate)},
      {"cost_ns", answer.cost_ns}};
  if (answer.deviations) {
    const auto& deviations = *answer.deviations;
    const double arm_m =
        rule == TorqueRule::exact ? deviations.arm_exact_m : deviations.arm_paper_m;
    result["a_std_m"] = text::finite_or_null(deviations.a_m);
    result["b_std_m"] = text::finite_or_null(deviations.b_m);
    result["max_torque_std_Nm"] = text::finite_or_null(ellipsoid.max_force_N * arm_m);
  }
  if (answer.sampled) {
    const SampledGapResult& sampled = *answer.sampled;
    result["sampled_gap"] = {{"centre_m", {sampled.centre_m.x(), sampled.centre_m.y()}},
                             {"region_area_m2", sampled.region_area_m2},
                             {"edge_deviation", sampled.edge_deviation},
                             {"spacing_m", sampled.spacing_m}};
    result["error_estimate"] = {
        {"a", text::finite_or_null(sampled.changes_by_rounding.a)},
        {"b", text::finite_or_null(sampled.changes_by_rounding.b)},
        {"indentation", text::finite_or_null(sampled.changes_by_rounding.indentation)},
        {"max_torque", text::finite_or_null(sampled.changes_by_rounding.torque)},
        {"peak_pressure", text::finite_or_null(sampled.changes_by_rounding.peak)}};
  }
  if (limit_surface_points > 0) add_limit_surface(answer, rule, limit_surface_points, result);
  return result;
}

nlohmann::json to_json(const std::optional<PowerLawFit>& fit) {
  if (!fit) return nullptr;
  return {{"radius_coefficient_m", fit->law.radius_coefficient},
          {"radius_exponent", fit->law.radius_exponent},
          {"pressure_exponent", fit->law.pressure_exponent},
          {"residual_rms", fit->residual_rms},
          {"radius_relative_std", fit->log_radius_std},
          {"radius_exponent_std", fit->exponent_std},
          {"load_range_N", {fit->least_load_N, fit->largest_load_N}}};
}

std::vector<std::string> power_law_remarks(const input::Case& contact_case) {
  const auto& fit = contact_case.power_law_fit;
  if (!fit) return {};
  std::vector<std::string> remarks = {fmt::format(
      "power law fitted to the data: a = {:.4g} mm (P/N)^{:.4g} (exponent ± {:.2g}), radii scatter "
      "by {:.2g} %",
      fit->law.radius_coefficient * 1e3, fit->law.radius_exponent, fit->exponent_std,
      100 * fit->residual_rms)};
  for (const double load_N : contact_case.loads_N)
    if (load_N < fit->least_load_N || load_N > fit->largest_load_N)
      remarks.push_back(
          fmt::format("{:g} N lies outside the data, {:g} to {:g} N: there power_law extrapolates",
                      load_N, fit->least_load_N, fit->largest_load_N));
  return remarks;
}

nlohmann::json to_json(const QuadricFit& fit) {
  const auto& principal = fit.principal;
  const Eigen::Vector3d y_axis = fit.normal.cross(fit.x_axis);
  const double c = std::cos(principal.axis_rad), s = std::sin(principal.axis_rad);
  return {
      {"A_per_m", fit.quadric.A_per_m},
      {"B_per_m", fit.quadric.B_per_m},
      {"C_per_m", fit.quadric.C_per_m},
      {"radii_m",
       {text::finite_or_null(principal.radii_m[0]), text::finite_or_null(principal.radii_m[1])}},
      {"axis_rad", principal.axis_rad},
      {"directions",
       {vector_json(c * fit.x_axis + s * y_axis), vector_json(c * y_axis - s * fit.x_axis)}},
      {"origin_m", vector_json(fit.origin_m)},
      {"normal", vector_json(fit.normal)},
      {"x_axis", vector_json(fit.x_axis)},
      {"residual_rms_m", text::finite_or_null(fit.residual_rms_m)},
      {"points", fit.points},
      {"region_radius_m", fit.region_radius_m},
      {"area_m2", fit.area_m2},
      {"radii_std_m",
       {text::finite_or_null(fit.radii_std_m[0]), text::finite_or_null(fit.radii_std_m[1])}}};
}

nlohmann::json patch_to_json(const LocalGeometry& geometry) {
  if (!geometry.patch) return nullptr;
  const ContactPatch& patch = *geometry.patch;
  const auto fit = [](const std::optional<QuadricFit>& body) {
    return body ? to_json(*body) : nlohmann::json();
  };
  return {{"region_area_m2", patch.region_area_m2},
          {"predicted_area_m2", patch.predicted_area_m2},
          {"agrees", patch.agrees},
          {"remark", patch.remark},
          {"patch_model", geometry.patch_model},
          {"finger", fit(patch.finger_fit)},
          {"object", fit(patch.object_fit)}};
}

nlohmann::json layer_json(const ElasticLayer& layer) {
  return {{"thickness_m", layer.thickness_m},
          {"youngs_modulus_Pa", layer.youngs_modulus_Pa},
          {"poisson_ratio", layer.poisson_ratio}};
}

std::string millimetres(double length_m) {
  return std::isfinite(length_m) ? fmt::format("{:.5g} mm", length_m * 1e3) : "flat";
}

std::string describe(const input::Case& contact_case) {
  const auto layer_text = [](const ElasticLayer& layer) {
    return fmt::format("{:.6g} mm, E {:.6g} kPa, nu {:.6g}", layer.thickness_m * 1e3,
                       layer.youngs_modulus_Pa * 1e-3, layer.poisson_ratio);
  };
  std::string text =
      fmt::format("{}: {} {}", contact_case.id,
                  contact_case.layer_on_object ? "rigid finger, object's layer" : "layer",
                  layer_text(contact_case.layer));
  for (std::size_t i = 0; i < contact_case.sublayers.size(); ++i) {
    const input::Sublayer& sublayer = contact_case.sublayers[i];
    text += (i == 0 ? " on average of " : " over ") +
            (sublayer.name.empty() ? "" : sublayer.name + " ") + layer_text(sublayer.layer);
  }
  if (contact_case.object_layer.thickness_m > 0)
    text += "; object's layer " + layer_text(contact_case.object_layer) + "; ";
  else
    text += ", ";
  return text + fmt::format("friction {:.6g}", contact_case.friction_coefficient);
}

std::string describe(const LocalGeometry& geometry) {
  std::string text = fmt::format(
      "R' {}, R'' {}, long axis at {:.4g}°", millimetres(geometry.radii.major_m),
      millimetres(geometry.radii.minor_m), geometry.radii.axis_rad * kRadian + 0.0);  // -0 is 0
  if (geometry.patch) {
    text += fmt::format("; fitted over {:.3g} mm² for a contact of {:.3g} mm² ({})",
                        geometry.patch->region_area_m2 * 1e6,
                        geometry.patch->predicted_area_m2 * 1e6, geometry.patch_model);
    if (!geometry.patch->remark.empty()) text += "; " + geometry.patch->remark;
  }
  return text;
}

std::string table(const std::vector<ModelAnswer>& answers, TorqueRule rule) {
  std::string text = fmt::format(
      "  {:<19} {:>9} {:>9} {:>9} {:>10} {:>10} {:>12} {:>9} {:>5} {:>9}\n", "model", "a mm",
      "b mm", "d mm", "peak kPa", "area mm²", "torque mN·m", "e_n mm", "valid", "cost ns");
  std::string remarks;
  for (const ModelAnswer& answer : answers) {
    const Prediction& p = answer.prediction;
    const std::string name(answer.model->card().name);
    if (p.has_answer) {
      text += fmt::format(
          "  {:<19} {:>9.4g} {:>9.4g} {:>9.4g} {:>10.4g} {:>10.4g} {:>12.4g} {:>9.4g} {:>5} "
          "{:>9.0f}\n",
          name, p.a_m * 1e3, p.b_m * 1e3, p.indentation_m * 1e3, p.peak_pressure_Pa * 1e-3,
          p.area_m2() * 1e6, answer.friction_ellipsoid(rule).max_torque_Nm() * 1e3,
          answer.eccentricity_m(rule) * 1e3, p.valid() ? "yes" : "no", answer.cost_ns);
    } else {
      text += fmt::format("  {:<19} {:>9}\n", name, "no answer");
    }
    for (const ValidityCheck& check : p.validity)
      if (!check.holds())
        remarks += fmt::format("  {}: {} ({} = {:.3g}, holds {} {:.3g})\n", name, check.message,
                               check.check, check.value, check.holds_below ? "below" : "above",
                               check.limit);
    if (answer.deviations && std::isfinite(answer.deviations->a_m + answer.deviations->b_m))
      remarks += fmt::format(
          "  {}: the fitted radii leave a ± {:.2g} mm, b ± {:.2g} mm, torque ± {:.2g} mN·m\n", name,
          answer.deviations->a_m * 1e3, answer.deviations->b_m * 1e3,
          answer.friction_ellipsoid(rule).max_force_N * 1e3 *
              (rule == TorqueRule::exact ? answer.deviations->arm_exact_m
                                         : answer.deviations->arm_paper_m));
  }
  for (const ModelAnswer& answer : answers)
    if (answer.sampled) {
      const SampledGapResult& sampled = *answer.sampled;
      remarks += fmt::format(
          "  {}: gap sampled from the meshes (all other models: the fitted quadric); contact of "
          "{:.4g} mm², long axis at {:.4g}°, centre at ({:.2g}, {:.2g}) mm, edge within {:.2g} % "
          "of "
          "the ellipse; rounding the facets changes a, b, d, torque by {:.2g}, {:.2g}, {:.2g}, "
          "{:.2g} %, the peak by {:.2g} %\n",
          answer.model->card().name, sampled.region_area_m2 * 1e6,
          answer.problem.radii.axis_rad * kRadian, sampled.centre_m.x() * 1e3,
          sampled.centre_m.y() * 1e3, sampled.edge_deviation * 100,
          sampled.changes_by_rounding.a * 100, sampled.changes_by_rounding.b * 100,
          sampled.changes_by_rounding.indentation * 100, sampled.changes_by_rounding.torque * 100,
          sampled.changes_by_rounding.peak * 100);
    }
  return text + remarks;
}

}  // namespace softfinger::prediction
