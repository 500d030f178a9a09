#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "comparisons/input/scene.h"
#include "comparisons/simulation/recording.h"
#include "softfinger/dynamics/step/time_stepper.h"

namespace softfinger::simulation {

struct SimulationOptions {
  /// False: the recording has the latest frame only, so that its memory does not grow.
  bool keeps_frames = true;
  /// Every complementarity problem of the simulation is written there; empty: none.
  std::filesystem::path record_lcp;
  /// Called before each step; returns false to stop, with what there is.
  std::function<bool(int step)> go_on = [](int) { return true; };
  /// Called before each step, after the scene's own motors, forces and gravity have been set.
  std::function<void(TimeStepper& stepper)> command = [](TimeStepper&) {};
  /// Called at the start and after each step done, which is the recording's last frame.
  std::function<void(const Recording& recording, const TimeStepper& stepper)> reached =
      [](const Recording&, const TimeStepper&) {};
};

struct Simulation {
  Recording recording;  ///< a frame at the start and one per step done, or the latest
  int steps = 0;        ///< done
  bool interrupted = false;
  std::string failure;  ///< of a step without solution: time, bodies, contacts; else empty

  std::vector<double> step_ms;  ///< wall time of each step: detection, fits, models, LCP, motion
  double wall_s = 0;            ///< sum of these
  int lcp_failures = 0;         ///< 0 or 1: the first failure ends the simulation
  double max_residual = 0;
  int most_contacts = 0;
  int quadric_fits = 0;
  /// e_n depends on the load, and the load is part of the solution: a step repeats until they
  /// agree.
  int most_load_iterations = 0;      ///< of a step
  double max_load_disagreement = 0;  ///< at the end of a step, relative
  int motor_disagreements = 0;       ///< steps whose motors did not settle within their limits
};

/// Lets bodies that overlap at the start pass through each other, as robots' files have them.
/// @returns the tables [[contact]] that do the same in the scene's text, and a sentence for each
/// pair
struct SeparatedBodies {
  std::string tables;
  std::vector<std::string> remarks;
};
SeparatedBodies separate_overlapping_bodies(input::Scene& scene);

/// Runs a scene from its start.
/// @throws InputError when bodies overlap at the start.
Simulation simulate(const input::Scene& scene, const SimulationOptions& options = {});

/// The p-th part (0 to 1) of the values, by rank.
double percentile(std::vector<double> values, double p);

}  // namespace softfinger::simulation
