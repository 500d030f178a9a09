#pragma once

#include <string>
#include <utility>
#include <vector>

#include "comparisons/input/case.h"
#include "comparisons/input/measurements.h"
#include "comparisons/prediction/local_geometry.h"
#include "softfinger/calibration/advice.h"

/// Work of `softfinger calibrate`: a case's layer and friction from measurements.
namespace softfinger::calibration {

struct Request {
  const PressureModel* model = nullptr;
  std::vector<Parameter> fit;                       ///< empty: the default of the model and data
  std::vector<std::pair<Parameter, double>> fixed;  ///< SI; in place of the case's own values
};

struct CaseCalibration {
  input::Case fitted;  ///< the case with what was found; its geometry is unchanged
  input::MeasurementTable table;
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

/// @throws InputError for data and requests that do not go together, and for data that contradict
/// every model, with the points and by how many standard deviations
CaseCalibration calibrate_case(const input::Case& contact_case,
                               const input::MeasurementTable& table, const Request& request);

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
