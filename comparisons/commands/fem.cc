#include <fmt/format.h>

#include <memory>

#include "comparisons/commands/commands.h"
#include "comparisons/fem_process.h"
#include "comparisons/files.h"
#include "comparisons/predict.h"
#include "comparisons/program_paths.h"
#include "comparisons/progress.h"

namespace softfinger::commands {
namespace {

struct Options {
  std::string case_file, output;
  int level = 0;
  bool json = false;
};

std::string table_row(const nlohmann::json& result) {
  const auto number = [&](const char* key) { return result.at(key).get<double>(); };
  const auto error = [&](const char* key) {
    const auto& value = result["error"].value(key, nlohmann::json());
    return value.is_number() ? fmt::format("± {:.2g} %", 100 * value.get<double>()) : "";
  };
  const auto& unknowns = result.value("unknowns", nlohmann::json());
  const auto& wall_s = result.value("wall_s", nlohmann::json());
  return fmt::format(
             "  a           {:>10.5g} mm    {}\n"
             "  b           {:>10.5g} mm    {}\n"
             "  indentation {:>10.5g} mm    {}\n"
             "  peak        {:>10.5g} kPa   {}\n"
             "  area        {:>10.5g} mm²   {}\n"
             "  torque      {:>10.5g} mN·m  {}\n",
             number("a_m") * 1e3, error("a"), number("b_m") * 1e3, error("b"),
             number("indentation_m") * 1e3, error("indentation"), number("peak_pressure_Pa") * 1e-3,
             error("peak_pressure"), number("area_m2") * 1e6, error("area"),
             number("max_torque_Nm") * 1e3, error("max_torque")) +
         fmt::format("  {} unknowns, {:.3g} s\n", unknowns.is_number() ? unknowns.dump() : "?",
                     wall_s.is_number() ? wall_s.get<double>() : 0);
}

int run(const Options& options) {
  const Case contact_case = read_case(find_case_file(options.case_file));
  const GeometryResolver resolver(contact_case);
  for (const std::string& line : resolver.remarks()) remark(line);
  const std::string program = fem_program().string();
  const int level = options.level > 0 ? options.level : contact_case.fem_level;

  std::vector<LocalGeometry> geometries;
  for (double load_N : contact_case.loads_N) geometries.push_back(resolver.resolve(load_N));
  std::vector<ProcessJob> jobs;
  for (std::size_t i = 0; i < geometries.size(); ++i) {
    const double load_N = contact_case.loads_N[i];
    std::string folder;
    if (!options.output.empty()) {
      folder =
          (std::filesystem::path(options.output) / load_folder(contact_case.id, load_N)).string();
      make_writable_folder(folder);
    }
    jobs.push_back(
        fem_job(program, fem_problem(contact_case, geometries[i], load_N, level), folder, false));
  }

  Progress progress;
  std::string
      held;  // the last line may be the reason of a failure, which is said once, as an error
  const auto title = [&](std::size_t job) {
    return fmt::format("{} {} N: ", contact_case.id, contact_case.loads_N[job]);
  };
  nlohmann::json results = nlohmann::json::array();
  std::string text = describe(contact_case) + "\n";
  FemAnswer failure;
  ProcessCallbacks callbacks;
  callbacks.on_line = [&](std::size_t job, const std::string& line) {
    if (!held.empty()) progress.say(held);
    held = title(job) + line;
    progress.show(held);
  };
  callbacks.on_finish = [&](std::size_t job, const ProcessOutcome& outcome) {
    FemAnswer answer = interpret_fem(outcome);
    if (answer.result.is_null()) {
      answer.failure = title(job) + answer.failure;
      failure = answer;
      held.clear();
      return;
    }
    if (!held.empty()) progress.say(held);
    held.clear();
    answer.result["load_N"] = contact_case.loads_N[job];
    answer.result["model"] = "fem";
    // The keys that `predict` has, so that one reader serves both.
    answer.result["torque_rule"] = "exact";
    answer.result["valid"] = true;
    answer.result["validity"] = nlohmann::json::array();
    answer.result["error_estimate"] = answer.result["error"];
    answer.result["cost_ns"] = nullptr;
    if (const auto& wall_s = answer.result["wall_s"]; wall_s.is_number())
      answer.result["cost_ns"] = 1e9 * wall_s.get<double>();
    text += fmt::format("\n{:g} N: {}\n", contact_case.loads_N[job], describe(geometries[job])) +
            table_row(answer.result);
    results.push_back(std::move(answer.result));
  };
  for (std::size_t job = 0; job < jobs.size(); ++job) {
    // One after the other: a single solve uses all cores, and a failure ends the rest.
    ProcessCallbacks one = callbacks;
    one.on_line = [&, job](std::size_t, const std::string& line) { callbacks.on_line(job, line); };
    one.on_finish = [&, job](std::size_t, const ProcessOutcome& outcome) {
      callbacks.on_finish(job, outcome);
    };
    if (const int signal = run_processes({jobs[job]}, 1, one)) {
      progress.say("softfinger: interrupted");
      return 128 + signal;
    }
    if (failure.exit_status != 0) {
      progress.say("softfinger: error: " + failure.failure);
      return failure.exit_status;
    }
  }
  if (options.json)
    write_to_stdout(nlohmann::json({{"case", contact_case.id}, {"results", results}}).dump(2) +
                    "\n");
  else
    write_to_stdout(text);
  return 0;
}

}  // namespace

void add_fem(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "fem",
      "The finite-element reference with its own error estimate, per load; seconds to minutes");
  command
      ->add_option("CASE", options->case_file, "case file (TOML), or the name of a built-in case")
      ->required();
  command
      ->add_option("--level", options->level,
                   "refinement, 1 (coarse) to 3 (fine); default: the case's own, else 2")
      ->check(CLI::Range(1, 3));
  command->add_option("--output", options->output,
                      "folder for VTU files (ParaView), one sub-folder per load; default: none");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  command->footer(
      "The program softfinger-fem is looked for beside this one, or in SOFTFINGER_FEM_PROGRAM.\n"
      "Samples:\n"
      "  softfinger fem hertz_circle --level 1\n"
      "  softfinger fem hertz_circle --level 1 --output hertz_vtu --json");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace softfinger::commands
