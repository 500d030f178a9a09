#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/input/measurements.h"
#include "comparisons/prediction/local_geometry.h"
#include "softfinger/calibration/advice.h"
#include "softfinger/calibration/forecast.h"

/// Work of `softfinger calibrate`: a case's layer and friction from measurements.
namespace softfinger::calibration {

struct Request {
  const PressureModel* model = nullptr;
  std::vector<Parameter> fit;                       ///< empty: the default of the model and data
  std::vector<std::pair<Parameter, double>> fixed;  ///< SI; in place of the case's own values
  /// Part of the largest load above which values are kept from the fit; 1: none are.
  double fitted_part = 1;
  std::vector<double> forecast_loads_N;  ///< at which every measured quantity is predicted
  /// The curve's exponent may be one that no solid finger of this geometry has.
  bool takes_any_exponent = false;
};

/// A value that was kept from the fit, or, without a line of the table, none that was measured.
struct ForecastValue {
  MeasuredQuantity quantity = MeasuredQuantity::indentation;
  double load_N = 0;
  std::optional<double> measured;
  int line = 0;
  Forecast forecast;

  bool is_inside() const { return forecast.low() <= *measured && *measured <= forecast.high(); }
};

/// The table's rows in the order of time, where the approach rises and falls again.
struct MeasuredBranches {
  std::size_t loading = 0, unloading = 0;  ///< numbers of values; the latter are not fitted
  Loop loop;
};

struct CaseCalibration {
  input::Case fitted;             ///< the case with what was found; its geometry is unchanged
  input::MeasurementTable table;  ///< what was fitted
  std::optional<MeasuredBranches> branches;
  std::vector<ForecastValue> held_out, forecasts;
  double held_out_above_N = 0;
  ExponentDoubt exponent_doubt;
  std::vector<std::pair<Parameter, double>> fixed;  ///< as requested
  CalibrationProblem problem;
  Calibration found;
  /// Counts, for meshes, whose local geometry depends on the contact's size, how often fit and
  /// geometry were repeated until they agreed, and whether they did. Else 1 and true.
  int geometry_rounds = 1;
  bool is_geometry_settled = true;
  std::vector<std::string> remarks;  ///< about the meshes

  std::vector<Comparison> models, shear_laws;
  GrowthExponent growth;
  NextMeasurement next;
  std::vector<std::string> cannot_tell;
  std::string unit_doubt;  ///< a sentence, where no rubber is like that; else empty

  const ParameterEstimate* estimate(Parameter parameter) const;
};

/// Fits the loading branch where the table has two, and of it what lies below the held-out loads.
/// @throws InputError for data and requests that do not go together, for data that contradict
/// every model, with the points and by how many standard deviations, and for a curve whose exponent
/// no solid finger has
CaseCalibration calibrate_case(const input::Case& contact_case,
                               const input::MeasurementTable& table, const Request& request);

/// "the force grows as the indentation to the power 1.14 (95 %: 1.1 to 1.2) above 0.6 N, where ..."
std::string exponent_sentence(const ExponentDoubt& doubt);

/// A measured quantity over the load as the fit has it, with the band in which chance leaves the
/// fit itself in 95 % of all cases (not a further measurement, which scatters in addition). From
/// the parameters' covariance and the model's derivatives.
struct FittedCurve {
  MeasuredQuantity quantity;
  std::vector<double> loads_N, value, low, high;  ///< SI; not a number: no answer, or not known
};
/// Curves of every measured quantity, from somewhat below the least load to somewhat above the
/// largest; no farther than these where the geometry was fitted to meshes.
std::vector<FittedCurve> fitted_curves(const CaseCalibration& calibration);

/// Region that holds two parameters together with a probability of 95 %, by their covariance. The
/// points lie around an ellipse in the coordinates of the fit (the logarithm of all but nu) and are
/// given as values, clipped to each parameter's range.
struct ConfidenceEllipse {
  Parameter x, y;
  std::vector<std::pair<double, double>> points;
};
/// One entry for each pair of layer parameters; empty where the covariance is not known.
std::vector<ConfidenceEllipse> confidence_ellipses(const CaseCalibration& calibration);

/// The case file with what was found or fixed in place of its values, and all else as it was typed.
/// Checked by reading it again.
/// @param path  where it is to be written: names of meshes stay relative to the same folder only
std::string fitted_case_text(const CaseCalibration& calibration, const std::filesystem::path& path);

}  // namespace softfinger::calibration
