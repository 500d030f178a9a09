#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "softfinger/input/constants.h"
#include "softfinger/input/contact_problem.h"
#include "softfinger/pressure/pressure_model.h"

/// Errors of a model's answer against the real finger, which is curved and at finite strain.
namespace softfinger {

/// Number of quantities, in this order everywhere: a, b, indentation, area, peak pressure, largest
/// torque.
constexpr std::size_t kBoundedQuantities = 6;
using BoundedErrors = std::array<double, kBoundedQuantities>;  ///< relative

/// Which quantities have to meet a tolerance, in the same order.
using QuantityChoice = std::array<bool, kBoundedQuantities>;
/// An answer is called usable where its contact and its torque are within the tolerance: a, b,
/// area, largest torque. Everywhere, unless the user chooses other quantities.
constexpr QuantityChoice kUsualQuantities = {true, true, false, true, false, true};

/// The largest of the chosen errors, infinite where one of them is not known (NaN).
inline double worst_of(const BoundedErrors& errors,
                       const QuantityChoice& chosen = kUsualQuantities) noexcept {
  double worst = 0;
  for (std::size_t q = 0; q < kBoundedQuantities; ++q)
    if (chosen[q] && !(errors[q] <= worst)) worst = std::isnan(errors[q]) ? kInfinity : errors[q];
  return worst;
}

/// Causes into which an expected error is split.
enum class ErrorCause {
  model,     ///< against a flat layer in linear theory
  strain,    ///< of the layer
  slope,     ///< of the surfaces at the contact's edge
  curvature  ///< of the layer
};
constexpr std::size_t kErrorCauses = 4;

/// Expected errors of a model at one contact and their bounds. Plain numbers: no allocation.
struct ErrorBound {
  bool known = false;
  BoundedErrors expected{};  ///< signed: the model's answer over the finger's, less 1
  /// Contribution of each `ErrorCause` to the expected errors; they add up to `expected`.
  std::array<BoundedErrors, kErrorCauses> causes{};
  BoundedErrors bound{};     ///< of the size of the error, in 95 % of all contacts
  const char* outside = "";  ///< why nothing is known, in words
};

/// Returns the errors of a model at a contact, against finite elements of the whole finger: a
/// neo-Hookean layer on a rigid core, which follows the problem's `finger_curvature`.
///
/// The model is compared with `fingertip_layer`, which was fitted to finite-element runs and whose
/// deviation from 95 % of them is known (fingertip_layer_core.h).
/// @param prediction  the model's, with an answer
/// Costs a prediction of `fingertip_layer` and a little. Never throws, never allocates.
ErrorBound error_bound(const ContactProblem& problem, const Prediction& prediction) noexcept;

/// Returns the errors of the model's own prediction for the problem.
ErrorBound error_bound(const PressureModel& model, const ContactProblem& problem) noexcept;

}  // namespace softfinger
