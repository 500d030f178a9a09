#include <pybind11/stl.h>

#include <array>
#include <cmath>

#include "analytic/python/bindings/contacts.h"
#include "softfinger/calibration/advice.h"
#include "softfinger/calibration/statistics.h"

namespace softfinger::python {
namespace {

using Integers = py::array_t<int, py::array::c_style | py::array::forcecast>;

std::string name_of(Parameter parameter) { return std::string(range_of(parameter).name); }
std::string name_of(MeasuredQuantity quantity) {
  return std::string(kMeasuredQuantityNames[std::size_t(quantity)]);
}

Numbers array_of(const std::vector<double>& values) {
  return Numbers(py::ssize_t(values.size()), values.data());
}

/// All that is known after a calibration.
struct Findings {
  Calibration found;
  std::vector<double> std;  ///< of each measurement as it counted, SI
  std::vector<Comparison> models, shear_laws;
  GrowthExponent growth;
  NextMeasurement next;
  std::vector<std::string> cannot_tell;
};

Findings find(const CalibrationProblem& problem) {
  Findings result;
  Calibration& found = result.found = calibrate(problem);
  if (const std::string reason = contradiction(problem, found); !reason.empty())
    throw InputError("calibrate", reason, "",
                     "data that some model explains; are radii and units right?");
  for (std::size_t i = 0; i < found.weights.size(); ++i)
    result.std.push_back(found.weights[i].std *
                         (found.weights[i].is_relative ? found.predicted[i] : 1));
  result.models = compare_models(problem, found);
  result.shear_laws = compare_shear_laws(problem, found);
  result.growth = growth_exponent(problem, found);
  result.next = next_measurement(problem, found);
  result.cannot_tell = cannot_tell(problem, found);
  return result;
}

/// A measured quantity over the load as the fit has it, with the 95 % band of the fit itself.
struct Curve {
  MeasuredQuantity quantity;
  std::vector<double> value, low, high;  ///< SI; not a number: no answer, or not known
};

/// Returns the fitted curve of every measured quantity at these loads. The band follows from the
/// parameters' covariance, in the logarithm of the number.
std::vector<Curve> curves_of(const CalibrationProblem& problem, const Calibration& found,
                             const std::vector<double>& loads_N) {
  // The first contact is the one whose radius the parameter is.
  Measurements asked{{problem.measurements.contacts[0]}, {}};
  for (const double load_N : loads_N) {
    asked.contacts.push_back(asked.contacts[0]);
    asked.contacts.back().load.normal_force_N = load_N;
  }
  std::array<bool, kMeasuredQuantities> is_measured{};
  for (const Measurement& measurement : problem.measurements.values)
    is_measured[std::size_t(measurement.quantity)] = true;
  for (std::size_t quantity = 0; quantity < kMeasuredQuantities; ++quantity)
    for (std::size_t i = 1; is_measured[quantity] && i < asked.contacts.size(); ++i)
      asked.values.push_back({MeasuredQuantity(quantity), i, 1, 0});
  Eigen::VectorXd logs;
  Eigen::MatrixXd slopes;
  PredictedMeasurements{*problem.model, asked, problem.shear_law, problem.pressing}.evaluate(
      found.values, logs, &slopes);
  const double t = statistics::student_quantile(0.05, found.freedom);
  std::vector<Curve> curves;
  for (Eigen::Index i = 0; i < logs.size(); ++i) {
    const MeasuredQuantity quantity = asked.values[std::size_t(i)].quantity;
    if (curves.empty() || curves.back().quantity != quantity)
      curves.push_back({quantity, {}, {}, {}});
    constexpr double kNoAnswer = 300;  // the logarithm of an absurdly large number
    const double value = logs[i] < kNoAnswer ? std::exp(logs[i]) : std::nan("");
    double reach = std::nan("");
    if (found.covariance.size() > 0) {
      Eigen::VectorXd by(Eigen::Index(problem.free.size()));
      for (std::size_t k = 0; k < problem.free.size(); ++k)
        by[Eigen::Index(k)] = slopes(i, Eigen::Index(index_of(problem.free[k])));
      reach = t * std::sqrt(std::max(0., by.dot(found.covariance * by)));
    }
    Curve& curve = curves.back();
    curve.value.push_back(value);
    curve.low.push_back(value * std::exp(-reach));
    curve.high.push_back(reach < kNoAnswer ? value * std::exp(reach) : std::nan(""));
  }
  return curves;
}

py::list estimates(const Calibration& found) {
  py::list result;
  for (const ParameterEstimate& estimate : found.parameters)
    result.append(py::make_tuple(
        name_of(estimate.parameter), std::string(range_of(estimate.parameter).unit), estimate.value,
        estimate.std, py::make_tuple(estimate.low, estimate.high),
        py::make_tuple(estimate.is_low_open, estimate.is_high_open), estimate.is_determined()));
  return result;
}

/// SI, in the order of the parameters; None where it is not known.
py::object covariance(const CalibrationProblem& problem, const Calibration& found) {
  if (found.covariance.size() == 0) return py::none();
  const py::ssize_t count = py::ssize_t(problem.free.size());
  Numbers result({count, count});
  const auto scale = [&](std::size_t i) {
    const Parameter parameter = problem.free[i];
    return range_of(parameter).logarithmic ? found.values[index_of(parameter)] : 1;
  };
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    for (std::size_t k = 0; k < problem.free.size(); ++k)
      result.mutable_at(i, k) =
          found.covariance(Eigen::Index(i), Eigen::Index(k)) * scale(i) * scale(k);
  return result;
}

py::list comparisons(const std::vector<Comparison>& compared, bool are_laws) {
  py::list result;
  for (const Comparison& comparison : compared) {
    py::dict parameters;
    for (const Parameter parameter : comparison.free)
      parameters[py::str(name_of(parameter))] = comparison.values[index_of(parameter)];
    const std::string name = are_laws ? ShearLaw{comparison.shear_law}.name()
                                      : std::string(comparison.model->card().name);
    result.append(py::make_tuple(name, comparison.aic, comparison.scatter,
                                 comparison.held_out_error, parameters));
  }
  return result;
}

py::object next_of(const NextMeasurement& next) {
  if (!next.exists) return py::none();
  return py::make_tuple(next.is_thickness ? std::string("thickness") : name_of(next.quantity),
                        next.is_thickness ? py::object(py::none()) : py::float_(next.load_N),
                        next.relative_std, name_of(next.parameter), next.std_now, next.std_then);
}

py::dict calibrated(const std::string& model, const py::dict& numbers, const Integers& quantity,
                    const Integers& contact, const Numbers& value, const Numbers& std,
                    int shear_law, int pressing, const std::vector<int>& free, const Numbers& start,
                    const std::vector<double>& curve_loads_N) {
  const Contacts contacts(numbers);
  CalibrationProblem problem;
  problem.model = &model_named(model);
  for (std::size_t i = 0; i < contacts.count(); ++i)
    problem.measurements.contacts.push_back(contacts.problem(i));
  for (py::ssize_t i = 0; i < value.size(); ++i)
    problem.measurements.values.push_back(
        {MeasuredQuantity(quantity.at(i)), std::size_t(contact.at(i)), value.at(i), std.at(i)});
  problem.shear_law = ShearLaw::Kind(shear_law);
  problem.pressing = PressingFriction(pressing);
  for (const int parameter : free) problem.free.push_back(Parameter(parameter));
  for (std::size_t i = 0; i < kParameters; ++i) problem.start[i] = start.at(py::ssize_t(i));
  Findings findings;
  std::vector<Curve> curves;
  {
    const py::gil_scoped_release others_may_run;
    findings = find(problem);
    curves = curves_of(problem, findings.found, curve_loads_N);
  }
  const Calibration& found = findings.found;
  py::dict result, scatter, drawn, values;
  for (std::size_t i = 0; i < kMeasuredQuantities; ++i)
    if (found.scatter[i] > 0) scatter[py::str(name_of(MeasuredQuantity(i)))] = found.scatter[i];
  for (const Curve& curve : curves)
    drawn[py::str(name_of(curve.quantity))] =
        py::make_tuple(array_of(curve.value), array_of(curve.low), array_of(curve.high));
  for (const ParameterRange& range : kParameterRanges)
    values[py::str(std::string(range.name))] = found.values[index_of(range.parameter)];
  result["values"] = values;
  result["parameters"] = estimates(found);
  result["covariance"] = covariance(problem, found);
  result["outliers"] = found.outliers;
  result["predicted"] = array_of(found.predicted);
  result["deviation"] = array_of(found.deviation);
  result["std"] = array_of(findings.std);
  result["goodness"] = py::make_tuple(found.goodness, found.error_factor, found.sum_of_squares);
  result["scatter"] = scatter;
  result["models"] = comparisons(findings.models, false);
  result["shear_laws"] = comparisons(findings.shear_laws, true);
  result["growth_exponent"] =
      findings.growth.is_known
          ? py::object(py::make_tuple(findings.growth.value, findings.growth.std))
          : py::none();
  result["next_measurement"] = next_of(findings.next);
  result["cannot_tell"] = findings.cannot_tell;
  result["curves"] = drawn;
  return result;
}

py::list parameter_ranges() {
  py::list result;
  for (const ParameterRange& range : kParameterRanges)
    result.append(py::make_tuple(std::string(range.name), std::string(range.unit), range.lowest,
                                 range.highest));
  return result;
}

}  // namespace

void bind_calibration(py::module_& module) {
  module.def("calibrate", &calibrated);
  module.def("parameter_ranges", &parameter_ranges);
}

}  // namespace softfinger::python
