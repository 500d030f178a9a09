#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/judgement/atlas/error_atlas.h"
#include "comparisons/reference/fem_jobs.h"

namespace softfinger::judgement {

/// The designed set of runs: a grid of (nu, R'/R'', s) on flat layers, curved fingers over h/R, and
/// twists over the friction coefficient.
std::vector<AtlasRun> designed_runs();

/// Spheres on flat layers and round fingers on planes at finite strain (neo-Hookean, quadratic
/// volume energy) over (nu, h/R, s), and built-in pads over the load. Each is also solved with
/// linear elasticity.
std::vector<AtlasRun> finite_strain_runs();

/// Random contacts within the grid, for tests of the bounds: uniform in ln s, ln R'/R'' and
/// -ln(0.501 - nu), the coordinates of the grid. The same seed gives the same contacts.
std::vector<AtlasRun> random_runs(int count, unsigned seed);

/// Random fingers on objects at finite strain, from a touch to a hard grip: nu 0 to 1/2, R'/R'' to
/// 20, h/R 0.005 to 0.6, s 0.02 to 20; two of five round on a plane, one of five flat under a
/// curved object, the others curved like their objects. The same seed gives the same contacts.
std::vector<AtlasRun> random_fingers(int count, unsigned seed);

/// Random fingertips as a user would name them, at finite strain: ellipsoids with h/R 0.01 to 0.5
/// and R'/R'' to 10 on flat, convex and hollow objects, turned against them, d to 0.4 h and slopes
/// to 0.5. The same seed gives the same contacts.
std::vector<AtlasRun> random_fingertips(int count, unsigned seed);

/// Fingertips of `random_fingertips`, pressed with friction: mu from 0.05 to 1.5, even in its
/// logarithm.
std::vector<AtlasRun> random_rubbed_fingertips(int count, unsigned seed);

struct AtlasOptions {
  std::filesystem::path folder;  ///< keeps finished runs, so that the same command continues
  int jobs = 1;
  reference::FemLimits fem_limits;  ///< of each run
  bool without_failed = false;      ///< runs that fail are left out and reported
  std::string command;
};

/// The finite-element problems of the runs, each with its file in `folder`.
std::vector<reference::FemJob> atlas_jobs(const std::vector<AtlasRun>& runs,
                                          const std::filesystem::path& folder);

/// The runs with what the finite elements found and each model's errors; nothing when results are
/// missing, which is said on standard error.
/// @param without_failed  leaves missing ones out instead
std::optional<AtlasFile> collect_atlas(const std::vector<AtlasRun>& runs,
                                       const std::vector<reference::FemJob>& jobs,
                                       const reference::FemJobOptions& settings,
                                       const std::string& command, bool without_failed = false);

struct AtlasOutcome {
  std::optional<AtlasFile> atlas;  ///< nothing when runs failed or are missing
  int signal = 0;                  ///< that interrupted
};

/// Runs what is not finished yet, keeps results as they come, and collects them.
AtlasOutcome make_atlas(const std::vector<AtlasRun>& runs, const AtlasOptions& options);

/// Computes the errors of all models again, from the finite-element results in the atlas.
void judge_models(AtlasFile& atlas);

}  // namespace softfinger::judgement
