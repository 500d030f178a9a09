#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/contact_choice.h"
#include "comparisons/exporting/robot_file.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/system/files.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/nearest_name.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

namespace fs = std::filesystem;
using exporting::ContactCurve;
using exporting::Simulator;
using exporting::SoftContact;
using exporting::XmlChange;
using exporting::XmlFile;

/// Models of robots with their meshes apart are far smaller.
constexpr std::size_t kMostBytes = 20'000'000;

struct ApplyOptions {
  std::string model, to, output;
  std::vector<std::string> fingers;
  ContactChoice contact;
  double effective_mass_g = 0, depth_mm = 0;
  bool plugin = false, in_place = false, json = false;
};

/// "-31.6 to +43.0 % of the torque over 0.5 to 10 N", "the force is exact"
std::string range_of(const std::vector<double>& errors, const ContactCurve& curve, const char* of) {
  const auto [least, largest] = std::minmax_element(errors.begin(), errors.end());
  if (std::abs(*least) < 5e-4 && std::abs(*largest) < 5e-4)
    return fmt::format("the {} is exact", of);
  const auto percent = [](double error) { return std::abs(error) < 5e-4 ? 0.0 : 100 * error; };
  return fmt::format("{:+.1f} to {:+.1f} % of the {} over {:g} to {:g} N", percent(*least),
                     percent(*largest), of, curve.points.front().load_N,
                     curve.points.back().load_N);
}

/// The contact for the plugin, which knows one layer on a rigid object, and Coulomb's law.
ContactProblem plugin_problem(const ApplyOptions& options, const input::Case& contact_case,
                              double load_N) {
  if (!options.contact.model.empty())
    throw InputError("command line", "--model", options.contact.model,
                     "no --model beside --plugin, which follows the recommended one");
  const auto refuse = [&](const char* what, const char* allowed) {
    throw InputError(contact_case.id, std::string("--plugin with ") + what, "", allowed);
  };
  if (contact_case.shear_law.has_shear_strength()) refuse("a shear strength", "Coulomb's law");
  if (contact_case.object_layer.thickness_m > 0) refuse("an object_layer", "one layer");
  if (!contact_case.sublayers.empty()) refuse("several sublayers", "a homogeneous layer");
  return prediction::contact_problem(
      contact_case, prediction::GeometryResolver(contact_case).resolve(load_N), load_N);
}

/// Path of the file to write.
/// @throws InputError
fs::path output_of(const ApplyOptions& options) {
  const bool is_input = options.model == "-";
  if (options.in_place) {
    if (is_input || !options.output.empty())
      throw InputError("command line", "--in-place", "", "a file, and no --output");
    return options.model;
  }
  if (options.output.empty())
    throw InputError("command line", "--output is missing", "", "the file to write, or --in-place");
  std::error_code error;
  if (!is_input && fs::equivalent(options.model, options.output, error))
    throw InputError("command line", "--output", options.output,
                     "another file than MODEL, or --in-place");
  return options.output;
}

/// A copy in another folder does not find meshes by relative paths.
bool leaves_files_behind(const XmlFile& file, const ApplyOptions& options, const fs::path& output) {
  if (options.model == "-" || options.in_place) return false;
  std::error_code error;
  const auto folder = [](const fs::path& path) {
    return path.parent_path().empty() ? fs::path(".") : path.parent_path();
  };
  if (fs::equivalent(folder(options.model), folder(output), error)) return false;
  const auto is_relative = [](const std::string& path) {
    return !path.empty() && path.front() != '/' && path.find("://") == std::string::npos;
  };
  for (const auto& element : file.elements()) {
    if (is_relative(element->value("file")) || is_relative(element->value("filename"))) return true;
    if (element->name == "uri" && is_relative(element->text)) return true;
  }
  return false;
}

nlohmann::json to_json(const ApplyOptions& options, const XmlFile& file, const fs::path& output,
                       const Simulator& simulator, const ContactCurve& curve,
                       const SoftContact& contact, bool written,
                       const std::vector<std::string>& notes) {
  const auto errors = relative_errors(simulator, contact, curve);
  const auto force_errors = relative_force_errors(contact, curve);
  const auto text_or_null = [](const std::string& text) {
    return text.empty() ? nlohmann::json() : nlohmann::json(text);
  };
  nlohmann::json changes = nlohmann::json::array(), loads = nlohmann::json::array();
  for (const XmlChange& change : file.changes())
    changes.push_back({{"line", change.line},
                       {"element", change.element},
                       {"name", change.name},
                       {"before", text_or_null(change.before)},
                       {"after", text_or_null(change.after)},
                       {"effect", change.effect}});
  double worst = 0;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const auto& point = curve.points[i];
    worst = std::max(worst, std::abs(errors[i]));
    loads.push_back({{"load_N", point.load_N},
                     {"max_torque_Nm", text::finite_or_null(point.max_torque_Nm())},
                     {"relative_error", text::finite_or_null(errors[i])},
                     {"force_relative_error", text::finite_or_null(force_errors[i])}});
  }
  return {{"model", options.model},
          {"usable", curve.nominal.assessment.usable},
          {"reason", text_or_null(curve.advice)},
          {"written", written},
          {"format", exporting::name_of(format_of(file))},
          {"simulator", simulator.name},
          {"output", output.string()},
          {"case", curve.case_id},
          {"pressure_model", curve.model},
          {"load_N", curve.nominal.load_N},
          {"load_range_N", {curve.points.front().load_N, curve.points.back().load_N}},
          {"friction_coefficient", text::finite_or_null(contact.friction_coefficient)},
          {"eccentricity_m", text::finite_or_null(contact.eccentricity_m)},
          {"normal_stiffness_N_per_m", text::finite_or_null(curve.normal_stiffness_N_per_m)},
          {"input_doubt", to_json(curve.nominal.inputs)},
          {"changes", changes},
          {"loads", loads},
          {"worst_relative_error", text::finite_or_null(worst)},
          {"notes", notes},
          {"traps", simulator.traps}};
}

std::string to_text(const ApplyOptions& options, const XmlFile& file, const fs::path& output,
                    const Simulator& simulator, const ContactCurve& curve) {
  std::string text =
      fmt::format("{} ({}) for {}, by the case {}; dP/dd {:.4g} N/mm\n\n", options.model,
                  exporting::name_of(format_of(file)), simulator.title, curve.case_id,
                  1e-3 * curve.normal_stiffness_N_per_m);
  for (const XmlChange& change : file.changes())
    text += fmt::format("line {:<5} {}: {} {} -> {}{}\n", change.line, change.element, change.name,
                        change.before.empty() ? "-" : "\"" + text::shortened(change.before) + "\"",
                        change.after.empty() ? "-" : "\"" + change.after + "\"",
                        change.effect.empty() ? "" : "\n           " + change.effect);
  if (file.changes().empty()) text += "Nothing had to be changed.\n";
  text += "\n";
  for (const auto trap : simulator.traps) text += fmt::format("- {}\n", trap);
  return text + "Written: " + output.string() +
         "\nThe error: " + curve.nominal.assessment.evidence + "\n";
}

int run_apply(const ApplyOptions& options) {
  const Simulator& simulator = simulator_by_name(options.to);
  const fs::path output = output_of(options);
  const bool is_mujoco = simulator.name == "mujoco";
  if (!is_mujoco && (options.plugin || options.effective_mass_g > 0))
    throw InputError("command line", options.plugin ? "--plugin" : "--effective-mass-g", "",
                     "with --to mujoco");
  if (options.model == "-" && options.contact.typed_case.file == "-")
    throw InputError("command line", "CASE", "\"-\"",
                     "a file or a built-in case, as MODEL is standard input");
  XmlFile file(options.model == "-" ? system::read_standard_input(kMostBytes)
               : options.in_place   ? system::read_file_to_rewrite(options.model, kMostBytes)
                                    : system::read_text_file(options.model, kMostBytes),
               options.model == "-" ? "standard input" : options.model);

  const input::Case contact_case = read_contact_case(options.contact);
  const ContactCurve curve = ask_contact_curve(contact_case, options.contact);
  exporting::RobotContact wanted;
  wanted.contact = soft_contact(curve, simulator, options.contact.kind_of_fit());
  wanted.torque_error =
      range_of(relative_errors(simulator, wanted.contact, curve), curve, "torque");
  wanted.force_error = range_of(relative_force_errors(wanted.contact, curve), curve, "force");
  if (options.effective_mass_g > 0) wanted.effective_mass_kg = 1e-3 * options.effective_mass_g;
  if (options.depth_mm > 0) wanted.depth_m = 1e-3 * options.depth_mm;
  if (options.plugin) wanted.plugin = plugin_problem(options, contact_case, curve.nominal.load_N);
  const std::vector<std::string> notes = apply_contact(file, options.fingers, simulator, wanted);

  const std::string text = file.text();
  // The written file must read back as a model in which nothing is left to change.
  XmlFile again(text, output.string());
  apply_contact(again, options.fingers, simulator, wanted);
  if (!again.changes().empty())
    throw InputError(options.model, "the changed file does not read back", "",
                     "elements that are written once");
  const bool usable = curve.nominal.assessment.usable, written = usable || options.contact.force;
  if (written) system::write_file_atomically(output, text);
  for (const std::string& note : notes) remark(options.model + ": " + note);
  if (written && leaves_files_behind(file, options, output))
    remark(output.string() +
           ": the file names others by relative paths, which do not lie in its folder");
  if (options.json)
    system::write_to_stdout(text::printed(
        to_json(options, file, output, simulator, curve, wanted.contact, written, notes)));
  else
    system::write_text_to_stdout(
        answer_line(curve) +
        (written ? to_text(options, file, output, simulator, curve) : std::string(kHowToForce)));
  return usable ? 0 : 1;
}

}  // namespace

void add_apply(CLI::App& app, Action& action) {
  auto options = std::make_shared<ApplyOptions>();
  CLI::App* command = app.add_subcommand(
      "apply",
      "Writes a contact's friction into a copy of a robot's model: MJCF, URDF or SDF. Lists each "
      "change with its error over the loads; the rest of the file keeps its bytes");
  command
      ->add_option("MODEL", options->model, "MJCF, URDF or SDF file, or \"-\" for standard input")
      ->required();
  add_case(*command, options->contact.typed_case, true);
  command
      ->add_option("--finger", options->fingers,
                   "MJCF: a geom, or a body for all its geoms that touch others; URDF, SDF: a "
                   "collision, a link for all its collisions, LINK::COLLISION or "
                   "MODEL::LINK::COLLISION; may be repeated")
      ->required()
      ->allow_extra_args(false);
  command
      ->add_option(
          "--to", options->to,
          "mujoco for MJCF; gazebo (Classic, with ODE), drake (hydroelastic) or bullet for "
          "URDF and SDF")
      ->required();
  command->add_option("-o,--output", options->output, "the file to write");
  command->add_flag("--in-place", options->in_place, "write MODEL itself");
  add_contact_choice(*command, options->contact);
  command->add_flag("--plugin", options->plugin,
                    "MuJoCo: also list the geoms for libsoftfinger_mujoco, with which the torque "
                    "follows the load");
  command
      ->add_option(
          "--effective-mass-g", options->effective_mass_g,
          "MuJoCo: mass that the contact moves, in g (a free object between heavy fingers: "
          "its own), for a solref with the model's normal stiffness")
      ->check(CLI::Range(1e-3, 1e6));
  command
      ->add_option("--depth-mm", options->depth_mm,
                   "Drake: depth of the fingertip's innermost point in mm; default: that of its "
                   "shape; meshes need it")
      ->check(CLI::Range(1e-3, 1e4));
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "The contact is that of export: e_n is constant, and exact at the nominal load. A DOCTYPE "
      "is\n"
      "refused, included files are named but not read, files are at most 20 MB.\n"
      "Samples:\n"
      "  softfinger apply hand.xml silicone_pad_2mm --finger tip_1 --finger tip_2 --to mujoco -o "
      "soft.xml\n"
      "  softfinger apply hand.xml silicone_pad_2mm --finger tip_1 --to mujoco --plugin --output "
      "soft.xml --json");
  command->callback([options, &action] { action = [options] { return run_apply(*options); }; });
}

}  // namespace softfinger::commands
