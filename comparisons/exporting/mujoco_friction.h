#pragma once

#include <fmt/format.h>

#include <string>

namespace softfinger::exporting {

/// `friction="0.8 0.00123 0.0001"`, an attribute of MuJoCo's geom: sliding mu, spinning (the
/// largest torque over the load, in metres), and MuJoCo's default of rolling, which condim 4 does
/// not use.
inline std::string mujoco_friction(double friction_coefficient, double torque_per_load_m) {
  return fmt::format("friction=\"{:.6g} {:.6g} 0.0001\"", friction_coefficient, torque_per_load_m);
}

}  // namespace softfinger::exporting
