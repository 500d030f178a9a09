#include "comparisons/suite/compare.h"

#include <memory>

#include "comparisons/commands/case_input.h"
#include "comparisons/commands/commands.h"
#include "comparisons/system/program_paths.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {

void add_compare(CLI::App& app, Action& action, const std::string& command_line) {
  struct Options {
    std::vector<std::string> cases, settings;
    std::string output = "softfinger-report";
    int jobs = suite::default_job_count();
    bool full = false, quick = false, json = false;
    reference::Idealisations idealisations;
    reference::FemLimits fem_limits;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "compare", "Models against finite elements: report.html, report.json, results.csv, VTU");
  command->add_option(
      "CASES", options->cases,
      "case files (TOML), names of built-in cases, or \"-\" for standard input; default: the whole "
      "built-in suite");
  add_settings(*command, options->settings, "cases");
  command->add_option("-o,--output", options->output,
                      "folder for the report, created when missing; default: ./softfinger-report");
  CLI::Option* full = command->add_flag(
      "--full", options->full,
      "one finite-element level finer, more accurate: minutes instead of seconds for a load");
  command
      ->add_flag("--quick", options->quick,
                 "the reference alone, without what each idealisation between it and the models "
                 "costs: half the time")
      ->excludes(full);
  command->add_flag("--linear", options->idealisations.linear,
                    "finite elements of linear elasticity; default: finite strain where it changes "
                    "a number by more than their stated error");
  command->add_flag("--flat", options->idealisations.flat,
                    "finite elements on a flat layer; default: on the finger itself, where a case "
                    "has one");
  command
      ->add_option(
          "--jobs", options->jobs,
          "finite-element processes side by side, 1 to 64, up to 2 GB each; default: the cores, "
          "at most 8")
      ->check(CLI::Range(1, 64));
  command->add_flag("--json", options->json,
                    "verdicts and paths as one JSON object on standard output; all numbers are in "
                    "report.json");
  add_fem_limits(*command, options->fem_limits);
  command->footer(
      "A case's [fem] geometry and kinematics come before all of these.\n"
      "A reference that states a larger error than its limits is solved once more, one level "
      "finer.\n"
      "Finished results are kept: the same command continues after an interruption.\n"
      "A flat pad is compared with finite elements of the whole pad, in linear theory.\n"
      "The program softfinger-fem is looked for beside this one, or in SOFTFINGER_FEM_PROGRAM.\n"
      "Samples:\n"
      "  softfinger compare hertz_circle --output hertz_report\n"
      "  softfinger compare seed_thumb seed_ring_finger --output seed_report --jobs 2\n"
      "  softfinger compare robotiq_like_pad --output pad_report");
  command->callback([options, command_line, &action] {
    action = [options, command_line] {
      require_single_process("softfinger-sweep with fem = true");
      suite::CompareOptions compare_options;
      for (const std::string& typed : options->cases)
        compare_options.case_files.push_back(system::find_case_file(typed));
      if (options->cases.empty()) compare_options.case_files = system::builtin_case_files();
      if (compare_options.case_files.empty())
        throw InputError((system::share_folder() / "cases").string(), "no built-in cases are there",
                         "", "");
      if (options->output.empty())
        throw InputError("command line", "--output", "\"\"", "the name of a folder");
      compare_options.settings = settings_of(options->settings);
      compare_options.json = options->json;
      compare_options.output = options->output;
      compare_options.full = options->full;
      compare_options.quick = options->quick;
      compare_options.idealisations = options->idealisations;
      compare_options.jobs = options->jobs;
      compare_options.fem_limits = options->fem_limits;
      compare_options.command = command_line;
      return suite::compare(compare_options);
    };
  });
}

}  // namespace softfinger::commands
