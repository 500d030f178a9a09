#pragma once

#include <string>
#include <vector>

#include "comparisons/benchmark/engine.h"

namespace softfinger::benchmark {

/// One number against its truth.
struct Measured {
  std::string what;  ///< "slip torque at 0.2 N"
  std::string unit;
  double value = 0, truth = 0;
  std::string verb = {};  ///< for the overview of what should be zero: "moved"; empty: left out
  double error() const { return truth == 0 ? value : value / truth - 1; }  ///< absolute for truth 0
};

struct Score {
  std::vector<Measured> measured;
  int steps = 0;
  double wall_s = 0;
  std::string failure;  ///< in words; empty: all was measured

  /// Measurement with the error of largest magnitude: relative, or in the unit of the values where
  /// the truth is 0.
  const Measured* worst() const;
  double steps_per_s() const { return wall_s > 0 ? steps / wall_s : 0; }
};

struct Problem {
  std::string name, question;
  std::string truth;  ///< where it comes from
  bool is_relative = true;
  Score (*solve)(const Engine& engine);
};

/// Largest possible distance of fingertip_layer's torque, the truth of pinch and twist, from finite
/// elements of the whole finger.
struct TruthBound {
  double load_N = 0;
  double bound = 0;  ///< relative; NaN: not known
};

/// One bound at each load of the twist.
std::vector<TruthBound> bounds_of_the_truth();

/// Pinch, twist, grip, tilt, held for 60 s, stack; the holds of creep/: capsule, claw, wall.
const std::vector<Problem>& all_problems();

}  // namespace softfinger::benchmark
