#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "comparisons/experiments/examine.h"
#include "softfinger/calibration/forecast.h"
#include "softfinger/input/errors.h"

namespace softfinger::experiments {
namespace {

/// The loading branch after the touch, as a calibration of modulus and zero.
CalibrationProblem press_problem(const PressCurves& data, const PressCurves::Curve& curve,
                                 const char* model, double up_to_N, double from_N = 0) {
  CalibrationProblem problem;
  problem.model = find_pressure_model(model);
  problem.free = {Parameter::youngs_modulus, Parameter::zero};
  problem.pressing = PressingFriction::stuck;  // as silicone does on a plate
  problem.start[index_of(Parameter::youngs_modulus)] = 1e5;
  problem.start[index_of(Parameter::thickness)] = data.thickness_m;
  problem.start[index_of(Parameter::poisson_ratio)] = data.poisson_ratio;
  problem.start[index_of(Parameter::radius)] = data.sphere_radius_m;
  for (std::size_t i = 1; i < curve.loading_N.size(); ++i) {
    const double load_N = curve.loading_N[i];
    if (!(load_N > 0) || load_N > up_to_N || load_N <= from_N) continue;
    ContactProblem contact;
    contact.radii = {data.sphere_radius_m, data.sphere_radius_m, 0};
    contact.finger_curvature = {1 / data.sphere_radius_m, 1 / data.sphere_radius_m, 0};
    contact.layer = {data.thickness_m, 1e5, data.poisson_ratio};
    contact.load.normal_force_N = load_N;
    problem.measurements.contacts.push_back(contact);
    problem.measurements.values.push_back({MeasuredQuantity::indentation,
                                           problem.measurements.contacts.size() - 1,
                                           data.step_m * double(i), 0});
  }
  return problem;
}

double largest_N(const PressCurves::Curve& curve) {
  return *std::max_element(curve.loading_N.begin(), curve.loading_N.end());
}

Loop loop_of(const PressCurves& data, const PressCurves::Curve& curve) {
  PressCurve loading, unloading;
  for (std::size_t i = 0; i < curve.loading_N.size(); ++i) {
    loading.travel_m.push_back(data.step_m * double(i));
    loading.force_N.push_back(curve.loading_N[i]);
  }
  for (std::size_t i = 0; i < curve.unloading_N.size(); ++i) {
    unloading.travel_m.push_back(data.step_m * double(curve.loading_N.size() - 1 - i));
    unloading.force_N.push_back(curve.unloading_N[i]);
  }
  return loop_between(loading, unloading);
}

/// A model calibrated below half of the largest load, at the largest.
struct UpperHalf {
  double measured_m = 0, scatter_m = 0, youngs_modulus_Pa = 0;
  Forecast last;
  int values = 0, inside = 0;
};

std::optional<UpperHalf> upper_half(const PressCurves& data, const PressCurves::Curve& curve,
                                    const char* model) {
  const double half_N = 0.5 * largest_N(curve);
  const CalibrationProblem problem = press_problem(data, curve, model, half_N);
  Measurements asked = press_problem(data, curve, model, INFINITY, half_N).measurements;
  // Fewer points leave no scatter to judge by.
  if (problem.measurements.values.size() < 5 || asked.values.empty()) return std::nullopt;
  try {
    const Calibration found = calibrate(problem);
    const std::vector<Forecast> forecasts = forecast(problem, found, asked);
    UpperHalf result;
    for (std::size_t i = 0; i < forecasts.size(); ++i) {
      if (!forecasts[i].is_known) return std::nullopt;
      const double measured_m = asked.values[i].value;
      ++result.values;
      result.inside += forecasts[i].low() <= measured_m && measured_m <= forecasts[i].high();
    }
    result.last = forecasts.back();
    result.measured_m = asked.values.back().value;
    result.scatter_m = found.scatter[std::size_t(MeasuredQuantity::indentation)] *
                       problem.measurements.values.back().value;
    result.youngs_modulus_Pa = found.values[index_of(Parameter::youngs_modulus)];
    return result;
  } catch (const InputError&) {
    return std::nullopt;  // the model has no answer for this curve
  }
}

void predict_upper_half(const PressCurves& data, const PressCurves::Curve& curve, bool is_solid,
                        Examined& examined) {
  struct Theory {
    const char* model;
    Role role;
  };
  for (const auto& [model, role] : {Theory{"fingertip_layer", Role::theory},
                                    Theory{"hertz", Role::rival}, Theory{"winkler", Role::rival}}) {
    const std::optional<UpperHalf> upper = upper_half(data, curve, model);
    if (!upper) continue;
    Finding finding;
    finding.test = fmt::format("{}: travel at {:.3g} N, calibrated below half of it", curve.code,
                               largest_N(curve));
    finding.model = model;
    finding.role = role;
    finding.unit = "m";
    finding.measured = upper->measured_m;
    finding.uncertainty = 0.5 * data.step_m;
    finding.predicted = {upper->last.value, upper->last.low(), upper->last.high()};
    finding.verdict = is_solid ? upper->inside == upper->values ? Verdict::agrees : Verdict::fails
                               : Verdict::cannot_tell;
    finding.reason =
        fmt::format("{} of {} values of the upper half lie in the band; E {:.3g} kPa{}",
                    upper->inside, upper->values, 1e-3 * upper->youngs_modulus_Pa,
                    is_solid ? "." : ", but this is not the curve of a solid finger.");
    examined.findings.push_back(finding);
  }
}

}  // namespace

void examine_press_curves(const PressCurves& data, Examined& examined) {
  int hollow = 0, hollow_refused = 0, others = 0, others_refused = 0;
  for (const PressCurves::Curve& curve : data.curves) {
    const CalibrationProblem problem = press_problem(data, curve, "fingertip_layer", INFINITY);
    const ExponentDoubt doubt = exponent_doubt(problem, nullptr);
    ++(curve.hollow ? hollow : others);
    if (doubt.exists) ++(curve.hollow ? hollow_refused : others_refused);
    if (doubt.exists)
      examined.inferred.push_back(
          {"force_exponent",
           "",
           fmt::format("{} ({}), above {:.2g} N: not a solid finger's, 1.5 or more", curve.code,
                       curve.description, doubt.from_load_N),
           {doubt.measured.value, doubt.measured.low, doubt.measured.high}});
    const Loop loop = loop_of(data, curve);
    if (loop.is_known) {
      examined.inferred.push_back(
          {"backlash", "m", curve.code, {loop.backlash_m, loop.backlash_m, loop.backlash_m}});
      examined.inferred.push_back(
          {"hysteresis",
           "%",
           curve.code,
           {loop.hysteresis_share, loop.hysteresis_share, loop.hysteresis_share}});
    }
    predict_upper_half(data, curve, !doubt.exists && !curve.hollow, examined);
  }
  examined.sentence = fmt::format(
      "Of {} curves of fingertips that are called hollow {} are refused as such by their exponent, "
      "of {} others {}.",
      hollow, hollow_refused, others, others_refused);
}

}  // namespace softfinger::experiments
