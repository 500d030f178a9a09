#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "comparisons/judgement/comparison.h"
#include "comparisons/judgement/pad_comparison.h"

/// The files that `compare` leaves: what report.json holds is described in
/// comparisons/report/README.md.
namespace softfinger::suite {

/// All cases of a run, and how the run was made.
struct SuiteComparison {
  std::vector<judgement::CaseComparison> cases;
  std::vector<judgement::PadCaseComparison> pads;  ///< the cases with a flat pad
  double tolerance = 0;
  std::string command;  ///< as typed
  int cores = 1;
  double wall_s = 0;
};

/// Whether the finite elements finished everywhere with small enough errors
/// (reference::is_trusted).
bool is_trusted_everywhere(const SuiteComparison& suite);

/// report.json. Links to VTU files are relative to the folder that holds it.
nlohmann::json report_json(const SuiteComparison& suite);

/// Content of the page beside report.json: the atlas with the contacts of the suite marked, and the
/// theory against published measurements. These numbers are the program's own and the same in every
/// report.
nlohmann::json page_json(const SuiteComparison& suite);

/// The results of one load as all commands have them (docs/json.md): the finite elements, then the
/// models, usable where they are within the tolerance of them.
nlohmann::json results_json(const judgement::Comparison& load, double tolerance);

/// One row per case, load and model, the finite elements first, those of pads at the end; empty
/// where a number does not exist. Models have relative errors against the finite elements, these
/// have the errors that they state themselves.
std::string results_csv(const SuiteComparison& suite);

}  // namespace softfinger::suite
