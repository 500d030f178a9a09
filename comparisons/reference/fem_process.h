#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/reference/fem_problem.h"
#include "comparisons/reference/reference_result.h"
#include "comparisons/system/process_pool.h"

/// The finite-element program as seen from here: a process that takes problems and gives a result
/// for each, all JSON (fem/README.md).
namespace softfinger::reference {

/// Limits of each problem. The defaults are far above what any contact of the suite needs.
struct FemLimits {
  double time_s = 3600;
  double memory_MB = 8192;
};

/// Solved by one process, one after the other, which lets contacts share meshes: the largest first.
struct FemBatch {
  std::vector<FemProblem> problems;
  bool single_thread = true;  ///< with several processes side by side
  FemLimits limits;
};

/// A result, or in one line why there is none.
struct FemAnswer {
  std::optional<ReferenceResult> result;
  std::string failure;
  int exit_status = 0;  ///< 0, 2 bad input, 3 no convergence or a crash
};

/// Index of a batch, and of a problem in it.
struct FemIndex {
  std::size_t batch = 0, problem = 0;
};

struct FemCallbacks {
  /// Called with each line of a process about its progress.
  std::function<void(FemIndex, const std::string& line)> on_line = [](auto, const auto&) {};
  /// Called as each answer comes. May throw: all processes are then stopped and the exception goes
  /// on.
  std::function<void(FemIndex, FemAnswer)> on_answer = [](auto, auto&&) {};
};

/// Solves the batches, at most `parallel` side by side. A problem that fails, crashes its process
/// or goes beyond its limits leaves the rest of its batch to be solved.
/// @returns 0, or the signal that interrupted
/// @throws InputError when the program cannot be started
int run_fem(const std::string& program, const std::vector<FemBatch>& batches, int parallel,
            const FemCallbacks& callbacks,
            system::OnInterrupt on_interrupt = system::OnInterrupt::stop);

/// The process that takes an array of problems, one line each as the answer.
system::ProcessJob fem_job(const std::string& program, const nlohmann::json& problems,
                           bool single_thread, const FemLimits& limits);
/// The error of the problem that a process was at when it ended before its time.
FemAnswer failure_of(const system::ProcessOutcome& outcome, const FemLimits& limits);
/// The error that a process wrote in place of a result, under the key "failure".
FemAnswer failure_of(const nlohmann::json& written);
/// A line of progress such as "fem: 2/3: text", which is about the second of three problems.
/// @param problem  index of the first problem of the process; becomes that of the line's own
/// @returns the text
std::string text_of(const std::string& line, std::size_t& problem);

/// "seed_thumb_5N": the name of the folder of a result.
std::string load_folder(const std::string& case_id, double load_N);

}  // namespace softfinger::reference
