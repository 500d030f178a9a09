#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/atlas/error_atlas.h"

namespace softfinger {

/// The designed set of runs: a grid of (nu, R'/R'', s) on flat layers, curved fingers over h/R, and
/// twists over the friction coefficient.
std::vector<AtlasRun> designed_runs();

/// Spheres on flat layers and round fingers on planes at finite strain (neo-Hookean, quadratic
/// volume energy) over (nu, h/R, s), and built-in pads over the load, each with its linear twin.
std::vector<AtlasRun> finite_strain_runs();

/// Contacts drawn at random from within the grid, to test bounds with: ln s, ln R'/R'', and nu by
/// the measure of its grid. The same for the same seed.
std::vector<AtlasRun> random_runs(int count, unsigned seed);

struct AtlasOptions {
  std::filesystem::path folder;  ///< finished runs are kept there: the same command goes on
  int jobs = 1;
  int part = 0, parts = 1;  ///< this process's share of the runs, e.g. its rank under mpirun
  std::string command;
};

/// Runs what is not finished yet, as results come. Null when runs are missing: other processes have
/// them, it was interrupted, or they failed, which is said on standard error.
std::optional<AtlasFile> make_atlas(const std::vector<AtlasRun>& runs, const AtlasOptions& options);

/// The errors of all models, anew, for finite elements that are known.
void judge_models(AtlasFile& atlas);

}  // namespace softfinger
