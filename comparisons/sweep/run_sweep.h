#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "comparisons/sweep/rows_file.h"
#include "comparisons/sweep/sweep_file.h"
#include "comparisons/sweep/sweep_rows.h"

namespace softfinger::sweep {

/// A sweep with all that follows from its file: every process that works on it makes the same one.
struct SweepPlan {
  /// @throws InputError
  SweepPlan(const std::string& text, const std::filesystem::path& file,
            const std::filesystem::path& output, const reference::FemLimits& limits);

  /// Makes rows; one for each thread.
  SweepRows rows() const { return SweepRows(sweep, models, geometry); }

  std::string text;
  std::filesystem::path file, output;
  Sweep sweep;
  std::vector<const PressureModel*> models;
  prediction::GeometryResolver geometry;
  SweepFemJobs fem;  ///< empty without finite elements
};

/// Those who do the work: threads and processes of this machine, or the ranks of an MPI run.
class SweepWorkers {
 public:
  virtual ~SweepWorkers() = default;

  /// Runs finite-element jobs, whose results are kept in their files.
  /// @param on_finished  on the calling thread: the job, why it failed (or nothing), its accuracy
  /// @returns 0, or the signal that interrupted
  virtual int run_fem(const std::vector<const reference::FemJob*>& jobs,
                      const reference::FemJobOptions& settings,
                      const std::function<void(const reference::FemJob&, const std::string& failure,
                                               const std::string& summary)>& on_finished) = 0;

  /// Makes the rows of all points that `file` has not yet, from models alone.
  /// @param on_progress  after each append
  /// @returns 0, or the signal that interrupted
  virtual int make_rows(const SweepPlan& plan, RowsFile& file,
                        const std::function<void()>& on_progress) = 0;
};

/// On this machine: finite elements as processes, rows by threads.
class LocalWorkers : public SweepWorkers {
 public:
  explicit LocalWorkers(int parallel) : parallel_(parallel) {}
  int run_fem(const std::vector<const reference::FemJob*>& jobs,
              const reference::FemJobOptions& settings,
              const std::function<void(const reference::FemJob&, const std::string& failure,
                                       const std::string& summary)>& on_finished) override;
  int make_rows(const SweepPlan& plan, RowsFile& file,
                const std::function<void()>& on_progress) override;

 private:
  int parallel_;
};

/// Does what is not done yet and writes results.csv, sweep.json and sweep.html into the folder.
/// @param command  as typed, for the page
/// @returns the exit status: 0, 1 when finite elements failed somewhere, 128 + signal
/// @throws InputError
int run_sweep(const SweepPlan& plan, SweepWorkers& workers, const std::string& command);

}  // namespace softfinger::sweep
