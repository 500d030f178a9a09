#pragma once

#include <vector>

#include "softfinger/calibration/calibrate.h"
#include "softfinger/calibration/press_curve.h"

/// Predictions beyond the calibrated loads, with a band that contains what the model has wrong, and
/// the doubt whether a solid finger was measured at all.
namespace softfinger {

/// A number that was not measured, or was kept from the fit.
struct Forecast {
  double value = 0;  ///< SI, by the calibration
  /// Half of the band in which a measurement lies in 95 % of all cases if the model is right: the
  /// parameters' uncertainty and the scatter of one more measurement.
  double chance = 0;
  /// Half of the band for what the model has wrong, from the calibrated values alone: (1) by how
  /// much power laws through them, over the exponent's whole interval (for a travel with a zero of
  /// its own), depart from the model, and (2) the relative error that the model itself makes on the
  /// upper half of the calibrated loads when it is fitted to their lower half, in proportion to the
  /// logarithm of the load over the largest calibrated one; one such error for a factor of two.
  /// Within the calibrated loads the scatter says it, and this is zero.
  double misfit = 0;
  /// False where the model has no answer, and beyond the calibrated loads where fewer than five
  /// values, or too narrow a range of loads, tell no misfit.
  bool is_known = false;

  double low() const { return value - chance - misfit; }
  double high() const { return value + chance + misfit; }
};

/// @param asked  contacts and quantities; the values are not looked at. The first contact must be
/// the first of the problem, whose radius the parameter is.
/// Cost: one more fit and a scan of 1,500 exponents.
std::vector<Forecast> forecast(const CalibrationProblem& problem, const Calibration& calibration,
                               const Measurements& asked);

/// A measured exponent (`curve_exponent`) beside those that a solid finger can have.
struct ExponentDoubt {
  bool exists = false;
  CurveExponent measured;
  double least = 0, most = 0;  ///< of a solid finger
  double from_load_N = 0;      ///< above which this was seen
};

/// Exponents of a body that is no shell: Hertz's 3/2 or more, because a core and large strain only
/// stiffen it.
constexpr double kLeastSolidExponent = 1.5;

/// Looks at all loads above a twentieth of the largest, and at their upper half. There is doubt
/// where the whole interval of the exponent lies below 1.25, in the middle between a spring's and
/// Hertz's, or above 1.5 times that of the calibrated model at the same loads: the finger is
/// hollow, its mount gives, or it begins to bear on something stiffer. Rubber's stiffening and its
/// lag stay within these limits. A mount's part is taken off the readings first.
/// @param calibration  null: not calibrated yet, and only the lower limit is looked at
ExponentDoubt exponent_doubt(const CalibrationProblem& problem, const Calibration* calibration);

}  // namespace softfinger
