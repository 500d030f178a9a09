#pragma once

#include <array>

#include "softfinger/input/contact_problem.h"
#include "softfinger/pressure/pressure_model.h"

/// How far a model's answer is from the finger itself: curved, at finite strain.
namespace softfinger {

/// In this order, as everywhere: a, b, indentation, area, peak pressure, largest torque.
constexpr std::size_t kBoundedQuantities = 6;
using BoundedErrors = std::array<double, kBoundedQuantities>;  ///< relative

/// The finger's part of the relative curvature along the contact's long axis x and short axis y, 0
/// to 1: 0 for a flat layer under a curved object, 1 for a finger on a plane.
struct FingerShare {
  double x = 0, y = 0;
};

/// What an expected error consists of.
enum class ErrorCause {
  model,     ///< against a flat layer in linear theory
  strain,    ///< of the layer
  slope,     ///< of the surfaces at the contact's edge
  curvature  ///< of the layer
};
constexpr std::size_t kErrorCauses = 4;

/// What is known of a model's errors. Plain numbers: no allocation.
struct ErrorBound {
  bool known = false;
  BoundedErrors expected{};  ///< signed: the model's answer over the finger's, less 1
  /// The same by `ErrorCause`; their sum is `expected`.
  std::array<BoundedErrors, kErrorCauses> causes{};
  BoundedErrors bound{};     ///< of the size of the error, in 95 % of all contacts
  const char* outside = "";  ///< why nothing is known, in words
};

/// The errors of a model at a contact, against finite elements of the whole finger: neo-Hookean
/// layer on a rigid core, the layer bent over a finger that has `share` of the relative curvature.
///
/// The model is compared with `bonded_layer`, which solves the flat layer of linear theory to
/// 0.002 %; how far that one is from the finger is a fit to finite-element runs
/// (finger_departure.h).
/// @param prediction  the model's, with an answer
/// Costs a prediction of `bonded_layer`. Never throws, never allocates.
ErrorBound error_bound(const ContactProblem& problem, const Prediction& prediction,
                       const FingerShare& share = {}) noexcept;

/// The same; asks the model first.
ErrorBound error_bound(const PressureModel& model, const ContactProblem& problem,
                       const FingerShare& share = {}) noexcept;

}  // namespace softfinger
