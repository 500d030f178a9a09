#include "comparisons/prediction/answer_json.h"

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

#include "comparisons/text/json_text.h"
#include "softfinger/friction/ellipsoid_deviation.h"
#include "softfinger/friction/shear_surface.h"
#include "softfinger/friction/tilt_limit.h"
#include "softfinger/input/constants.h"
#include "softfinger/pressure/gradient.h"
#include "softfinger/pressure/rubbed_prediction.h"

namespace softfinger::prediction {
namespace {

/// Points of the ellipsoid in evenly spread directions, like LimitSurface::sample. In the space of
/// f/(mu P) and tau/(mu P e_n) the ellipsoid is a sphere; they lie on a Fibonacci spiral over it.
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
  result["ellipsoid_deviation"] = nullptr;
  if (!prediction.has_answer) return;
  std::vector<LimitWrench> wrenches;
  const FrictionEllipsoid ellipsoid = answer.friction_ellipsoid(rule);
  if (rule == TorqueRule::paper) {
    result["limit_surface_model"] = "ellipsoid";
    wrenches = sample_ellipsoid(ellipsoid, count);
  } else {
    const PressedEllipse contact = answer.pressed_ellipse(rule);
    const ShearSurface surface(answer.shear_law, contact);
    result["limit_surface_model"] = "exact";
    result["pressure_exponent"] = contact.exponent;
    const EllipsoidDeviation deviation = worst_ellipsoid_deviation(surface, ellipsoid);
    result["ellipsoid_deviation"] = {deviation.lowest, deviation.highest};
    wrenches = surface.sample(count);
  }
  for (const LimitWrench& point : wrenches)
    points.push_back(
        {{"fx_N", point.force_x_N}, {"fy_N", point.force_y_N}, {"torque_Nm", point.torque_Nm}});
}

/// Limit of tilt: the pressure moves to one side of the contact without exceeding the model's peak.
std::optional<TiltLimit> tilt_limit_of(const ModelAnswer& answer) {
  const Prediction& prediction = answer.prediction;
  const double load_N = answer.problem.load.normal_force_N;
  const double mean_Pa = load_N / prediction.area_m2();
  const double peak_ratio = prediction.peak_pressure_Pa / mean_Pa;
  if (!prediction.has_answer || !(mean_Pa > 0) || !std::isfinite(peak_ratio)) return std::nullopt;
  return tilt_limit(prediction.a_m, prediction.b_m, load_N, peak_ratio);
}

nlohmann::json vector_json(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

}  // namespace

nlohmann::json to_json(const std::optional<QuantityErrors>& bound) {
  if (!bound) return nullptr;
  nlohmann::json json;
  for (std::size_t q = 0; q < kQuantities; ++q)
    json[kQuantityNames[q]] = text::finite_or_null((*bound)[q]);
  return json;
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

std::optional<QuantityErrors> cause_of(const ModelAnswer& answer, ErrorCause cause) {
  return answer.assessment->causes[std::size_t(cause)];
}

nlohmann::json to_json(const ModelAnswer& answer, TorqueRule rule, int limit_surface_points) {
  const Prediction& prediction = answer.pressed();
  const FrictionEllipsoid ellipsoid = answer.friction_ellipsoid(rule);
  const auto number = [&](double value) {
    return prediction.has_answer ? text::finite_or_null(value) : nlohmann::json();
  };
  nlohmann::json result = {{"load_N", answer.problem.load.normal_force_N},
                           {"model", answer.model->card().name},
                           {"contact", "ellipse"},
                           {"a_m", number(prediction.a_m)},
                           {"b_m", number(prediction.b_m)},
                           {"axis_rad", answer.problem.radii.axis_rad},
                           {"indentation_m", number(prediction.indentation_m)},
                           {"peak_pressure_Pa", number(prediction.peak_pressure_Pa)},
                           {"area_m2", number(prediction.area_m2())},
                           {"area_projected_m2", number(prediction.area_m2())},
                           {"shear_law", answer.shear_law.name()},
                           {"max_force_N", number(ellipsoid.max_force_N)},
                           {"max_torque_Nm", number(ellipsoid.max_torque_Nm())},
                           {"eccentricity_m", number(ellipsoid.eccentricity_m)},
                           {"pressing", answer.rubbed ? name_of(answer.pressing) : "frictionless"},
                           {"pressure_arm_m", number(prediction.torque_arm_exact_m)},
                           {"torque_rule", rule == TorqueRule::exact ? "exact" : "paper"},
                           {"gap", answer.sampled ? "sampled" : "quadric"},
                           {"valid", answer.valid()},
                           {"validity", to_json(answer.prediction.validity)},
                           {"cost_ns", answer.cost_ns}};
  auto derived = predict_with_gradient(*answer.model, answer.problem);
  if (answer.rubbed)
    derived = rubbed(
        *answer.model, derived, answer.problem,
        pressing_friction_coefficient(answer.pressing, answer.problem.load.friction_coefficient));
  const PredictionGradient& gradient = derived.gradient;
  const auto known = [&](double value) {
    return gradient.known ? text::finite_or_null(value) : nlohmann::json();
  };
  result["normal_stiffness_N_per_m"] = known(gradient.normal_stiffness_N_per_m());
  result["torsional_stiffness_Nm_per_rad"] = known(gradient.stuck.torsional_Nm_per_rad);
  result["tangential_stiffness_N_per_m"] = {known(gradient.stuck.tangential_x_N_per_m),
                                            known(gradient.stuck.tangential_y_N_per_m)};
  const std::optional<TiltLimit> tilt = tilt_limit_of(answer);
  result["tilt_limit_Nm"] = nullptr;
  if (tilt) result["tilt_limit_Nm"] = {tilt->about_x_Nm, tilt->about_y_Nm};
  // About the long axis bodies roll along the short one.
  const double load_N = answer.problem.load.normal_force_N;
  result["rolling_stiffness_Nm_per_rad"] = {
      text::finite_or_null(load_N * answer.problem.radii.minor_m),
      text::finite_or_null(load_N * answer.problem.radii.major_m)};
  if (answer.assessment) {
    result["usable"] = answer.assessment->usable;
    const bool is_known = answer.assessment->bound.has_value();
    result["error_bound"] =
        is_known ? to_json(std::optional(answer.assessment->totals())) : nlohmann::json();
    result["error_evidence"] = answer.assessment->evidence;
    result["error_causes"] = nullptr;
    if (answer.assessment->bound)
      result["error_causes"] = {{"model", to_json(cause_of(answer, ErrorCause::model))},
                                {"strain", to_json(cause_of(answer, ErrorCause::strain))},
                                {"slope", to_json(cause_of(answer, ErrorCause::slope))},
                                {"curvature", to_json(cause_of(answer, ErrorCause::curvature))}};
    result["geometry_error"] = to_json(answer.assessment->geometry);
  }
  if (answer.deviations) {
    const auto& deviations = *answer.deviations;
    const double torque_Nm =
        rule == TorqueRule::exact ? deviations.torque_exact_Nm : deviations.torque_paper_Nm;
    result["a_std_m"] = text::finite_or_null(deviations.a_m);
    result["b_std_m"] = text::finite_or_null(deviations.b_m);
    result["max_torque_std_Nm"] = text::finite_or_null(torque_Nm);
  }
  if (answer.sampled) {
    const SampledGapResult& sampled = *answer.sampled;
    result["sampled_gap"] = {{"centre_m", {sampled.centre_m.x(), sampled.centre_m.y()}},
                             {"region_area_m2", sampled.region_area_m2},
                             {"edge_deviation", sampled.edge_deviation},
                             {"spacing_m", sampled.spacing_m}};
    result["sampled_gap"]["changes_by_rounding"] = {
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
          {"facet_doubt_m", patch.facet_doubt_m},
          {"remark", patch.remark},
          {"patch_model", geometry.patch_model},
          {"finger", fit(patch.finger_fit)},
          {"object", fit(patch.object_fit)}};
}

}  // namespace softfinger::prediction
