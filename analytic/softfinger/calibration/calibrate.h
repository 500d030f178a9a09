#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "softfinger/calibration/least_squares.h"

/// Material and thickness of a fingertip from measurements of its contacts.
namespace softfinger {

struct CalibrationProblem {
  const PressureModel* model = nullptr;
  Measurements measurements;
  ShearLaw::Kind shear_law = ShearLaw::Kind::coulomb;
  PressingFriction pressing = PressingFriction::none;  ///< as of PredictedMeasurements
  std::vector<Parameter> free;  ///< what to find; the others stay as in `start`
  ParameterValues start{};      ///< every parameter
};

/// Estimate of one fitted parameter.
struct ParameterEstimate {
  Parameter parameter;
  double value = 0;  ///< SI
  /// Standard deviation from the covariance; infinite where the data leave the parameter
  /// undetermined.
  double std = 0;
  /// The 95 % interval: outside, even the best of the other parameters fits so much worse that
  /// chance explains it in 5 % of all cases (profile likelihood; with the scatter estimated from
  /// the data themselves, by Student's distribution).
  double low = 0, high = 0;
  /// The interval ends at the border of what was searched (kParameterRanges).
  bool is_low_open = false, is_high_open = false;

  /// The interval spans less than a factor of two, and ends for a better reason than that the
  /// search did. Of nu, and of a compliance at zero, the border is nature's. A nuisance is
  /// determined where the search ended.
  bool is_determined() const {
    const ParameterRange& range = range_of(parameter);
    if (range.is_nuisance) return !is_high_open && (!is_low_open || range.lowest == 0);
    return high <= 2 * low && !(range_of(parameter).logarithmic && (is_low_open || is_high_open));
  }
};

struct Calibration {
  ParameterValues values{};
  std::vector<ParameterEstimate> parameters;
  /// Covariance of the parameters' coordinates (see `coordinate`), in the order of `parameters`;
  /// empty where the data leave some combination of them undetermined.
  Eigen::MatrixXd covariance;
  /// Measurements left out, because a fit to the others predicts them too badly to be chance (one
  /// set in a hundred loses a good one).
  std::vector<std::size_t> outliers;
  std::vector<double> predicted;  ///< SI, one for each measurement
  std::vector<double> deviation;  ///< (measured - predicted)/std of the measurement
  std::vector<Weight> weights;    ///< as fitted
  /// Standard deviation of the measurements without an error of their own, relative; by quantity
  /// where their scatters differ more than by chance. Zero: there are none. Of approaches that are
  /// read from an unknown zero, relative to their largest reading.
  std::array<double, kMeasuredQuantities> scatter{};
  /// Probability that chance alone makes the fit to the measurements with stated errors as bad as
  /// this; 1 without such measurements.
  double goodness = 1;
  /// Factor applied to the stated errors where they are too small for the fit (goodness below 1 %);
  /// else 1.
  double error_factor = 1;
  double sum_of_squares = 0;  ///< in standard deviations, of what counts
  double log_likelihood = 0;  ///< at its largest, of readings in their own units
  double freedom = 0;         ///< of the scatter's estimate; infinite with own errors only

  bool is_outlier(std::size_t measurement) const;
};

/// Fits the model to the measurements: weighted least squares of the logarithms (of the values
/// themselves where an error of its own is not the same part of each value), from several starting
/// points, with outliers taken out.
///
/// @throws InputError when there are fewer measurements than parameters, a number is out of range,
/// the model has no derivatives, or no answer for a contact or a measured quantity.
/// Cost: below 50 ms for 20 loads and four parameters.
Calibration calibrate(const CalibrationProblem& problem);

}  // namespace softfinger
