#pragma once

#include "softfinger/input/contact_problem.h"
#include "softfinger/pressure/pressure_model.h"

namespace softfinger {

/// The recommended model of a contact. Every command, library and plugin takes it unless a model is
/// named, so that all of them give the same torque.
///
/// It is `fingertip_layer`, which was fitted to finite elements of whole fingers, for one layer on
/// a finger of a shape that it was fitted to: convex, no thicker and no longer than its runs
/// (`FingertipRange`). For other shapes, and for layers on both bodies that are alike, it is
/// `bonded_layer`, which is exact for flat layers of linear material. For a stack of sublayers, and
/// for layers on both bodies that differ, it is `stack_layer`. Where these have no answer it is
/// `hertz`.
///
/// The load does not enter while `bonded_layer` has an answer, so that one contact keeps its model
/// as it is pressed. Costs a few nanoseconds for the first, a prediction for the others. Never
/// throws, never allocates.
const PressureModel& default_model(const ContactProblem& problem) noexcept;

}  // namespace softfinger
