#pragma once

#include <array>
#include <cmath>

#include "softfinger/accuracy/error_bound.h"
#include "softfinger/pressure/rubbed_core.h"

/// Errors by what is missed of friction while pressing (pressing_error.h), on any kind of number.
namespace softfinger {

/// @param known         the ratios at the contact's strain
/// @param frictionless  the model's numbers
/// @param rubbed        these with the ratios that the model knows
/// @param pressed       what the model says
template <class Real>
std::array<Real, kBoundedQuantities> missed_of_pressing_friction(
    const RatiosOf<Real>& known, const ContactNumbersOf<Real>& frictionless,
    const ContactNumbersOf<Real>& rubbed, const ContactNumbersOf<Real>& pressed) noexcept {
  using std::abs;
  constexpr double kFit = 0.003, kOfSize = 0.2, kOfIndentation = 0.25, kPeakFit = 0.04, kArm = 4.5;
  const Real size =
      kFit + kOfSize * (1. - known.size) + abs(Real(pressed.a_m / frictionless.a_m - known.size));
  const Real indentation =
      kFit + kOfIndentation * (1. - known.indentation) +
      abs(Real(pressed.indentation_m / frictionless.indentation_m - known.indentation));
  const Real arm = 1. - rubbed.torque_arm_exact_m / frictionless.torque_arm_exact_m;
  const Real peak_left_out =
      (rubbed.peak_pressure_Pa - pressed.peak_pressure_Pa) / frictionless.peak_pressure_Pa;
  return {size, size, indentation, 2. * size, kPeakFit + peak_left_out + kArm * arm, 0.};
}

}  // namespace softfinger
