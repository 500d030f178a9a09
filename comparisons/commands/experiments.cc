#include <algorithm>
#include <filesystem>
#include <memory>

#include "comparisons/commands/commands.h"
#include "comparisons/experiments/experiments_report.h"
#include "comparisons/report/experiments_page.h"
#include "comparisons/system/clock.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

struct ExperimentsOptions {
  std::vector<std::string> sets;
  std::string page, command_line;
  bool json = false, write_page = false;
};

int run_experiments(const ExperimentsOptions& options) {
  if (options.write_page && options.page.empty())
    throw InputError("command line", "--page", "\"\"", "the name of a file");
  std::vector<experiments::Examined> examined;
  for (const std::string& typed : options.sets)
    examined.push_back(
        experiments::examine(experiments::read_experiment(system::find_experiment_file(typed))));
  if (options.sets.empty()) examined = experiments::examine_builtin();
  if (examined.empty()) throw InputError("softfinger experiments", "data sets", "none", "");
  const nlohmann::json result = to_json(examined);
  if (options.write_page) {
    nlohmann::json shown = result;
    shown["provenance"] = {{"version", system::program_version()},
                           {"date", system::utc_now()},
                           {"command", options.command_line}};
    system::write_file_atomically(options.page, report::render_experiments(shown));
    remark("the page is " + options.page);
  }
  if (options.json)
    system::write_to_stdout(text::printed(result));
  else
    system::write_text_to_stdout(table(examined));
  return std::any_of(examined.begin(), examined.end(),
                     [](const experiments::Examined& one) {
                       return one.verdict == experiments::Verdict::fails;
                     })
             ? 1
             : 0;
}

}  // namespace

void add_experiments(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<ExperimentsOptions>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand(
      "experiments", "The theory against published measurements of soft fingertips");
  command->add_option("SETS", options->sets,
                      "data sets (TOML), or names of built-in ones; default: all built-in ones");
  const CLI::Option* page = command->add_option(
      "--page", options->page, "also write a page, one HTML file; default: none is written");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "Verdicts: agrees, fails, cannot tell; each with its numbers and their uncertainty. Exit\n"
      "status 1 when the theory fails at a data set, which is so for some of the built-in ones:\n"
      "it is shown, not fitted away.\n"
      "A data set of your own is one file with id, what, source, certainty, unknown and one "
      "table:\n"
      "  [growth] laws = [{ coefficient_mm, exponent }]   contact radius a = c P^gamma, P in N\n"
      "  [indentation]   a sphere pressed into a flat layer\n"
      "  [hardness]      Shore \"A\" or \"00\" beside a modulus\n"
      "  [repeated]      e_n by the two fingers of a gripper\n"
      "  [observation]   a number that a publication states in words\n"
      "  [press_curves]  force over travel of fingertips on a plane, down and up\n"
      "  [tension]       measured silicones and their hardness\n"
      "  [bonded_disc]   a disc between two plates, drawn apart\n"
      "The built-in files in share/softfinger/experiments show all keys.\n"
      "Samples:\n"
      "  softfinger experiments gelsight_golf_ball\n"
      "  softfinger experiments xydas_kao_1999 waltersson_2024_in_hand --json");
  command->callback([options, page, &action] {
    options->write_page = page->count() > 0;
    action = [options] { return run_experiments(*options); };
  });
}

}  // namespace softfinger::commands
