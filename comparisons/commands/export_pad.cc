#include "comparisons/commands/export_pad.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "comparisons/commands/number_option.h"
#include "comparisons/exporting/pad_contact.h"
#include "comparisons/system/files.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

using exporting::Lines;
using exporting::PadContact;
using exporting::Simulator;

double bound_of_torque(const PadContact& made) {
  return made.answer.bound ? made.answer.bound->max_torque : kNaN;
}

nlohmann::json values_json(const Lines& lines) {
  nlohmann::json values = nlohmann::json::object();
  for (const auto& [name, value] : lines.values) values[name] = text::finite_or_null(value);
  return values;
}

nlohmann::json to_json(const PadContact& made, const Simulator& simulator,
                       const input::Case& contact_case, bool told) {
  const exporting::SoftContact& contact = made.contact;
  const Lines lines = point_lines(simulator, contact), box = box_lines(simulator, contact);
  nlohmann::json result = to_json(made.answer, 0);
  result["recommended"] = true;
  nlohmann::json traps =
      nlohmann::json::array({exporting::pad_points_trap(simulator.friction_is_pyramid)});
  for (const auto trap : simulator.traps) traps.push_back(trap);
  return {{"case", contact_case.id},
          {"simulator", simulator.name},
          {"law", simulator.law},
          {"checked_against", simulator.checked_against},
          {"model", made.answer.model->card().name},
          {"load_N", contact.load_N},
          {"friction_coefficient", contact.friction_coefficient},
          {"eccentricity_m", text::finite_or_null(contact.eccentricity_m)},
          {"usable", made.answer.usable},
          {"error_bound", text::finite_or_null(bound_of_torque(made))},
          {"error_evidence", made.answer.evidence},
          {"normal_stiffness_N_per_m", text::finite_or_null(contact.normal_stiffness_N_per_m)},
          {"torsional_stiffness_Nm_per_rad",
           text::finite_or_null(contact.torsional_stiffness_Nm_per_rad)},
          {"lines", told ? nlohmann::json(lines.text) : nlohmann::json()},
          {"values", told ? values_json(lines) : nlohmann::json()},
          {"box_lines", told ? nlohmann::json(box.text) : nlohmann::json()},
          {"box_values", told ? values_json(box) : nlohmann::json()},
          {"controller",
           {{"torsional_length_m", text::finite_or_null(contact.eccentricity_m)},
            {"tipping_half_lengths_m", made.tipping_half_lengths_m()},
            {"lift_off_half_lengths_m", made.lift_off_half_lengths_m()}}},
          {"results", {result}},
          {"traps", traps}};
}

std::string answer_text(const PadContact& made) {
  const double bound = bound_of_torque(made);
  return fmt::format("{:g} N: {}torque {:.3g} mN·m ± {}, by {}; e_n {:.3g} mm at any load{}\n",
                     made.contact.load_N, made.answer.usable ? "" : "NOT USABLE: ",
                     1e3 * made.answer.friction_ellipsoid().max_torque_Nm(),
                     std::isfinite(bound) ? text::percent(bound) : "?",
                     made.answer.model->card().name, 1e3 * made.contact.eccentricity_m,
                     made.answer.usable ? "" : "; " + made.answer.evidence);
}

std::string lines_text(const PadContact& made, const Simulator& simulator) {
  const exporting::SoftContact& contact = made.contact;
  const auto tipping_m = made.tipping_half_lengths_m(), lift_off_m = made.lift_off_half_lengths_m();
  std::string text = fmt::format(
      "\n{}\n{}\n{}: {}\nNormal stiffness dP/dd {:.4g} N/mm\n"
      "Controllers (MPC, whole-body): |torque| <= mu P {:.4g} mm; the centre of pressure within "
      "±{:.4g} x ±{:.4g} mm, or the pad tips; within ±{:.3g} along x or ±{:.3g} along y no rim "
      "lifts "
      "off\n- {}\n",
      box_lines(simulator, contact).text, point_lines(simulator, contact).text, simulator.title,
      simulator.law, 1e-3 * contact.normal_stiffness_N_per_m, 1e3 * contact.eccentricity_m,
      1e3 * tipping_m[0], 1e3 * tipping_m[1], 1e3 * lift_off_m[0], 1e3 * lift_off_m[1],
      exporting::pad_points_trap(simulator.friction_is_pyramid));
  for (const auto trap : simulator.traps) text += fmt::format("- {}\n", trap);
  return text;
}

}  // namespace

int export_pad(const Simulator& simulator, const input::Case& contact_case,
               const ContactChoice& choice, double meters_per_unit, bool json) {
  if (!choice.model.empty())
    throw InputError("command line", "--model", choice.model, "none for a flat pad: pad_layer");
  if (!choice.load_range.empty())
    throw InputError("command line", "--load-range", choice.load_range,
                     "none for a flat pad: its e_n does not depend on the load");
  double load_N = contact_case.loads_N.front();
  if (!choice.load.empty()) load_N = number_of("--load", choice.load, "a number > 0, in N");
  if (!(load_N > 0) || !std::isfinite(load_N))
    throw InputError("command line", "--load", choice.load, "a number > 0, in N");
  PadContact made = exporting::ask_pad_contact(contact_case, load_N, choice.demand.demand());
  made.contact.meters_per_unit = meters_per_unit;
  const bool told = made.answer.usable || choice.force;
  if (json)
    system::write_to_stdout(text::printed(to_json(made, simulator, contact_case, told)));
  else
    system::write_text_to_stdout(answer_text(made) +
                                 (told ? lines_text(made, simulator) : std::string(kHowToForce)));
  return made.answer.usable ? 0 : 1;
}

}  // namespace softfinger::commands
