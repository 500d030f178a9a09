#include <filesystem>
#include <memory>
#include <optional>

#include "comparisons/commands/commands.h"
#include "comparisons/extremes/survey.h"
#include "comparisons/report/extremes_page.h"
#include "comparisons/system/clock.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

struct ExtremesOptions {
  extremes::SurveyOptions survey;
  std::string output, command_line;
  bool json = false, write_page = false;
};

int run_extremes(const ExtremesOptions& options) {
  if (options.write_page && options.output.empty())
    throw InputError("command line", "--output", "\"\"", "the name of a folder");
  std::optional<system::OutputFolder> output;
  if (options.write_page) output.emplace(options.output);
  nlohmann::json report = extremes::survey(options.survey);
  report["provenance"] = {{"version", system::program_version()},
                          {"date", system::utc_now()},
                          {"command", options.command_line}};
  // A command line may contain bytes that are not UTF-8.
  const std::string text = text::printed(report);
  if (options.write_page) {
    const std::filesystem::path folder = options.output;
    system::write_files_together({{folder / "extremes.json", text},
                                  {folder / "extremes.html", report::render_extremes(report)}});
    remark("the page is " + (folder / "extremes.html").string());
  }
  if (options.json)
    system::write_to_stdout(text);
  else
    system::write_text_to_stdout(extremes::table(report));
  return extremes::all_invariants_hold(report) ? 0 : 1;
}

}  // namespace

void add_extremes(CLI::App& app, Action& action, const std::string& command_line) {
  auto options = std::make_shared<ExtremesOptions>();
  options->command_line = command_line;
  CLI::App* command = app.add_subcommand(
      "extremes",
      "All models on random problems far beyond any fingertip: answers, refusals, violated "
      "invariants");
  const CLI::Option* output =
      command->add_option("-o,--output", options->output,
                          "folder for a page of the results, extremes.html, and "
                          "extremes.json; default: none is written");
  command
      ->add_option("--points", options->survey.points,
                   "problems for every model that takes microseconds, 100 to 10000000; default: "
                   "20000")
      ->check(CLI::Range(100, 10000000));
  command
      ->add_option("--slow-points", options->survey.slow_points,
                   "problems for every other model, 1 to 100000; default: 120")
      ->check(CLI::Range(1, 100000));
  command->add_option("--seed", options->survey.seed,
                      "of the random problems, 0 to 4294967295: the same seed, the same problems");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "Invariants: every number is finite, and positive in an answer; a refusal gives a reason;\n"
      "more load gives a larger contact and torque; units do not change the answer;\n"
      "the friction limit is finite; no jumps between series, asymptotes and tables. Exit status 1 "
      "when a model violates one.\n"
      "Samples:\n"
      "  softfinger extremes --points 2000 --slow-points 4\n"
      "  softfinger extremes --points 1000 --slow-points 2 --output extremes_report --json");
  command->callback([options, output, &action] {
    options->write_page = output->count() > 0;
    action = [options] { return run_extremes(*options); };
  });
}

}  // namespace softfinger::commands
