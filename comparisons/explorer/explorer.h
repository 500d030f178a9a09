#pragma once

#include <string>
#include <vector>

#include "softfinger/pressure/pressure_model.h"

/// Content of the page of `softfinger explore` for one contact. The page runs this code, compiled
/// to WebAssembly (web/): models, error bounds, limit surface and simulators are those of the
/// program. It therefore needs neither files nor exceptions.
namespace softfinger::explorer {

/// One position of the page's sliders.
struct Question {
  ContactProblem problem;  ///< one flat layer under a rigid object, R' >= R''
  double tolerance = 0.1;  ///< of area and torque, within which an answer is usable, relative
  int shown = -1;  ///< place in `models()` of the model that is drawn; -1: the recommended one,
                   ///< -2: none, only the numbers of `models` are asked for
};

/// The models that take microseconds and need no measured law, in the registry's order.
const std::vector<const PressureModel*>& models();

/// JSON, SI units; a value that is not known is null:
///
///   { "models": [ { "name", "has_answer", "a_m", "b_m", "indentation_m", "area_m2",
///       "peak_pressure_Pa", "max_torque_Nm", "eccentricity_m",
///       "bound": null or [a, b, indentation, area, peak pressure, torque], "outside": why null,
///       "usable", "objections": [ messages of the checks that fail ] } ],
///     "nearest": place of the model whose largest bound of a, b, area and torque is smallest;
///       -1: no bound is known,
///     "recommended": place of `default_model`,
///     "shown": place of the one that the rest is about; -1: none, the rest is null or empty,
///     "profile": { "position": part of the semi-axis, "long_Pa", "short_Pa" },
///     "limit": { "exponent", "along_long", "along_short": [ [force_N, torque_Nm], .. ],
///       "lowest", "highest": ellipsoid_deviation.h, "max_force_N", "max_torque_Nm" },
///     "simulators": [ { "name", "text" } ] }
///
/// `usable` is as `softfinger predict` says it. About a millisecond.
std::string answer(const Question& question);

}  // namespace softfinger::explorer
