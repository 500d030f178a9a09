#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "comparisons/reference/fem_process.h"

/// One file per command: its flags, its help with samples that a test runs, and what it does.
namespace softfinger::commands {

/// Work of the typed command; returns the exit status.
using Action = std::function<int()>;

void add_predict(CLI::App& app, Action& action, const std::string& command_line);
void add_fit(CLI::App& app, Action& action, const std::string& command_line);
void add_fem(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action, const std::string& command_line);
void add_atlas(CLI::App& app, Action& action, const std::string& command_line);
void add_select(CLI::App& app, Action& action, const std::string& command_line);
void add_experiments(CLI::App& app, Action& action, const std::string& command_line);
void add_export(CLI::App& app, Action& action);
void add_explore(CLI::App& app, Action& action, const std::string& command_line);
void add_apply(CLI::App& app, Action& action);
void add_lint(CLI::App& app, Action& action);
void add_list(CLI::App& app, Action& action);
void add_explain(CLI::App& app, Action& action);
void add_lcp(CLI::App& app, Action& action);
void add_sweep(CLI::App& app, Action& action, const std::string& command_line);
void add_calibrate(CLI::App& app, Action& action, const std::string& command_line);
void add_area(CLI::App& app, Action& action);
void add_simulate(CLI::App& app, Action& action, const std::string& command_line);
void add_mesh(CLI::App& app, Action& action, const std::string& command_line);
void add_init(CLI::App& app, Action& action);
void add_doctor(CLI::App& app, Action& action);
/// These two describe all commands that `app` has when they run.
void add_completion(CLI::App& app, Action& action);
void add_manual(CLI::App& app, Action& action);

/// --fem-time-s and --fem-memory-MB, of each finite-element problem.
void add_fem_limits(CLI::App& command, reference::FemLimits& limits);

/// Names the files that the options of the typed command write, before it reads any: none may be an
/// input.
/// @throws InputError
void announce_outputs(const CLI::App& app);

/// Refuses to run under mpirun, where each rank would do all the work in the same folder.
/// @param in_place  what to type instead
/// @throws InputError
void require_single_process(const std::string& in_place);

/// Prints a message that is not a result: one line on standard error.
void remark(const std::string& line);

}  // namespace softfinger::commands
