#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "comparisons/sweep/rows_file.h"
#include "comparisons/sweep/sweep_file.h"
#include "comparisons/sweep/sweep_rows.h"

namespace softfinger::sweep {

/// A sweep and all that follows from its file. Each process that works on a sweep makes the same
/// plan.
struct SweepPlan {
  /// @throws InputError
  SweepPlan(const std::string& text, const std::filesystem::path& file,
            const std::filesystem::path& output, const reference::FemLimits& limits,
            const input::Settings& settings = {}, const prediction::Demand& demand = {});

  /// Makes rows; one for each thread.
  SweepRows rows() const { return SweepRows(sweep, *contact); }

  std::filesystem::path file, output;
  Sweep sweep;
  prediction::Demand demand;  ///< decides the columns `..._usable`
  std::unique_ptr<const SweptContact> contact;
  SweepFemJobs fem;  ///< empty without finite elements
};

/// Does the work of a sweep: by threads and processes of this machine, or by the ranks of an MPI
/// run.
class SweepWorkers {
 public:
  virtual ~SweepWorkers() = default;

  /// Number of jobs that run side by side.
  virtual int parallel() const = 0;

  /// Runs finite-element jobs of curved bodies and writes each result to the job's file.
  /// @param on_finished  called on the calling thread with the job, the reason of a failure (else
  /// empty) and a line about its accuracy
  /// @returns 0, or the signal that interrupted
  virtual int run_fem(const std::vector<const reference::FemJob*>& jobs,
                      const reference::FemJobOptions& settings,
                      const std::function<void(const reference::FemJob&, const std::string& failure,
                                               const std::string& summary)>& on_finished) = 0;

  /// Computes the rows that `file` does not have yet, for a sweep without finite elements.
  /// @param on_progress  after each append
  /// @returns 0, or the signal that interrupted
  virtual int make_rows(const SweepPlan& plan, RowsFile& file,
                        const std::function<void()>& on_progress) = 0;
};

/// Runs on this machine: finite elements in processes, rows in threads.
class LocalWorkers : public SweepWorkers {
 public:
  explicit LocalWorkers(int parallel) : parallel_(parallel) {}
  int parallel() const override { return parallel_; }
  int run_fem(const std::vector<const reference::FemJob*>& jobs,
              const reference::FemJobOptions& settings,
              const std::function<void(const reference::FemJob&, const std::string& failure,
                                       const std::string& summary)>& on_finished) override;
  int make_rows(const SweepPlan& plan, RowsFile& file,
                const std::function<void()>& on_progress) override;

 private:
  int parallel_;
};

/// Computes what is missing in the folder and writes results.csv, sweep.json and sweep.html there.
/// @param command  as typed, for the page
/// @param json     the answer on standard output as one JSON object
/// @returns the exit status: 0, 1 when finite elements failed somewhere, 128 + signal
/// @throws InputError
int run_sweep(const SweepPlan& plan, SweepWorkers& workers, const std::string& command,
              bool json = false);

}  // namespace softfinger::sweep
