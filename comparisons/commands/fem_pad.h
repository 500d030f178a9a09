#pragma once

#include "comparisons/input/case.h"
#include "comparisons/reference/fem_process.h"

namespace softfinger::commands {

/// The part of `softfinger fem` that flat pads have.
struct PadFemQuestion {
  int level = 0;          ///< 0: the case's own
  int limit_surface = 0;  ///< points; 0: none
  bool json = false;
  reference::FemLimits limits;
};

/// Solves a case with a flat pad by finite elements of the whole pad, and prints the answers beside
/// those of `pad_layer`. @return exit status
int fem_pad(const PadFemQuestion& question, const input::Case& contact_case);

}  // namespace softfinger::commands
