#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "comparisons/reference/fem_process.h"
#include "comparisons/reference/full_reference.h"

namespace softfinger::suite {

struct CompareOptions {
  std::vector<std::filesystem::path> case_files;
  input::Settings settings;      ///< for each of them
  std::filesystem::path output;  ///< folder, created when missing
  /// Idealisations of the reference where a case's [fem] leaves them open.
  reference::Idealisations idealisations;
  bool full = false;  ///< one FEM level finer than the case says, at most 3
  bool quick =
      false;     ///< the reference alone, without the ladder's steps between it and the models
  int jobs = 1;  ///< FEM processes side by side
  reference::FemLimits fem_limits;  ///< of each load
  std::string command;              ///< as typed, for the report's provenance
  bool json = false;                ///< the answer on standard output as JSON
};

/// Runs models and FEM on all loads of all cases and writes report.html, report.json
/// (report/README.md), results.csv and, in `fem/<id>_<load>/`, each FEM result as soon as it is
/// there. A result whose problem and program are unchanged is reused, so that an interrupted run
/// continues.
///
/// All cases are read and checked before anything is written.
/// @returns the exit status: 0, 1 when FEM failed or is not trusted somewhere, 128 + signal when
/// interrupted
/// @throws InputError
int compare(const CompareOptions& options);

/// A number of FEM processes that suits this machine.
int default_job_count();

}  // namespace softfinger::suite
