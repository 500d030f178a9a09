#pragma once

#include <string>

#include "comparisons/input/case.h"
#include "comparisons/prediction/quantity.h"

namespace softfinger::commands {

/// The part of `softfinger predict` that flat pads have.
struct PadQuestion {
  prediction::Demand demand;
  std::string models = "all";
  int limit_surface = 0;  ///< points; 0: none
  bool json = false, explain = false;
};

/// Prints the answers for a case with a flat pad. @return exit status
int predict_pad(const PadQuestion& question, const input::Case& contact_case);

}  // namespace softfinger::commands
