#include "softfinger/calibration/forecast.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "softfinger/calibration/statistics.h"
#include "softfinger/math/dense_solvers.h"

namespace softfinger {
namespace {

double force_of_N(const Measurements& measurements, const Measurement& measurement) {
  return measurements.contacts[measurement.contact].load.normal_force_N;
}

bool is_travel(const CalibrationProblem& problem, MeasuredQuantity quantity) {
  return quantity == MeasuredQuantity::indentation && contains(problem.free, Parameter::zero);
}

/// One quantity over the load, without outliers.
PressCurve curve_of(const CalibrationProblem& problem, const Calibration& calibration,
                    MeasuredQuantity quantity) {
  PressCurve curve;
  for (std::size_t i = 0; i < problem.measurements.values.size(); ++i) {
    const Measurement& value = problem.measurements.values[i];
    if (value.quantity != quantity || calibration.is_outlier(i)) continue;
    curve.travel_m.push_back(value.value);
    curve.force_N.push_back(force_of_N(problem.measurements, value));
  }
  return curve;
}

double largest_load_N(const CalibrationProblem& problem) {
  double largest_N = 0;
  for (const Measurement& value : problem.measurements.values)
    largest_N = std::max(largest_N, force_of_N(problem.measurements, value));
  return largest_N;
}

/// The largest relative error of each quantity above half of the largest load, by a fit below.
std::array<double, kMeasuredQuantities> errors_above_half(const CalibrationProblem& problem,
                                                          const Calibration& calibration) {
  std::array<double, kMeasuredQuantities> errors{};
  const double half_N = 0.5 * largest_load_N(problem);
  CalibrationProblem lower = problem;
  Measurements upper{problem.measurements.contacts, {}};
  std::vector<Weight> weights;
  lower.measurements.values.clear();
  for (std::size_t i = 0; i < problem.measurements.values.size(); ++i) {
    const Measurement& value = problem.measurements.values[i];
    if (calibration.is_outlier(i)) continue;
    if (force_of_N(problem.measurements, value) > half_N) {
      upper.values.push_back(value);
      continue;
    }
    lower.measurements.values.push_back(value);
    weights.push_back(calibration.weights[i]);
  }
  if (weights.size() <= problem.free.size() || upper.values.empty()) return errors;
  const PredictedMeasurements below{*problem.model, lower.measurements, problem.shear_law,
                                    problem.pressing};
  const Fit fit = LeastSquares(below, weights, contains(problem.free, Parameter::thickness))
                      .solve(calibration.values, problem.free);
  Eigen::VectorXd logs;
  PredictedMeasurements{*problem.model, upper, problem.shear_law, problem.pressing}.evaluate(
      fit.values, logs, nullptr);
  for (std::size_t i = 0; i < upper.values.size(); ++i) {
    double& error = errors[std::size_t(upper.values[i].quantity)];
    const double predicted = std::exp(std::min(logs[Eigen::Index(i)], 300.));
    error = std::max(error, std::abs(predicted / upper.values[i].value - 1));
  }
  return errors;
}

/// Standard deviation of one more measurement of this quantity where the model says `value`.
double scatter_of(const CalibrationProblem& problem, const Calibration& calibration,
                  MeasuredQuantity quantity, double value) {
  std::vector<double> stds;
  for (std::size_t i = 0; i < problem.measurements.values.size(); ++i)
    if (problem.measurements.values[i].quantity == quantity)
      stds.push_back(calibration.weights[i].is_relative ? calibration.weights[i].std * value
                                                        : calibration.weights[i].std);
  if (stds.empty()) return 0;
  std::nth_element(stds.begin(), stds.begin() + std::ptrdiff_t(stds.size() / 2), stds.end());
  return stds[stds.size() / 2];
}

}  // namespace

std::vector<Forecast> forecast(const CalibrationProblem& problem, const Calibration& calibration,
                               const Measurements& asked) {
  const PredictedMeasurements predicted{*problem.model, asked, problem.shear_law, problem.pressing};
  Eigen::VectorXd logs;
  Eigen::MatrixXd slopes;
  predicted.evaluate(calibration.values, logs, &slopes);
  const double t = statistics::student_quantile(0.05, calibration.freedom);
  const double largest_N = largest_load_N(problem);
  const auto inner = errors_above_half(problem, calibration);
  std::array<CurveExponent, kMeasuredQuantities> trends;
  for (std::size_t q = 0; q < kMeasuredQuantities; ++q)
    trends[q] = curve_exponent(curve_of(problem, calibration, MeasuredQuantity(q)),
                               !is_travel(problem, MeasuredQuantity(q)));
  std::vector<Forecast> result;
  for (std::size_t i = 0; i < asked.values.size(); ++i) {
    const MeasuredQuantity quantity = asked.values[i].quantity;
    const double force_N = force_of_N(asked, asked.values[i]);
    const double log_value = logs[Eigen::Index(i)];
    Forecast one;
    // The covariance is empty where some combination of parameters is not known at all.
    if (log_value < 300 && calibration.covariance.size() > 0) {
      one.value = std::exp(log_value);
      Eigen::VectorXd own(Eigen::Index(problem.free.size()));
      for (std::size_t k = 0; k < problem.free.size(); ++k)
        own[Eigen::Index(k)] =
            one.value * slopes(Eigen::Index(i), Eigen::Index(index_of(problem.free[k])));
      const double variance = own.dot(calibration.covariance * own);
      const double scatter = scatter_of(problem, calibration, quantity, one.value);
      one.chance = t * std::sqrt(std::max(0., variance) + scatter * scatter);
      one.is_known = std::isfinite(one.chance);
      if (const double ratio = force_N / largest_N; ratio > 1) {
        const CurveExponent& trend = trends[std::size_t(quantity)];
        one.is_known = one.is_known && trend.is_known;
        if (trend.is_known)
          for (const CurveExponent::Law& law : {trend.best, trend.at_low, trend.at_high})
            one.misfit = std::max(one.misfit, std::abs(law.travel_m(force_N) - one.value));
        one.misfit += inner[std::size_t(quantity)] * std::log2(ratio) * one.value;
      }
    }
    result.push_back(one);
  }
  return result;
}

ExponentDoubt exponent_doubt(const CalibrationProblem& problem, const Calibration* calibration) {
  const bool is_zero_known = !is_travel(problem, MeasuredQuantity::indentation);
  const bool is_compliance_free = contains(problem.free, Parameter::compliance);
  // A fitted mount's part is known after the calibration only.
  if (is_compliance_free && !calibration) return {};
  const ParameterValues& values = calibration ? calibration->values : problem.start;
  const double compliance_m_per_N = values[index_of(Parameter::compliance)];
  const double zero_m = values[index_of(Parameter::zero)];
  const double largest_N = largest_load_N(problem);
  for (const double from : {0.05, 0.5}) {
    PressCurve measured, of_model;
    for (std::size_t i = 0; i < problem.measurements.values.size(); ++i) {
      const Measurement& value = problem.measurements.values[i];
      const double force_N = force_of_N(problem.measurements, value);
      if (value.quantity != MeasuredQuantity::indentation || force_N < from * largest_N) continue;
      const double given_m = compliance_m_per_N * force_N;
      measured.force_N.push_back(force_N);
      measured.travel_m.push_back(value.value - given_m - (is_zero_known ? zero_m : 0));
      if (!calibration) continue;
      of_model.force_N.push_back(force_N);
      of_model.travel_m.push_back(calibration->predicted[i] - zero_m - given_m);
    }
    // Fewer points tell no exponent from another.
    constexpr std::size_t kLeastPoints = 6;
    if (measured.force_N.size() < kLeastPoints) continue;
    const CurveExponent found = curve_exponent(measured, is_zero_known);
    const CurveExponent expected = curve_exponent(of_model, true);
    const double most = 1.5 * std::max(kLeastSolidExponent, expected.value);
    const bool is_too_low = found.high < 0.5 * (1 + kLeastSolidExponent);
    const bool is_too_high = expected.is_known && found.low > most;
    if (found.is_known && (is_too_low || is_too_high))
      return {true, found, kLeastSolidExponent, expected.is_known ? most : 0, from * largest_N};
  }
  return {};
}

}  // namespace softfinger
