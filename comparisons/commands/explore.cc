#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "comparisons/commands/case_input.h"
#include "comparisons/commands/commands.h"
#include "comparisons/explorer/explorer.h"
#include "comparisons/exporting/contact_curve.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/report/explorer_page.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "softfinger/accuracy/default_model.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

struct ExploreOptions {
  CaseInput typed_case;
  std::string output = "explore.html", command_line;
  bool json = false;
};

/// The contact of a case at its middle load.
/// @throws InputError for what the page does not know
std::optional<report::ExplorerStart> start_of(const CaseInput& typed) {
  const bool is_typed = !typed.file.empty() || !typed.radii_mm.empty();
  if (!is_typed) return std::nullopt;
  const input::Case contact_case = read_case(typed);
  input::require_coulomb(contact_case, "explore");
  if (!contact_case.sublayers.empty() || contact_case.object_layer.thickness_m > 0)
    throw InputError(contact_case.id, "layers", "several", "one homogeneous layer for explore");
  const prediction::GeometryResolver resolver(contact_case);
  for (const std::string& line : resolver.remarks()) remark(line);
  const double load_N = exporting::choose_loads(contact_case.loads_N, {}).nominal_N;
  return report::ExplorerStart{
      typed.file.empty() ? "command line" : typed.file,
      prediction::contact_problem(contact_case, resolver.resolve(load_N), load_N)};
}

/// The torque of the contact from which the page starts, by the recommended model.
std::string answer_in_words(const report::ExplorerStart& start) {
  const PressureModel& model = default_model(start.problem);
  const Prediction answer = model.predict(start.problem);
  const double load_N = start.problem.load.normal_force_N;
  if (!answer.has_answer)
    return fmt::format("{}, {:g} N: no model has an answer", start.case_name, load_N);
  return fmt::format(
      "{}, {:g} N: torque {:.3g} mN·m by {}", start.case_name, load_N,
      1e3 * start.problem.load.friction_coefficient * load_N * answer.torque_arm_exact_m,
      model.card().name);
}

int run_explore(const ExploreOptions& options) {
  const std::string& output = options.output;
  if (output.empty())
    throw InputError("command line", "--output", "\"\"", "the name of an HTML file");
  if (!report::has_explorer())
    throw InputError("explore",
                     fmt::format("this program was built without a compiler for WebAssembly, which "
                                 "makes the page; install it and build again (Debian: {})",
                                 report::kExplorerPackages),
                     "", "");
  const std::optional<report::ExplorerStart> start = start_of(options.typed_case);
  system::write_file_atomically(
      output, report::explorer_page("softfinger " + system::program_version(), options.command_line,
                                    start));
  if (options.json) {
    nlohmann::json models = nlohmann::json::array();
    for (const PressureModel* model : explorer::models()) models.push_back(model->card().name);
    const nlohmann::json object = {{"page", output}, {"models", models}};
    system::write_to_stdout(text::printed(object));
  } else {
    system::write_text_to_stdout(fmt::format(
        "{}\nPage: {}\n",
        start ? answer_in_words(*start) : "sliders for any contact, from the models themselves",
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
  add_case(*command, options->typed_case);
  command->add_option("-o,--output", options->output, "HTML file to write; default: explore.html");
  command->add_flag("--json", options->json,
                    "one JSON object on standard output: the page's file, the models in it");
  command->footer(
      "With a case the page starts from its contact, at the middle one of its loads.\n"
      "The page needs no network: the models run in the browser, compiled to WebAssembly. The\n"
      "contact stands in the page's address, behind #, so that a link repeats it.\n"
      "Samples:\n"
      "  softfinger explore\n"
      "  softfinger explore silicone_pad_2mm --output fingertip.html");
  command->callback([options, &action] { action = [options] { return run_explore(*options); }; });
}

}  // namespace softfinger::commands
