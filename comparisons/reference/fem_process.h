#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/reference/fem_problem.h"
#include "comparisons/reference/reference_result.h"
#include "comparisons/system/process_pool.h"

/// The finite-element program as seen from here: a process that takes problems and gives a result
/// for each, all JSON (fem/README.md).
namespace softfinger::reference {

/// Exit status for numerics that failed, and for a program that wrote no sensible answer.
constexpr int kNotConverged = 3;

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

/// A batch as the process reads it, whatever its problems are of: fingers or pads.
struct FemDocuments {
  std::vector<nlohmann::json> problems;
  bool single_thread = true;
  FemLimits limits;
};

/// The process's answer as it wrote it, or in one line why there is none.
struct FemDocument {
  nlohmann::json document;
  std::string failure;
  int exit_status = 0;  ///< as in `FemAnswer`
};

struct FemDocumentCallbacks {
  std::function<void(FemIndex, const std::string& line)> on_line = [](auto, const auto&) {};
  std::function<void(FemIndex, FemDocument)> on_answer = [](auto, auto&&) {};
};

/// `run_fem` for documents, which nobody has read yet.
int run_fem_documents(const std::string& program, const std::vector<FemDocuments>& batches,
                      int parallel, const FemDocumentCallbacks& callbacks,
                      system::OnInterrupt on_interrupt = system::OnInterrupt::stop);

/// "seed_thumb_5N": the name of the folder of a result.
std::string load_folder(const std::string& case_id, double load_N);

}  // namespace softfinger::reference
