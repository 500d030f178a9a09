#pragma once

#include <limits>
#include <string>
#include <vector>

#include "softfinger/calibration/calibrate.h"

/// Interpretation of a calibration: the model and shear law that the data favour, the parameters
/// that they leave undetermined, and the most useful next measurement.
namespace softfinger {

/// A model or a shear law, fitted for comparison.
struct Comparison {
  const PressureModel* model = nullptr;
  ShearLaw::Kind shear_law = ShearLaw::Kind::coulomb;
  std::vector<Parameter> free;
  ParameterValues values{};
  double scatter = 0;  ///< root mean square of (measured - predicted)/predicted
  double aic = 0;      ///< Akaike's criterion, 2 parameters - 2 log likelihood; the least is best
  /// Root mean square relative error on the upper third of the loads, predicted by a fit to the
  /// others. Not a number where too few are left.
  double held_out_error = std::numeric_limits<double>::quiet_NaN();
};

/// hertz, winkler, bonded_layer, fingertip_layer and power_law, each with what it has of the
/// parameters looked for, on the measurements that are no outliers. A model without an answer, or
/// that says nothing of a measured quantity, is left out. The best first.
std::vector<Comparison> compare_models(const CalibrationProblem& problem,
                                       const Calibration& calibration);

/// The calibration's model with each shear law; empty where no friction was measured.
std::vector<Comparison> compare_shear_laws(const CalibrationProblem& problem,
                                           const Calibration& calibration);

/// Growth exponent of the contact with its load, gamma = d ln a/d ln P, over all measured a, b and
/// areas. A bonded layer under a sphere has 1/3 where it is thick against the contact, and less the
/// thinner it is: gamma determines a/h without any modulus.
struct GrowthExponent {
  bool is_known = false;
  double value = 0, std = 0;
};
GrowthExponent growth_exponent(const CalibrationProblem& problem, const Calibration& calibration);

/// One more measurement, chosen to improve the least well known parameter.
struct NextMeasurement {
  bool exists = false;
  Parameter parameter = Parameter::thickness;  ///< that is known worst
  bool is_thickness = false;                   ///< the thickness itself, with a caliper
  MeasuredQuantity quantity = MeasuredQuantity::indentation;  ///< else this
  double load_N = 0;                                          ///< at this load
  double relative_std = 0;                                    ///< that it is supposed to have
  /// Standard deviation of that parameter without and with the new measurement, relative (absolute
  /// for nu); infinite if the parameter is undetermined.
  double std_now = 0, std_then = 0;
};

/// The best of every quantity at the lowest and highest measured load and at twice it, measured as
/// well as the present ones, and of the thickness to 5 %.
NextMeasurement next_measurement(const CalibrationProblem& problem, const Calibration& calibration);

/// Returns one sentence for each thing that the data leave undetermined; empty when every parameter
/// is determined.
std::vector<std::string> cannot_tell(const CalibrationProblem& problem,
                                     const Calibration& calibration);

/// Measurements that no model explains: for each, its place and by how many standard deviations it
/// is off from the calibration's, in one line; empty when a model explains them. It does not
/// where own errors leave a goodness below one in a million, or values without any scatter by more
/// than 30 %; the standard deviations of these are taken as 10 %. Cost where the calibration's own
/// model does not: a calibration with each other one.
std::string contradiction(const CalibrationProblem& problem, const Calibration& calibration);

}  // namespace softfinger
