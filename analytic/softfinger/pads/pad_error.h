#pragma once

#include <optional>

#include "softfinger/pads/pad_model.h"

namespace softfinger {

/// Relative errors of a pad's numbers against linear finite elements of the whole pad.
struct PadErrors {
  double indentation = 0, peak_pressure = 0, pressure_arm = 0, max_torque = 0, tilt_stiffness = 0,
         tangential_stiffness = 0, torsional_stiffness = 0;
  double area = 0;  ///< of what has not lifted off
};

/// Bounds that hold for 95 % of outlines, thicknesses and nu that the model was not fitted to, by
/// ranges of size over thickness and of nu. For pad_uniform: its distance from pad_layer and
/// pad_layer's own bound. None where the model has no answer, beyond the ranges and above a strain
/// of a tenth; NaN for what is not known of a stuck face whose rim has lifted off.
std::optional<PadErrors> pad_error_bound(const PadModel& model, const PadProblem& problem) noexcept;

/// The friction coefficient that sticks a face from rim to rim, from rows of finite elements: 0.33
/// at nu = 0.3, 0.87 at 0.49. Below, stiffness and pressure lie between those of both pressings.
double friction_that_sticks(double poisson_ratio) noexcept;

}  // namespace softfinger
