#include <memory>

#include "comparisons/commands/case_input.h"
#include "comparisons/commands/commands.h"
#include "comparisons/commands/demand_input.h"
#include "comparisons/suite/compare.h"
#include "comparisons/sweep/run_sweep.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"

namespace softfinger::commands {

void add_sweep(CLI::App& app, Action& action, const std::string& command_line) {
  struct Options {
    std::string file, output = "softfinger-sweep";
    std::vector<std::string> settings;
    int jobs = suite::default_job_count();
    bool json = false;
    DemandInput demand;
    reference::FemLimits fem_limits;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "sweep", "A case over many values of its numbers: one row per point and load, and a page");
  command
      ->add_option("SWEEP", options->file,
                   "case file (TOML) with a table [sweep], the name of a built-in sweep, or \"-\" "
                   "for standard input")
      ->required();
  add_settings(*command, options->settings, "sweep");
  command->add_option("-o,--output", options->output,
                      "folder for results.csv and sweep.html, created when missing; default: "
                      "./softfinger-sweep");
  command
      ->add_option("--jobs", options->jobs,
                   "threads, and finite-element processes side by side, 1 to 64; default: the "
                   "cores, at most 8")
      ->check(CLI::Range(1, 64));
  command->add_flag("--json", options->json,
                    "number of rows and paths as one JSON object on standard output");
  add_demand(*command, options->demand);
  add_fem_limits(*command, options->fem_limits);
  command->footer(
      "[sweep] names numbers of the case and their values; several keys make the product:\n"
      "  \"layer.poisson_ratio\" = [0.3, 0.45, 0.49]\n"
      "  \"layer.thickness_mm\" = { from = 0.5, to = 5, steps = 10, spacing = \"log\" }\n"
      "  \"geometry.relative_radii_mm[0]\" = { from = 5, to = 50, random = 100, seed = 7 }\n"
      "  zip = [[\"layer.thickness_mm\", \"layer.poisson_ratio\"]]   these change together\n"
      "  models = [\"bonded_layer\"]    default: all that take microseconds\n"
      "  fem = true                   also finite elements\n"
      "At most 1e8 rows, 1e5 with finite elements. The same command goes on after an "
      "interruption.\n"
      "On many machines: mpirun -np 64 softfinger-sweep SWEEP.toml --output DIR\n"
      "Samples:\n"
      "  softfinger sweep thickness_and_load --output thickness_sweep");
  command->callback([options, command_line, &action] {
    action = [options, command_line] {
      require_single_process("softfinger-sweep SWEEP.toml --output DIR");
      const auto file = system::find_sweep_file(options->file);
      const sweep::SweepPlan plan(sweep::read_sweep_text(file), input::name_of_typed(file),
                                  options->output, options->fem_limits,
                                  settings_of(options->settings), options->demand.demand());
      sweep::LocalWorkers workers(options->jobs);
      return sweep::run_sweep(plan, workers, command_line, options->json);
    };
  });
}

}  // namespace softfinger::commands
