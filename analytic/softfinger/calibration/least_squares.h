#pragma once

#include <vector>

#include "softfinger/calibration/predicted_measurements.h"

namespace softfinger {

/// Weight of one measurement in the fit.
struct Weight {
  double std = 1;           ///< of the number, or of its logarithm
  bool is_relative = true;  ///< std belongs to the logarithm
  /// Added to the measured logarithm: with a relative error of standard deviation s, the mean
  /// logarithm of a measured value lies s²/2 below the truth's.
  double shift = 0;
  bool counts = true;  ///< false: an outlier
};

/// Coordinates of a fit: the logarithm of a parameter, where ParameterRange says so.
double coordinate(Parameter parameter, double value) noexcept;
double value_at(Parameter parameter, double coordinate) noexcept;

/// A least-squares fit of parameters to measurements.
struct Fit {
  ParameterValues values{};
  double sum_of_squares = 0;  ///< of the residuals, each in its standard deviations
};

/// Largest trusted compression d/h when the thickness is fitted, and the standard deviation with
/// which the excess of ln(d/h) counts as a further residual. Beyond half its thickness a layer is
/// outside the models' range, where a thin soft layer could pass for a thick one.
constexpr double kMostCompression = 0.5, kCompressionStd = 0.1;

class LeastSquares {
 public:
  /// @param weights  one for each measurement
  /// @param is_thickness_free  whether the layer's compression is to be kept in range
  LeastSquares(const PredictedMeasurements& predicted, const std::vector<Weight>& weights,
               bool is_thickness_free)
      : predicted_(predicted), weights_(weights), is_thickness_free_(is_thickness_free) {}

  /// The least sum of squares over `free`, the others as in `start`, by the method of Levenberg and
  /// Marquardt from `start`. No parameter leaves its range (kParameterRanges): the search is in y
  /// with x = (lowest + highest)/2 + sin(y) (highest - lowest)/2 for a coordinate x.
  Fit solve(const ParameterValues& start, const std::vector<Parameter>& free) const;

  /// Residuals in standard deviations, all measurements, those that do not count too.
  Eigen::VectorXd residuals(const ParameterValues& values) const;

  /// Residuals with zeros for the measurements that do not count, followed by the residual of the
  /// excess compression (kMostCompression).
  Eigen::VectorXd counted_residuals(const ParameterValues& values) const;

  /// Derivatives of `counted_residuals` with respect to the coordinates of `free`.
  Eigen::MatrixXd jacobian(const ParameterValues& values, const std::vector<Parameter>& free) const;

  double sum_of_squares(const ParameterValues& values) const;

 private:
  /// Fits all of `free` from one starting point.
  Fit solve_inside(const ParameterValues& start, const std::vector<Parameter>& free) const;
  /// Whether the sum would only fall beyond the borders on which these lie.
  bool push_outwards(const ParameterValues& values, const std::vector<Parameter>& at_border) const;

  const PredictedMeasurements& predicted_;
  const std::vector<Weight>& weights_;
  bool is_thickness_free_;
};

}  // namespace softfinger
