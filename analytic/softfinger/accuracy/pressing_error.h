#pragma once

#include "softfinger/accuracy/error_bound.h"

namespace softfinger {

/// Relative errors that come on top of `error_bound` where the contact is pressed with friction:
/// what the ratios leave that know the strain (rubbed_prediction.h), and for a model of linear
/// elasticity, or of no friction, how far its own answer is from these. With the bound of
/// frictionless pressing they hold 95 % of the errors in b and at least 99 % of the others, of 199
/// fingers that nothing was fitted to (`softfinger atlas --random 205 --seed 20261130 --fingertips
/// --rubbed`). In the pressed arm, and so in the peak, all miss up to 4.5 times the linear change.
/// The largest torque does not change.
/// @param friction_coefficient  mu > 0 that acts while pressing; infinite: all sticks
/// @param frictionless          the model's answer
/// @param pressed               what it says of pressing with friction; `frictionless` where it
///                              leaves that out
/// Never throws, never allocates.
BoundedErrors missed_of_pressing_friction(const PressureModel& model, const ContactProblem& problem,
                                          double friction_coefficient,
                                          const Prediction& frictionless,
                                          const Prediction& pressed) noexcept;

/// `error_bound` of the model's own answer for pressing with friction. Where nothing is known of
/// the frictionless contact nothing is known.
ErrorBound error_bound(const PressureModel& model, const ContactProblem& problem,
                       double pressing_friction_coefficient) noexcept;

}  // namespace softfinger
