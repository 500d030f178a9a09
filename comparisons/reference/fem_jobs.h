#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/reference/fem_process.h"
#include "comparisons/reference/finished_results.h"
#include "comparisons/system/progress.h"
#include "comparisons/system/remaining_time.h"

/// Many finite-element problems whose results are kept in files, so that the same command continues
/// after an interruption. Used by `compare`, `atlas` and `sweep`.
namespace softfinger::reference {

struct FemJob {
  std::string title;                       ///< for messages
  FemProblem problem;                      ///< without an output directory
  std::filesystem::path file;              ///< where the finished result is kept
  std::filesystem::path output_directory;  ///< for VTU files; empty: none are written
  /// Rough share of the time. The longest jobs run first, so that the last to finish is a short
  /// one.
  double weight = 0;
  /// Jobs of one group that follow each other share a process, and with it meshes.
  std::size_t group = 0;
};

struct FemJobOptions {
  std::string program;   ///< path of softfinger-fem
  std::string identity;  ///< its `program_identity`
  int parallel = 1;
  bool single_thread = true;  ///< each process: with several side by side
  FemLimits limits;
};

/// The finished result of a job, if there is one. One with VTU files counts only while they exist.
FinishedResult finished_result(const FemJob& job, const FemJobOptions& options);

/// The jobs that are still to be run, the longest first. Reports how many are finished, and which
/// files cannot be used.
std::vector<const FemJob*> pending_fem_jobs(
    const std::vector<FemJob>& jobs, const FemJobOptions& options, system::Progress& progress,
    const std::function<void(const FemJob&, ReferenceResult result)>& on_reused);

/// Roughly how long the finite elements take on one core of a usual machine, from the kind of the
/// problem: right within a factor of two or so. Only for telling how much time is left.
double expected_s(const FemProblem& problem);

/// Solves one job after the other or side by side and keeps each result as it comes.
/// @param on_line      what a process says about its progress
/// @param on_finished  after each job; its result is in its file by then
/// @returns 0, or the signal that interrupted
/// @throws InputError when the program cannot be started or a result cannot be written
int run_fem_jobs(const std::vector<const FemJob*>& jobs, const FemJobOptions& options,
                 const std::function<void(const FemJob&, const std::string& line)>& on_line,
                 const std::function<void(const FemJob&, const FemAnswer&)>& on_finished);

/// Says how far a set of jobs is: "[3/12] title: 1.2 s; about 40 s left".
class FemJobProgress {
 public:
  /// @param all       number of jobs, of which `pending` are to be run
  /// @param parallel  how many run side by side
  FemJobProgress(system::Progress& progress, std::size_t all,
                 const std::vector<const FemJob*>& pending, int parallel);

  void line(const FemJob& job, const std::string& text);
  /// @param outcome  how accurate the result is, or why there is none
  void finished(const FemJob& job, const std::string& outcome);

 private:
  std::string remaining() const;
  double elapsed_s() const;
  std::optional<double> took_s(const FemJob& job, double now_s);

  system::Progress& progress_;
  std::size_t all_, pending_, finished_ = 0;
  system::RemainingTime left_;
  /// Jobs that share a process run one after the other.
  struct Batch {
    std::size_t left = 0;
    double began_s = 0;  ///< its present job
  };
  std::map<const FemJob*, std::size_t> batch_of_;
  std::vector<Batch> batches_;
  std::size_t begun_;  ///< the first so many batches have begun
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// "1234 unknowns, a ±0.1 %, torque ±0.2 %, 1.2 s", or "FEM failed: ...".
std::string describe(const FemAnswer& answer);

}  // namespace softfinger::reference
