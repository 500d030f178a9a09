#pragma once

#include <string>

#include "softfinger/pads/pad_model.h"

/// Content of the page of `softfinger explore` for one flat pad, as explorer.h has it for curved
/// contacts.
namespace softfinger::explorer {

/// One position of the page's sliders.
struct PadQuestion {
  PadProblem problem;      ///< a load in the middle
  double tolerance = 0.1;  ///< of the torque, within which an answer is usable, relative
  bool is_covered = true;  ///< false: an object's edge lies within the pad, and no bound is known
  int shown = 0;           ///< place in `all_pad_models()` of the model that is drawn
};

/// JSON, SI units; a value that is not known is null:
///
///   { "models": [ { "name", "has_answer", "max_torque_Nm", "eccentricity_m", "pressure_arm_m",
///       "indentation_m", "normal_stiffness_N_per_m", "peak_pressure_Pa",
///       "tilt_stiffness_Nm_per_rad": [x, y], "tilt_limit_Nm": [x, y],
///       "bound": null or { "max_torque", "indentation", "pressure_arm", "peak_pressure",
///       "tilt_stiffness" }, "usable", "objections": [ messages of the checks that fail ] } ],
///     "area_m2", "shape_factor", "centre_m": [x, y], "extent_m": [x, y],
///     "map": { "rim_m": [ [x, y], .. ], "rings": [0, .., 1], "pressure_Pa" }: the pressure in the
///       cells between neighbouring points of the rim and neighbouring rings, which lie at these
///       parts of the way from the centre; rim by rim point, ring by ring,
///     "profile": { "x_m", "along_x_Pa", "y_m", "along_y_Pa" }: on the lines through the centre,
///     "simulators": [ { "name", "text" } ] }
std::string pad_answer(const PadQuestion& question);

}  // namespace softfinger::explorer
