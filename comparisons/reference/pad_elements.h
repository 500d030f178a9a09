#pragma once

#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/reference/fem_process.h"

/// Finite elements of a flat pad, by the same process as those of fingers (fem/pad/README.md).
namespace softfinger::reference {

/// Numbers of a pad with their relative errors, which are the elements' own. SI; pairs are about
/// the x and about the y axis, or along them.
struct PadElements {
  double load_N = 0, indentation_m = 0, normal_stiffness_N_per_m = 0, area_m2 = 0,
         peak_pressure_Pa = 0, pressure_arm_m = 0, eccentricity_m = 0, max_torque_Nm = 0,
         torsional_stiffness_Nm_per_rad = 0, lifted_share = 0;
  std::array<double, 2> tilt_stiffness_Nm_per_rad{}, tangential_stiffness_N_per_m{};
  /// The value is missing where the rim is under tension without any tilt.
  std::array<std::optional<double>, 2> tilt_limit_Nm;
  nlohmann::json error;          ///< relative, by quantity
  nlohmann::json limit_surface;  ///< points "fx_N", "fy_N", "torque_Nm", where asked for
  double unknowns = 0, wall_s = 0, peak_memory_MB = 0;
};

/// The problem of a load as the program reads it. The block has the side walls of the flat face:
/// with a fillet, those that the face alone would have.
nlohmann::json pad_problem(const input::Case& contact_case, double load_N, int level,
                           int limit_surface);

struct PadRun {
  std::vector<PadElements> of_load;  ///< in the order of the problems, until one failed
  FemAnswer failure;                 ///< of the first that failed; empty: none did
  int interrupted = 0;               ///< by this signal
};

/// Solves problems by one process, one after the other.
/// @param on_line  called with each line about the progress of a problem
PadRun solve_pads(const std::string& program, const std::vector<nlohmann::json>& problems,
                  const FemLimits& limits,
                  const std::function<void(std::size_t, const std::string&)>& on_line);

}  // namespace softfinger::reference
