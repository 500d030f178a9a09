#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "comparisons/commands/case_input.h"
#include "comparisons/commands/commands.h"
#include "comparisons/explorer/explorer.h"
#include "comparisons/exporting/contact_curve.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/pad_answer.h"
#include "comparisons/report/explorer_page.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/input/errors.h"
#include "softfinger/pads/pad_model.h"

namespace softfinger::commands {
namespace {

struct ExploreOptions {
  CaseInput typed_case;
  std::string output = "explore.html", command_line;
  bool json = false;
};

using Start = std::variant<std::monostate, report::ExplorerStart, report::PadStart>;

/// The contact of a case at its middle load.
/// @throws InputError for what the page does not know
/// The page has no fillet: it gets the pad without one that bears alike.
input::PadPair bearing_pair(const input::Case& contact_case) {
  auto pair = std::get<input::PadPair>(contact_case.geometry);
  if (!(pair.finger.edge_radius_m > 0)) return pair;
  const ConvexOutline bearing = prediction::bearing_outline(contact_case);
  const Eigen::Vector2d extent_m = bearing.extent_m();
  if (auto* rectangle = std::get_if<input::RectangleFigure>(&pair.finger.figure))
    *rectangle = {extent_m.x(), extent_m.y(),
                  std::max(0.0, rectangle->corner_radius_m - pair.finger.edge_radius_m)};
  else if (auto* disc = std::get_if<input::DiscFigure>(&pair.finger.figure))
    disc->diameter_m = extent_m.x();
  else
    pair.finger.figure = input::OutlineFigure{bearing.vertices_m()};
  pair.finger.edge_radius_m = 0;
  pair.pad = pair.contact = bearing;
  return pair;
}

Start start_of(const CaseInput& typed) {
  const bool is_typed = !typed.file.empty() || !typed.radii_mm.empty() || !typed.pad_mm.empty() ||
                        !typed.pad_diameter_mm.empty();
  if (!is_typed) return {};
  const input::Case contact_case = read_case(typed);
  const std::string name = typed.file.empty() ? "command line" : typed.file;
  if (const auto* pair = std::get_if<input::PadPair>(&contact_case.geometry)) {
    if (pair->load_at_m)
      throw InputError(pair->load_at_where, "load_at_mm", "",
                       "no such key for explore, whose load "
                       "acts in the middle of the pad");
    input::refuse_curved_pad(contact_case, "softfinger explore");
    return report::PadStart{name,
                            bearing_pair(contact_case),
                            contact_case.layer,
                            {exporting::choose_loads(contact_case.loads_N, {}).nominal_N,
                             contact_case.shear_law.friction_coefficient}};
  }
  input::require_coulomb(contact_case, "explore");
  if (!contact_case.sublayers.empty() || contact_case.object_layer.thickness_m > 0)
    throw InputError(contact_case.id, "layers", "several", "one homogeneous layer for explore");
  const prediction::GeometryResolver resolver(contact_case);
  for (const std::string& line : resolver.remarks()) remark(line);
  const double load_N = exporting::choose_loads(contact_case.loads_N, {}).nominal_N;
  return report::ExplorerStart{
      name, prediction::contact_problem(contact_case, resolver.resolve(load_N), load_N)};
}

std::string torque_in_words(const std::string& name, double load_N, double torque_Nm,
                            const ModelCard& card) {
  return fmt::format("{}, {:g} N: torque {:.3g} mN·m by {}", name, load_N, 1e3 * torque_Nm,
                     card.name);
}

std::string no_answer(const std::string& name, double load_N) {
  return fmt::format("{}, {:g} N: no model has an answer", name, load_N);
}

/// The torque of the contact from which the page starts, by the recommended model.
std::string answer_in_words(const report::ExplorerStart& start) {
  const PressureModel& model = default_model(start.problem);
  const Prediction answer = model.predict(start.problem);
  const ContactLoad& load = start.problem.load;
  if (!answer.has_answer) return no_answer(start.case_name, load.normal_force_N);
  return torque_in_words(
      start.case_name, load.normal_force_N,
      load.friction_coefficient * load.normal_force_N * answer.torque_arm_exact_m, model.card());
}

std::string answer_in_words(const report::PadStart& start) {
  const PadModel& model = *all_pad_models().front();
  const PadShape shape(start.pair.contact);
  const PadPrediction answer =
      model.predict({&shape, start.layer, start.load, start.pair.pressing, {}, {}});
  const ContactLoad& load = start.load;
  if (!answer.has_answer) return no_answer(start.case_name, load.normal_force_N);
  return torque_in_words(start.case_name, load.normal_force_N,
                         load.friction_coefficient * load.normal_force_N * answer.eccentricity_m,
                         model.card());
}

std::string answer_in_words(std::monostate) {
  return "sliders for any contact, from the models themselves";
}

int run_explore(const ExploreOptions& options) {
  const std::string& output = options.output;
  if (output.empty())
    throw InputError("command line", "--output", "\"\"", "the name of an HTML file");
  if (!report::has_explorer())
    throw InputError("explore",
                     "the page's script is not built: " + report::how_to_build_explorer(), "", "");
  const Start start = start_of(options.typed_case);
  system::write_file_atomically(
      output, report::explorer_page("softfinger " + system::program_version(), options.command_line,
                                    start));
  if (options.json) {
    nlohmann::json models = nlohmann::json::array();
    for (const PressureModel* model : explorer::models()) models.push_back(model->card().name);
    for (const PadModel* model : all_pad_models()) models.push_back(model->card().name);
    const nlohmann::json object = {{"page", output}, {"models", models}};
    system::write_to_stdout(text::printed(object));
  } else {
    system::write_text_to_stdout(fmt::format(
        "{}\nPage: {}\n", std::visit([](const auto& from) { return answer_in_words(from); }, start),
        output));
  }
  return 0;
}

}  // namespace

void add_explore(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<ExploreOptions>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand("explore",
                                         "A page with sliders for a contact: ellipse, pressure, "
                                         "limit surface, error bounds, lines for "
                                         "simulators, at once");
  add_case(*command, options->typed_case, true, input::FlatPads::taken);
  command->add_option("-o,--output", options->output, "HTML file to write; default: explore.html");
  command->add_flag("--json", options->json,
                    "one JSON object on standard output: the page's file, the models in it");
  command->footer(
      "With a case the page starts from its contact, at the middle one of its loads: a curved\n"
      "fingertip, or a flat pad.\n"
      "The page needs no network: the models run in the browser, compiled to WebAssembly. The\n"
      "contact stands in the page's address, behind #, so that a link repeats it.\n"
      "Samples:\n"
      "  softfinger explore\n"
      "  softfinger explore silicone_pad_2mm --output fingertip.html\n"
      "  softfinger explore robotiq_like_pad --output pad.html");
  command->callback([options, &action] { action = [options] { return run_explore(*options); }; });
}

}  // namespace softfinger::commands
