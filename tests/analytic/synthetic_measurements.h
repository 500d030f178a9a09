#pragma once

#include <cmath>
#include <random>

#include "softfinger/calibration/calibrate.h"
#include "softfinger/pressure/pressure_model.h"

/// Fingers, and what somebody with a scale and a ruler would write down of them.
namespace softfinger::test {

/// A calibration whose answer is known.
struct SyntheticCalibration {
  CalibrationProblem problem;
  ParameterValues truth{};
  double noise = 0;  ///< relative
  int outliers = 0;
};

/// A random finger over the error atlas' domain: R 5 to 50 mm, R'/R'' 1 to 4, h/R 0.03 to 0.4, nu 0
/// to 1/2, E 0.05 to 5 MPa, 5 to 20 loads over a factor of 5 to 50 up to d/h = 0.05 to 0.4; noise
/// 1, 3 or 10 %; one set in five has outliers, 1.5 to 3 times too large or small. Thickness and
/// modulus are looked for, the friction coefficient where friction is measured, and Poisson's ratio
/// in a quarter of the sets with an approach.
inline SyntheticCalibration random_calibration(unsigned seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * std::generate_canonical<double, 53>(random);
  };
  const auto log_uniform = [&](double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  };
  SyntheticCalibration result;
  result.problem.model = find_pressure_model("fingertip_layer");
  ParameterValues& truth = result.truth;
  const auto value = [&](Parameter parameter) -> double& { return truth[std::size_t(parameter)]; };
  ContactProblem contact;
  const double R = log_uniform(5e-3, 50e-3), ratio = log_uniform(1, 4);
  contact.radii = {R * std::sqrt(ratio), R / std::sqrt(ratio), 0};
  const double h = R * log_uniform(0.03, 0.4);
  const double finger = uniform(0, 1);  // the finger's part of the curvature
  contact.finger_curvature = {finger / contact.radii.major_m, finger / contact.radii.minor_m, 0};
  contact.layer = {h, log_uniform(5e4, 5e6),
                   uniform(0, 1) < 0.5 ? uniform(0.45, 0.5) : uniform(0, 0.5)};
  contact.load = {1, uniform(0.2, 1.5)};
  value(Parameter::youngs_modulus) = contact.layer.youngs_modulus_Pa;
  value(Parameter::thickness) = h;
  value(Parameter::poisson_ratio) = contact.layer.poisson_ratio;
  value(Parameter::radius) = R;
  value(Parameter::friction_coefficient) = contact.load.friction_coefficient;
  value(Parameter::shear_strength) = 1e4;
  value(Parameter::radius_coefficient) = 1e-3;
  value(Parameter::radius_exponent) = 0.3;

  // The largest load by bisection on the approach.
  const double deepest = h * uniform(0.05, 0.4);
  double low = 1e-6, high = 1e6;
  for (int i = 0; i < 60; ++i) {
    contact.load.normal_force_N = std::sqrt(low * high);
    const double depth = result.problem.model->predict(contact).indentation_m;
    (depth < deepest ? low : high) = contact.load.normal_force_N;
  }
  const double largest_N = contact.load.normal_force_N, span = log_uniform(5, 50);
  const int loads = int(uniform(5, 21));
  result.noise = std::array{0.01, 0.03, 0.1}[std::size_t(uniform(0, 3))];
  std::vector<MeasuredQuantity> quantities;
  const bool is_round = uniform(0, 1) < 0.5;
  if (is_round)
    quantities.push_back(MeasuredQuantity::area);
  else {
    quantities.push_back(MeasuredQuantity::a);
    quantities.push_back(MeasuredQuantity::b);
  }
  if (uniform(0, 1) < 0.6) quantities.push_back(MeasuredQuantity::indentation);
  if (uniform(0, 1) < 0.4) quantities.push_back(MeasuredQuantity::max_torque);
  if (uniform(0, 1) < 0.3) quantities.push_back(MeasuredQuantity::tangential_force);
  const bool has_outliers = uniform(0, 1) < 0.2;
  const bool has_errors = uniform(0, 1) < 0.3;  // and says so

  Measurements& measurements = result.problem.measurements;
  std::normal_distribution<double> normal;
  for (int i = 0; i < loads; ++i) {
    contact.load.normal_force_N = largest_N * std::pow(span, double(i) / (loads - 1) - 1);
    measurements.contacts.push_back(contact);
  }
  const PredictedMeasurements exact{*result.problem.model, measurements};
  for (std::size_t i = 0; i < measurements.contacts.size(); ++i)
    for (const MeasuredQuantity quantity : quantities)
      measurements.values.push_back({quantity, i, 1, 0});
  Eigen::VectorXd log_values;
  exact.evaluate(truth, log_values, nullptr);
  for (std::size_t i = 0; i < measurements.values.size(); ++i) {
    Measurement& measurement = measurements.values[i];
    const double right = std::exp(log_values[Eigen::Index(i)]);
    measurement.value = right * std::max(0.05, 1 + result.noise * normal(random));
    if (has_errors) measurement.std = result.noise * measurement.value;
    if (has_outliers && uniform(0, 1) < 0.08) {
      const double factor = uniform(1.5, 3);
      measurement.value *= uniform(0, 1) < 0.5 ? factor : 1 / factor;
      ++result.outliers;
    }
  }
  std::vector<Parameter>& free = result.problem.free;
  free = {Parameter::youngs_modulus, Parameter::thickness};
  bool measures_approach = false, measures_friction = false;
  for (const MeasuredQuantity quantity : quantities) {
    measures_approach = measures_approach || quantity == MeasuredQuantity::indentation;
    measures_friction = measures_friction || is_frictional(quantity);
  }
  if (measures_approach && uniform(0, 1) < 0.25) free.push_back(Parameter::poisson_ratio);
  if (measures_friction) free.push_back(Parameter::friction_coefficient);
  // Whoever calibrates does not know the answer.
  result.problem.start = truth;
  for (const Parameter parameter : free) {
    double& start = result.problem.start[std::size_t(parameter)];
    start = parameter == Parameter::poisson_ratio ? 0.45 : start * log_uniform(0.3, 3);
  }
  return result;
}

}  // namespace softfinger::test
