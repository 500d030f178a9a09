#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "comparisons/commands/commands.h"
#include "comparisons/explorer/explorer.h"
#include "comparisons/report/explorer_page.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

int run_explore(const std::string& output, bool as_json, const std::string& command_line) {
  if (output.empty())
    throw InputError("command line", "--output", "\"\"", "the name of an HTML file");
  if (!report::has_explorer())
    throw InputError("explore",
                     fmt::format("this program was built without a compiler for WebAssembly, which "
                                 "makes the page; install it and build again (Debian: {})",
                                 report::kExplorerPackages),
                     "", "");
  system::write_file_atomically(
      output, report::explorer_page("softfinger " + system::program_version(), command_line));
  remark("the page is " + output);
  if (as_json) {
    nlohmann::json models = nlohmann::json::array();
    for (const PressureModel* model : explorer::models()) models.push_back(model->card().name);
    const nlohmann::json object = {{"page", output}, {"models", models}};
    system::write_to_stdout(object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
                            "\n");
  }
  return 0;
}

}  // namespace

void add_explore(CLI::App& app, Action& action, const std::string& command_line) {
  auto output = std::make_shared<std::string>("explore.html");
  CLI::App* command = app.add_subcommand("explore",
                                         "A page with sliders for a contact: ellipse, pressure, "
                                         "limit surface, error bounds, lines for "
                                         "simulators, at once");
  command->add_option("-o,--output", *output, "HTML file to write; default: explore.html");
  auto json = std::make_shared<bool>(false);
  command->add_flag("--json", *json,
                    "one JSON object on standard output: the page's file, the models in it");
  command->footer(
      "The page needs no network: the models run in the browser, compiled to WebAssembly. The\n"
      "contact stands in the page's address, behind #, so that a link repeats it.\n"
      "Samples:\n"
      "  softfinger explore\n"
      "  softfinger explore --output fingertip.html");
  command->callback([output, json, command_line, &action] {
    action = [output, json, command_line] { return run_explore(*output, *json, command_line); };
  });
}

}  // namespace softfinger::commands
