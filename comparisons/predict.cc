#include "comparisons/predict.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cmath>

#include "comparisons/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

constexpr double kRadian = 180 / 3.14159265358979323846;  // degrees

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
  for (int batch = 0; batch < kBatches && (times.empty() || spent_ns < time_budget_ns); ++batch) {
    times.push_back(time_batch(calls));
    spent_ns += times.back() * calls;
  }
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  volatile double sink = sum;
  (void)sink;
  return times[times.size() / 2];
}

nlohmann::json vector_json(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

std::string millimetres(double radius_m) {
  return std::isfinite(radius_m) ? fmt::format("{:.4g} mm", radius_m * 1e3) : "flat";
}

}  // namespace

FrictionEllipsoid ModelAnswer::friction_ellipsoid(TorqueRule rule) const {
  return {problem.load.friction_coefficient * problem.load.normal_force_N, eccentricity_m(rule)};
}

std::vector<const PressureModel*> models_by_name(const std::string& names) {
  if (names == "all") return all_pressure_models();
  std::vector<std::string> known;
  for (const PressureModel* model : all_pressure_models()) known.emplace_back(model->card().name);
  std::vector<const PressureModel*> models;
  for (std::size_t start = 0; start <= names.size();) {
    const std::size_t end = std::min(names.find(',', start), names.size());
    const std::string name = names.substr(start, end - start);
    const PressureModel* model = find_pressure_model(name);
    if (!model)
      throw InputError(
          "command line",
          "unknown model \"" + name + "\", did you mean \"" + nearest_name(name, known) + "\"?", "",
          joined(known) + " or all");
    if (std::find(models.begin(), models.end(), model) == models.end()) models.push_back(model);
    start = end + 1;
  }
  return models;
}

ModelAnswer ask_model(const PressureModel& model, const ContactProblem& problem,
                      double time_budget_ns) {
  ModelAnswer answer;
  answer.model = &model;
  answer.problem = problem;
  answer.prediction = model.predict(problem);
  answer.cost_ns = measure_cost_ns(model, problem, time_budget_ns);
  return answer;
}

nlohmann::json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

nlohmann::json to_json(const Validity& validity) {
  nlohmann::json checks = nlohmann::json::array();
  for (const ValidityCheck& check : validity)
    checks.push_back({{"check", check.check},
                      {"value", finite_or_null(check.value)},
                      {"limit", finite_or_null(check.limit)},
                      {"holds", check.holds()},
                      {"message", check.message}});
  return checks;
}

nlohmann::json to_json(const ModelAnswer& answer, TorqueRule rule, int limit_surface_points) {
  const Prediction& prediction = answer.prediction;
  const FrictionEllipsoid ellipsoid = answer.friction_ellipsoid(rule);
  const auto number = [&](double value) {
    return prediction.has_answer ? finite_or_null(value) : nlohmann::json();
  };
  nlohmann::json result = {{"load_N", answer.problem.load.normal_force_N},
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
                           {"valid", prediction.valid()},
                           {"validity", to_json(prediction.validity)},
                           {"error_estimate", nullptr},
                           {"cost_ns", answer.cost_ns}};
  if (limit_surface_points > 0) {
    nlohmann::json& points = result["limit_surface"] = nlohmann::json::array();
    if (prediction.has_answer)
      for (const LimitWrench& point : sample_section(ellipsoid, 0, limit_surface_points))
        points.push_back(
            {{"fx_N", point.force_x_N}, {"fy_N", point.force_y_N}, {"torque_Nm", point.torque_Nm}});
  }
  return result;
}

nlohmann::json to_json(const QuadricFit& fit) {
  const auto& principal = fit.principal;
  const Eigen::Vector3d y_axis = fit.normal.cross(fit.x_axis);
  const double c = std::cos(principal.axis_rad), s = std::sin(principal.axis_rad);
  return {
      {"A_per_m", fit.quadric.A_per_m},
      {"B_per_m", fit.quadric.B_per_m},
      {"C_per_m", fit.quadric.C_per_m},
      {"radii_m", {finite_or_null(principal.radii_m[0]), finite_or_null(principal.radii_m[1])}},
      {"axis_rad", principal.axis_rad},
      {"directions",
       {vector_json(c * fit.x_axis + s * y_axis), vector_json(c * y_axis - s * fit.x_axis)}},
      {"origin_m", vector_json(fit.origin_m)},
      {"normal", vector_json(fit.normal)},
      {"x_axis", vector_json(fit.x_axis)},
      {"residual_rms_m", finite_or_null(fit.residual_rms_m)},
      {"points", fit.points},
      {"region_radius_m", fit.region_radius_m},
      {"area_m2", fit.area_m2},
      {"radii_std_m", {finite_or_null(fit.radii_std_m[0]), finite_or_null(fit.radii_std_m[1])}}};
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

std::string describe(const Case& contact_case) {
  const ElasticLayer& layer = contact_case.layer;
  return fmt::format("{}: layer {:.6g} mm, E {:.6g} kPa, nu {:.6g}, friction {:.6g}",
                     contact_case.id, layer.thickness_m * 1e3, layer.youngs_modulus_Pa * 1e-3,
                     layer.poisson_ratio, contact_case.friction_coefficient);
}

std::string describe(const LocalGeometry& geometry) {
  std::string text =
      fmt::format("R' {}, R'' {}, long axis at {:.4g}°", millimetres(geometry.radii.major_m),
                  millimetres(geometry.radii.minor_m), geometry.radii.axis_rad * kRadian);
  if (geometry.patch) {
    text += fmt::format("; fitted over {:.3g} mm² for a contact of {:.3g} mm² ({})",
                        geometry.patch->region_area_m2 * 1e6,
                        geometry.patch->predicted_area_m2 * 1e6, geometry.patch_model);
    if (!geometry.patch->remark.empty()) text += "; " + geometry.patch->remark;
  }
  return text;
}

std::string table(const std::vector<ModelAnswer>& answers, TorqueRule rule) {
  std::string text = fmt::format("  {:<18}{:>9}{:>9}{:>9}{:>11}{:>11}{:>13}{:>9}{:>7}{:>10}\n",
                                 "model", "a mm", "b mm", "d mm", "peak kPa", "area mm²",
                                 "torque mN·m", "e_n mm", "valid", "cost ns");
  std::string remarks;
  for (const ModelAnswer& answer : answers) {
    const Prediction& p = answer.prediction;
    const std::string name(answer.model->card().name);
    if (p.has_answer) {
      text += fmt::format(
          "  {:<18}{:>9.4g}{:>9.4g}{:>9.4g}{:>11.4g}{:>11.4g}{:>13.4g}{:>9.4g}{:>7}{:>10.0f}\n",
          name, p.a_m * 1e3, p.b_m * 1e3, p.indentation_m * 1e3, p.peak_pressure_Pa * 1e-3,
          p.area_m2() * 1e6, answer.friction_ellipsoid(rule).max_torque_Nm() * 1e3,
          answer.eccentricity_m(rule) * 1e3, p.valid() ? "yes" : "no", answer.cost_ns);
    } else {
      text += fmt::format("  {:<18}{:>9}\n", name, "no answer");
    }
    for (const ValidityCheck& check : p.validity)
      if (!check.holds())
        remarks += fmt::format("  {}: {} ({} = {:.3g}, holds {} {:.3g})\n", name, check.message,
                               check.check, check.value, check.holds_below ? "below" : "above",
                               check.limit);
  }
  return text + remarks;
}

}  // namespace softfinger
