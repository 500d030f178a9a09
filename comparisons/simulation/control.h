#pragma once

#include <iosfwd>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "comparisons/simulation/simulate.h"

namespace softfinger::simulation {

/// A simulation under the control of another program: one JSON object per line in either
/// direction, SI units.
///
/// A state is written at the start, after the steps asked for, and at the scene's end: "time_s",
/// "ended", "bodies" and "contacts" as `softfinger simulate --json` has them, "joints" with
/// position, velocity and the motor's effort. A command is read before the next step, all keys
/// optional:
///   {"steps": 10, "motors": {"lift": {"target": 0.02}}, "gravity_m_per_s2": [0, 0, -9.81],
///    "forces": {"box": {"force_N": [1, 0, 0], "torque_Nm": [0, 0, 0]}}}
/// Motors are named by their joints and have the fields of `Motor`; what is set holds until it is
/// set anew, also against the scene's own tables. The end of the commands ends the simulation.
class Control {
 public:
  Control(const input::Scene& scene, std::istream& commands, std::ostream& states);

  /// The options of a simulation under this control, which must outlive it. They keep no frames:
  /// the other program has them, and may go on for as long as it likes.
  SimulationOptions options();

 private:
  bool read_command();
  void set_motors(const nlohmann::json& motors);
  void set_forces(const nlohmann::json& forces);
  void act(TimeStepper& stepper);
  void reached(const Recording& recording, const TimeStepper& stepper);

  const input::Scene& scene_;
  std::istream& commands_;
  std::ostream& states_;
  int steps_to_do_ = 0;
  std::map<int, std::map<std::string, double>> motors_;  ///< by index: what was set
  std::map<int, AppliedForce> forces_;                   ///< by body
  std::optional<Eigen::Vector3d> gravity_m_per_s2_;
};

}  // namespace softfinger::simulation
