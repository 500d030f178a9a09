#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "fem/base/progress.h"
#include "fem/pad/pad_problem.h"
#include "fem/pad/pad_result.h"

namespace softfinger::fem {

class FaceResponse;

/// The two meshes of the latest pad, for a next one of the same shape, thickness and nu.
struct PadCache {
  std::vector<double> key;
  std::vector<std::pair<PadLevel, std::shared_ptr<const FaceResponse>>> levels;
};

/// Solves a flat pad, a block of rubber of thickness h bonded to a rigid backing with free side
/// walls, that a rigid flat face presses, in linear elasticity.
///
/// The normal displacement of the touched face is that of a plane, d + tilt_x x + tilt_y y. Its
/// tangential tractions are zero (frictionless), or its tangential displacements are (stuck). The
/// sum of p and its moments about x and y are those of the load. A frictionless face lifts off
/// where the pad would have to be pulled.
///
/// Two meshes are solved, that of `level` and the next coarser one. Integral quantities are
/// extrapolated from both, and errors are told by their difference.
/// @param cache  of the caller's run; null: nothing is kept
/// @throws InputError for values out of range, an outline that cannot be meshed, a load outside of
/// the face or one that would have to pull a stuck face
/// @throws ConvergenceError, Interrupted
PadResult solve_pad(
    const PadProblem& problem, const Progress& progress,
    const StopRequested& stop = [] { return false; }, PadCache* cache = nullptr);

}  // namespace softfinger::fem
