#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "comparisons/prediction/quantity.h"

namespace softfinger::commands {

/// Options that say which answer is good enough: --tolerance and --quantities.
struct DemandInput {
  double tolerance = 0.1;
  std::string quantities;  ///< as typed; empty: the usual ones

  /// @throws InputError for an unknown quantity, and for a tolerance that is no number
  prediction::Demand demand() const;
};

/// Adds `--tolerance` and `--quantities` to a command.
void add_demand(CLI::App& command, DemandInput& typed);

}  // namespace softfinger::commands
