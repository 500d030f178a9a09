#include "comparisons/commands/fem_answer.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "comparisons/prediction/answer_in_time.h"
#include "comparisons/prediction/answer_json.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/reference/theory_limits.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/percent.h"

namespace softfinger::commands {
namespace {

using prediction::Quantity;
using reference::ReferenceErrors;

/// "nan %" when the error is not known.
std::string in_percent(const std::optional<double>& error) {
  return text::percent(error.value_or(std::numeric_limits<double>::quiet_NaN()));
}

std::string twist_table(const reference::ReferenceResult& result) {
  const reference::TwistedContact& twist = *result.twist;
  std::string text = fmt::format(
      "  torsional stiffness, stuck {:>10.5g} N·m/rad  ± {}\n"
      "  torque at full slip        {:>10.5g} mN·m     ± {}, {:+.2g} % against int tau r "
      "dA\n"
      "  twist: angle (deg), torque (mN·m, ± {} of full slip), slipping share of the "
      "area\n",
      twist.stiffness_Nm_per_rad, in_percent(result.error.torsional_stiffness),
      1e3 * twist.full_slip_torque_Nm, in_percent(result.error.full_slip_torque),
      100 * (twist.full_slip_torque_Nm / result.max_torque_Nm - 1),
      in_percent(result.error.torsion_curve));
  for (const reference::TwistState& state : twist.states)
    text += fmt::format("    {:>10.4g} {:>10.5g} {:>6.0f} %\n", state.angle_rad * 180 / M_PI,
                        1e3 * state.torque_Nm, 100 * state.slip_fraction);
  return text;
}

std::string limit_surface_table(const reference::ReferenceResult& result) {
  std::string text = fmt::format(
      "  limit surface, ± {} of the largest force and torque: fx, fy (N), torque (mN·m)\n",
      in_percent(result.error.limit_surface));
  for (const reference::FrictionWrench& point : result.limit_surface)
    text += fmt::format("    {:>10.5g} {:>10.5g} {:>10.5g}\n", point.force_x_N, point.force_y_N,
                        1e3 * point.torque_Nm);
  return text;
}

std::string table_of(const reference::ReferenceResult& result) {
  const auto within = [&](std::optional<double> ReferenceErrors::*quantity) {
    const std::optional<double>& elements = result.error.*quantity;
    std::string text = elements ? "± " + text::percent(*elements) : "";
    if (const auto& facets = result.geometry_error; facets && (*facets).*quantity)
      text += fmt::format("{}± {} by the scan's facets", text.empty() ? "" : ", ",
                          text::percent(*((*facets).*quantity)));
    return text;
  };
  return fmt::format(
             "  a           {:>10.5g} mm    {}\n"
             "  b           {:>10.5g} mm    {}\n"
             "  indentation {:>10.5g} mm    {}\n"
             "  peak        {:>10.5g} kPa   {}\n"
             "  area        {:>10.5g} mm²   {} (seen along the load; {:.5g} mm² on the surface)\n"
             "  torque      {:>10.5g} mN·m  {}\n",
             result.a_m * 1e3, within(&ReferenceErrors::a), result.b_m * 1e3,
             within(&ReferenceErrors::b), result.indentation_m * 1e3,
             within(&ReferenceErrors::indentation), result.peak_pressure_Pa * 1e-3,
             within(&ReferenceErrors::peak_pressure), result.area_projected_m2 * 1e6,
             within(&ReferenceErrors::area), result.area_m2 * 1e6, result.max_torque_Nm * 1e3,
             within(&ReferenceErrors::max_torque)) +
         (result.projected_torque_Nm
              ? fmt::format("  projected   {:>10.5g} mN·m  int tau n_z r dA, without the slope\n",
                            *result.projected_torque_Nm * 1e3)
              : "") +
         fmt::format("  {} unknowns, {:.3g} s\n",
                     result.unknowns ? fmt::format("{:.0f}", *result.unknowns) : "?",
                     std::isfinite(result.wall_s) ? result.wall_s : 0);
}

std::string radius_in_words(double radius_m) {
  return std::isfinite(radius_m) ? fmt::format("{:.4g}", 1e3 * radius_m) : "inf";
}

std::string finger_in_words(const input::CaseBody& finger) {
  if (const auto* sphere = std::get_if<input::SphereBody>(&finger))
    return fmt::format("curved, a sphere of R {} mm", radius_in_words(sphere->radius_m));
  if (const auto* scan = std::get_if<input::MeshBody>(&finger))
    return "curved, the scan " + scan->path.filename().string() +
           (scan->core.empty() ? "" : " on its core " + scan->core.filename().string());
  const auto& quadric = std::get<input::QuadricBody>(finger);
  return fmt::format("curved, R {} and {} mm{}", radius_in_words(quadric.radius_x_m),
                     radius_in_words(quadric.radius_y_m),
                     quadric.shape == input::FingerShape::tapered ? ", tapered" : "");
}

std::string geometry_in_words(const input::Case& contact_case) {
  if (!contact_case.fem_mesh.empty())
    return "the layer's own mesh " + contact_case.fem_mesh.filename().string();
  if (contact_case.fem_curved)
    return "the finger itself (" +
           finger_in_words(std::get<input::BodyPair>(contact_case.geometry).finger) + ")";
  const std::string layers =
      contact_case.object_layer.thickness_m > 0 ? "two flat layers" : "a flat layer";
  return layers + (std::holds_alternative<input::BodyPair>(contact_case.geometry)
                       ? " under the relative radii"
                       : " under the case's relative radii");
}

std::string strain_in_words(const input::Case& contact_case) {
  if (!contact_case.fem_finite) return "linear elasticity";
  std::string material = "neo-Hookean";
  if (contact_case.fem_finite->material == "mooney_rivlin") material = "Mooney-Rivlin";
  if (contact_case.fem_finite->material == "yeoh") material = "Yeoh";
  if (!contact_case.sublayers.empty()) material = "each layer of its own material";
  return "finite strain, " + material +
         (contact_case.fem_finite->volumetric == "logarithmic" ? ", logarithmic volume energy"
                                                               : "");
}

double bound_of(const FemAnswerText& answer, Quantity quantity) {
  return answer.bound.bound ? (*answer.bound.bound)[std::size_t(quantity)]
                            : std::numeric_limits<double>::quiet_NaN();
}

/// " ± 0.4 %"; where nobody knows, " (± not known)".
std::string with_bound(double bound) {
  return std::isfinite(bound) ? " ± " + text::percent(bound) : " (± not known)";
}

/// ", at 4 s"; ", held for long"; empty where nothing changes with time.
std::string when_in_words(const FemAnswerText& answer) {
  if (!answer.time_s) return "";
  return std::isinf(*answer.time_s) ? ", held for long"
                                    : fmt::format(", at {:.4g} s", *answer.time_s);
}

}  // namespace

std::string describe_reference(const input::Case& contact_case, int level) {
  return fmt::format("{}, {}, Q2/P1 elements of level {}, pressed {}",
                     geometry_in_words(contact_case), strain_in_words(contact_case), level,
                     contact_case.pressing == PressingFriction::none ? "without friction"
                     : contact_case.pressing == PressingFriction::coulomb
                         ? "with Coulomb's friction"
                         : "without any slip");
}

std::string answer_line(const FemAnswerText& answer) {
  const reference::ReferenceResult& result = answer.result;
  const input::Case& contact_case = answer.contact_case;
  const std::string beyond = reference::beyond_limits_in_words(answer.validity);
  const char* const what = !contact_case.fem_mesh.empty()              ? "the layer's own mesh"
                           : contact_case.fem_curved                   ? "the finger itself"
                           : contact_case.object_layer.thickness_m > 0 ? "two flat layers"
                                                                       : "a flat layer";
  return fmt::format(
      "max torque {:.4g} mN·m{}, contact {:.3g} x {:.3g} mm, e_n {:.3g} mm, at {:.4g} N{}: finite "
      "elements of {} {}{}",
      1e3 * result.max_torque_Nm, with_bound(bound_of(answer, Quantity::max_torque)),
      2e3 * result.a_m, 2e3 * result.b_m, 1e3 * result.eccentricity_m, result.load_N,
      (answer.approach_m ? fmt::format(", pressed by {:.4g} mm", 1e3 * *answer.approach_m) : "") +
          when_in_words(answer),
      what, contact_case.fem_finite ? "at finite strain" : "in linear theory",
      beyond.empty() ? "" : ", NOT VALID: " + beyond);
}

std::string evidence_text(const FemAnswerText& answer) {
  const reference::ReferenceResult& result = answer.result;
  std::string text =
      fmt::format("{:g} N: {}\n", result.load_N, prediction::describe(answer.geometry)) +
      table_of(result) + "  ± of the answer: " + answer.bound.evidence + "\n";
  for (const ValidityCheck& check : answer.validity)
    if (!check.holds())
      text += fmt::format("  not valid: {} {:.2g}, holds below {:.2g}: {}\n", check.check,
                          check.value, check.limit, check.message);
  if (answer.contact_case.pressing != PressingFriction::none)
    text += fmt::format(
        "  pressed with friction: {:.0f} % of the area sticks; the torque is that of full slip, "
        "the same as without{}\n",
        100 * result.document.value("stick_share", 0.0),
        result.twist && answer.contact_case.fem_finite
            ? "; at finite strain the twist starts from pressing without friction"
            : "");
  if (result.twist) text += twist_table(result);
  if (!result.limit_surface.empty()) text += limit_surface_table(result);
  if (result.coarse) text += "  (interrupted: the result of a coarser level than requested)\n";
  return text;
}

nlohmann::json to_json(const FemAnswerText& answer) {
  const reference::ReferenceResult& result = answer.result;
  nlohmann::json object = result.document;
  object["load_N"] = result.load_N;
  if (answer.time_s) {
    object["time_s"] = text::finite_or_null(*answer.time_s);
    object["relaxation"] = prediction::relaxation_json(answer.contact_case.times);
    object["history"] = prediction::history_json(answer.contact_case.times);
  }
  object["model"] = "fem";
  object["torque_rule"] = "exact";
  object["valid"] = answer.validity.holds();
  object["validity"] = prediction::to_json(answer.validity);
  object["error_bound"] = prediction::to_json(answer.bound.bound);
  object["error_evidence"] = answer.bound.evidence;
  object["geometry"] = !answer.contact_case.fem_mesh.empty() ? "mesh"
                       : answer.contact_case.fem_curved      ? "curved"
                                                             : "flat";
  object["kinematics"] = answer.contact_case.fem_finite ? "finite" : "linear";
  object["pressing"] = name_of(answer.contact_case.pressing);
  object["cost_ns"] = text::finite_or_null(1e9 * result.wall_s);
  return object;
}

}  // namespace softfinger::commands
