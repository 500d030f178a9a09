#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/contact_choice.h"
#include "comparisons/commands/export_pad.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/exporting/contact_curve.h"
#include "comparisons/exporting/simulator.h"
#include "comparisons/prediction/answer_in_time.h"
#include "comparisons/prediction/answer_json.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/system/files.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

using exporting::ContactCurve;
using exporting::LoadPoint;
using exporting::Simulator;
using exporting::SoftContact;

struct ExportOptions {
  ContactChoice contact;
  std::string to;
  std::string meters_per_unit;
  bool json = false;
};

/// An exported contact with the request behind it.
struct Export {
  const Simulator& simulator;
  const ContactCurve& curve;
  SoftContact contact;
  exporting::Lines lines;
  std::vector<double> errors;        ///< of the torque, at each of the curve's points
  std::vector<double> force_errors;  ///< likewise
  std::size_t worst = 0;             ///< index of the largest
  std::size_t worst_force = 0;

  /// @param meters_per_unit  of a USD stage
  Export(const Simulator& of, const ContactCurve& from, exporting::Fit fit, double meters_per_unit)
      : simulator(of),
        curve(from),
        contact(in_stage(soft_contact(curve, simulator, fit), meters_per_unit)),
        lines(point_lines(simulator, contact)),
        errors(relative_errors(simulator, contact, curve)),
        force_errors(relative_force_errors(contact, curve)) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      if (std::abs(errors[i]) > std::abs(errors[worst])) worst = i;
      if (std::abs(force_errors[i]) > std::abs(force_errors[worst_force])) worst_force = i;
    }
  }

  static SoftContact in_stage(SoftContact contact, double meters_per_unit) {
    contact.meters_per_unit = meters_per_unit;
    return contact;
  }

  double eccentricity_m(double load_N) const {
    return eccentricity_in_simulator_m(simulator, contact, load_N);
  }
};

/// Against the finger itself, what its geometry leaves open included.
std::optional<prediction::QuantityErrors> bound_of(const LoadPoint& point) {
  if (!point.assessment.bound) return std::nullopt;
  return point.assessment.totals();
}

nlohmann::json to_json(const Export& made, const std::string& fit, bool with_lines) {
  const ContactCurve& curve = made.curve;
  nlohmann::json values = nlohmann::json::object(), loads = nlohmann::json::array(),
                 results = nlohmann::json::array();
  for (const auto& [name, value] : made.lines.values) values[name] = text::finite_or_null(value);
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const LoadPoint& point = curve.points[i];
    results.push_back({{"load_N", point.load_N},
                       {"model", curve.model},
                       {"a_m", point.a_m},
                       {"b_m", point.b_m},
                       {"indentation_m", point.indentation_m},
                       {"max_force_N", text::finite_or_null(point.max_force_N())},
                       {"max_torque_Nm", text::finite_or_null(point.max_torque_Nm())},
                       {"eccentricity_m", text::finite_or_null(point.eccentricity_m)},
                       {"usable", point.assessment.usable},
                       {"recommended", point.load_N == curve.nominal.load_N},
                       {"error_bound", prediction::to_json(bound_of(point))},
                       {"geometry_error", prediction::to_json(point.assessment.geometry)}});
    loads.push_back(
        {{"load_N", point.load_N},
         {"eccentricity_m", text::finite_or_null(point.eccentricity_m)},
         {"max_force_N", text::finite_or_null(point.max_force_N())},
         {"max_torque_Nm", text::finite_or_null(point.max_torque_Nm())},
         {"simulator_eccentricity_m", text::finite_or_null(made.eccentricity_m(point.load_N))},
         {"relative_error", text::finite_or_null(made.errors[i])},
         {"force_relative_error", text::finite_or_null(made.force_errors[i])},
         {"usable", point.assessment.usable},
         {"error_bound", text::finite_or_null(point.error_bound())}});
  }
  return {
      {"case", curve.case_id},
      {"simulator", made.simulator.name},
      {"law", made.simulator.law},
      {"checked_against", made.simulator.checked_against},
      {"model", curve.model},
      {"fit", fit},
      {"load_N", curve.nominal.load_N},
      {"load_range_N", {curve.points.front().load_N, curve.points.back().load_N}},
      {"shear_law", curve.shear_law.name()},
      {"friction_coefficient", text::finite_or_null(curve.nominal.friction_coefficient)},
      {"friction_exponent", text::finite_or_null(curve.friction_exponent)},
      {"eccentricity_m", text::finite_or_null(curve.nominal.eccentricity_m)},
      {"usable", curve.nominal.assessment.usable},
      {"reason", curve.advice.empty() ? nlohmann::json() : nlohmann::json(curve.advice)},
      {"error_bound", text::finite_or_null(curve.nominal.error_bound())},
      {"error_evidence", curve.nominal.assessment.evidence},
      {"input_doubt", to_json(curve.nominal.inputs)},
      {"normal_stiffness_N_per_m", text::finite_or_null(curve.normal_stiffness_N_per_m)},
      {"torsional_stiffness_Nm_per_rad", curve.torsional_stiffness_Nm_per_rad > 0
                                             ? nlohmann::json(curve.torsional_stiffness_Nm_per_rad)
                                             : nlohmann::json()},
      {"load_exponent", text::finite_or_null(curve.load_exponent)},
      {"simulator_load_exponent", made.simulator.load_exponent},
      {"lines", with_lines ? nlohmann::json(made.lines.text) : nlohmann::json()},
      {"values", with_lines ? values : nlohmann::json()},
      {"loads", loads},
      {"results", results},
      {"worst_relative_error", text::finite_or_null(made.errors[made.worst])},
      {"worst_force_relative_error", text::finite_or_null(made.force_errors[made.worst_force])},
      {"traps", made.simulator.traps}};
}

/// The largest force, whose ratio to the load depends on the load under the shear law.
std::string forces_in_words(const Export& made) {
  const ContactCurve& curve = made.curve;
  std::string text = fmt::format(
      "Largest force / load {:.4g}, which goes with P^{:.3f} there, in {} it is {:.4g} at any "
      "load:\n"
      "  {:>9} {:>12} {:>9} {:>13}\n",
      curve.nominal.friction_coefficient, curve.friction_exponent, made.simulator.title,
      made.contact.friction_coefficient, "load N", "force N", "over load", "its force %");
  for (std::size_t i = 0; i < curve.points.size(); ++i)
    text += fmt::format("  {:>9.4g} {:>12.4g} {:>9.4g} {:>+13.1f}\n", curve.points[i].load_N,
                        curve.points[i].max_force_N(), curve.points[i].friction_coefficient,
                        std::abs(made.force_errors[i]) < 5e-4 ? 0.0 : made.force_errors[i] * 100);
  return text + fmt::format("Worst over {:g} to {:g} N: {:+.1f} % of the force, at {:.4g} N\n",
                            curve.points.front().load_N, curve.points.back().load_N,
                            made.force_errors[made.worst_force] * 100,
                            curve.points[made.worst_force].load_N);
}

std::string to_text(const Export& made) {
  const ContactCurve& curve = made.curve;
  const std::string title(made.simulator.title);
  const std::string growth =
      !made.simulator.has_torque ? title + " has no torque"
      : made.simulator.load_exponent == 0
          ? title + " keeps it constant"
          : fmt::format("in {} with P^{:g}", title, made.simulator.load_exponent);
  std::string text = made.lines.text + "\n";
  text += fmt::format(
      "{}: {}\nThere e_n goes with P^{:.3f}, {}. Approach {:.4g} mm, normal stiffness dP/dd {:.4g} "
      "N/mm\n",
      title, made.simulator.law, curve.load_exponent, growth, curve.nominal.indentation_m * 1e3,
      curve.normal_stiffness_N_per_m * 1e-3);
  text += fmt::format("  {:>9} {:>12} {:>9} {:>16} {:>13} {:>6}\n", "load N", "torque mN·m",
                      "e_n mm", "e_n there mm", "its torque %", "e_n ±");
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const LoadPoint& point = curve.points[i];
    text += fmt::format("  {:>9.4g} {:>12.4g} {:>9.4g} {:>16.4g} {:>+13.1f} {:>6}\n", point.load_N,
                        point.max_torque_Nm() * 1e3, point.eccentricity_m * 1e3,
                        made.eccentricity_m(point.load_N) * 1e3,
                        // A value that rounds to zero is printed without a sign.
                        std::abs(made.errors[i]) < 5e-4 ? 0.0 : made.errors[i] * 100,
                        short_error(point));
  }
  text += fmt::format("Worst over {:g} to {:g} N: {:+.1f} % of the torque, at {:.4g} N\n",
                      curve.points.front().load_N, curve.points.back().load_N,
                      made.errors[made.worst] * 100, curve.points[made.worst].load_N);
  if (curve.shear_law.has_shear_strength()) text += forces_in_words(made);
  for (const auto trap : made.simulator.traps) text += fmt::format("- {}\n", trap);
  return text;
}

/// Text on which the answer rests: the case, and the evidence for its error.
std::string evidence_text(const input::Case& contact_case, const ContactCurve& curve) {
  return fmt::format("{}\nThe error: {}\n", prediction::describe(contact_case),
                     curve.nominal.assessment.evidence);
}

/// @throws InputError for a unit that is none, and beside another simulator than USD
double meters_per_unit_of(const ExportOptions& options, const Simulator& simulator) {
  if (options.meters_per_unit.empty()) return 1;
  if (simulator.name != "usd")
    throw InputError("command line", "--meters-per-unit", options.meters_per_unit,
                     "none with --to " + std::string(simulator.name) +
                         ", which is in metres: the unit of a stage, with --to usd");
  const std::string wanted = "a number > 0, in m: 1 for metres, 0.01 for centimetres";
  const double unit_m = number_of("--meters-per-unit", options.meters_per_unit, wanted);
  if (!(unit_m > 0) || !std::isfinite(unit_m))
    throw InputError("command line", "--meters-per-unit", options.meters_per_unit, wanted);
  return unit_m;
}

int run_export(const ExportOptions& options) {
  const Simulator& simulator = simulator_by_name(options.to);
  const double meters_per_unit = meters_per_unit_of(options, simulator);
  const input::Case contact_case = read_contact_case(options.contact);
  input::refuse_curved_pad(contact_case, "softfinger export");
  if (std::holds_alternative<input::PadPair>(contact_case.geometry))
    return export_pad(simulator, contact_case, options.contact, meters_per_unit, options.json);
  if (contact_case.times.are_given() && options.contact.at_time.empty() &&
      contact_case.times.history.empty())
    remark(
        "the rubber relaxes: these lines are for a load that was put on just now; --at-time S is "
        "for one that is held");
  const ContactCurve curve = ask_contact_curve(contact_case, options.contact);
  const Export made(simulator, curve, options.contact.kind_of_fit(), meters_per_unit);
  const bool usable = curve.nominal.assessment.usable, told = usable || options.contact.force;
  if (options.json) {
    nlohmann::json object = to_json(made, options.contact.fit, told);
    if (contact_case.times.are_given()) {
      object["time_s"] = loads_of(contact_case, options.contact).time_s;
      object["effective_load_N"] = curve.nominal.effective_load_N;
      object["relaxation"] = prediction::relaxation_json(contact_case.times);
      object["history"] = prediction::history_json(contact_case.times);
    }
    system::write_to_stdout(text::printed(object));
  } else {
    system::write_text_to_stdout(answer_line(curve) +
                                 (told ? "\n" + to_text(made) + evidence_text(contact_case, curve)
                                       : std::string(kHowToForce)));
  }
  return usable ? 0 : 1;
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand(
      "export",
      "What to type into a simulator, and the error of its constants over a range of loads");
  add_case(*command, options->contact.typed_case, true, input::FlatPads::taken);
  options->contact.typed_case.times = input::Times::taken;
  command
      ->add_option(
          "--to", options->to,
          "mujoco, bullet, gazebo (Classic, with ODE), gz-sim, drake (hydroelastic), genesis, "
          "isaac (Isaac Lab), newton, ode, physx, sapien (also ManiSkill) or usd")
      ->required();
  add_contact_choice(*command, options->contact);
  command->add_option("--at-time", options->contact.at_time,
                      "seconds: the contact at this time, for a case with [layer] relaxation or "
                      "[contact] history; default: the end of the history, else at once");
  command->add_option("--meters-per-unit", options->meters_per_unit,
                      "with --to usd: metersPerUnit of the stage, > 0 (default: 1, metres; 0.01: "
                      "centimetres); lengths are written in this unit");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "e_n is the largest torque about the normal divided by mu P; it grows with the load, by "
      "about\n"
      "P^(1/5) to P^(1/3), where most simulators keep it constant. Under another shear_law of the\n"
      "case the largest force / load, exported as mu, depends on the load too; e_n is then over "
      "the\n"
      "largest force, and both errors are stated.\n"
      "A case with relaxation or history is exported for one time; over the range of loads its\n"
      "history is scaled, and the stiffness is that of quick motion: "
      "docs/a_gripper_that_creeps.md.\n"
      "A flat pad is exported as a box whose corners' forces have its torque, and as one point: "
      "docs/flat_pads.md.\n"
      "Samples:\n"
      "  softfinger export silicone_pad_2mm --to mujoco\n"
      "  softfinger export seed_thumb --to drake --load 2 --load-range 0.5,8\n"
      "  softfinger export --pad-mm 22,37.5 --thickness-mm 3 --youngs-modulus-kPa 600 "
      "--poisson-ratio 0.49 --load 20 --to mujoco\n"
      "  softfinger export silicone_pad_2mm --to usd --meters-per-unit 0.01\n"
      "  softfinger export hertz_circle --to gazebo --model hertz --fit range --json");
  command->callback([options, &action] { action = [options] { return run_export(*options); }; });
}

}  // namespace softfinger::commands
