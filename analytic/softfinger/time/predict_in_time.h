#pragma once

#include "softfinger/pressure/pressure_model.h"
#include "softfinger/time/contact_history.h"

namespace softfinger {

/// The answer of a model at a time.
struct PredictionInTime {
  /// Semi-axes, approach, peak pressure and torque arms at the time; the validity is that of the
  /// elastic contact of this size. Without an answer `validity` says why.
  Prediction prediction;
  double load_N = 0;            ///< at the time
  double effective_load_N = 0;  ///< under which the elastic contact of E0 is as large
};

/// Contact, pressure and torque arm at a time of a history.
///
/// The contact's size is that of the model under the effective load. The load (of a prescribed
/// approach), the pressure and load times torque arm are integrals over the history
/// (`ContactHistory`). Exact for a model of linear elasticity. For one of finite strain it is
/// quasi-linear viscoelasticity (Fung, Biomechanics, 1981): the elastic curve of the whole contact
/// relaxes. The peak pressure is the largest of 24 points along the long axis.
///
/// @param problem  its layer has the instantaneous modulus; its normal force is not read
/// @param time_s   infinite: at rest, the elastic answer of the long-time modulus
/// @throws InputError as `ContactHistory::at`
/// Cost: some thousand calls of `predict`, after the maximum of the contact some hundred thousand.
/// Models slower than the hot path, and measured laws that do not know the modulus, have no answer.
PredictionInTime predict_at(const PressureModel& model, ContactProblem problem,
                            const ContactHistory& history, double time_s);

/// The load in N under which a model's elastic contact has an approach; NaN where it has none.
double load_at_approach_N(const PressureModel& model, ContactProblem problem, double approach_m);

}  // namespace softfinger
