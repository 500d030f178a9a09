#include "softfinger/calibration/advice.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "softfinger/calibration/statistics.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/math/dense_solvers.h"

namespace softfinger {
namespace {

constexpr double kNoLimit_N = std::numeric_limits<double>::infinity();

bool measures(const CalibrationProblem& problem, MeasuredQuantity quantity) {
  const auto& values = problem.measurements.values;
  return std::any_of(values.begin(), values.end(), [&](const Measurement& measurement) {
    return measurement.quantity == quantity;
  });
}

bool measures_friction(const CalibrationProblem& problem) {
  return measures(problem, MeasuredQuantity::max_torque) ||
         measures(problem, MeasuredQuantity::tangential_force);
}

double load_N(const CalibrationProblem& problem, const Measurement& measurement) {
  return problem.measurements.contacts[measurement.contact].load.normal_force_N;
}

template <class... Numbers>
std::string text(const char* format, Numbers... numbers) {
  char buffer[512];
  std::snprintf(buffer, sizeof buffer, format, numbers...);
  return buffer;
}

/// A parameter's value as people write it: mm, kPa.
std::string in_words(Parameter parameter, double value) {
  const std::string_view unit = range_of(parameter).unit;
  if (unit == "m") return text("%.3g mm", value * 1e3);
  if (unit == "Pa") return text("%.3g kPa", value * 1e-3);
  if (unit == "m/N") return text("%.3g mm/N", value * 1e3);
  return text("%.3g", value);
}

std::string name_in_words(Parameter parameter) {
  switch (parameter) {
    case Parameter::youngs_modulus:
      return "E";
    case Parameter::thickness:
      return "the thickness";
    case Parameter::poisson_ratio:
      return "nu";
    case Parameter::radius:
      return "the radius";
    case Parameter::friction_coefficient:
      return "mu";
    case Parameter::shear_strength:
      return "tau_0";
    case Parameter::radius_coefficient:
      return "c";
    case Parameter::radius_exponent:
      return "gamma";
    case Parameter::zero:
      return "the zero of the indentation";
    case Parameter::compliance:
      return "the compliance of machine and mount";
  }
  return {};
}

std::string symbol(Parameter parameter) {
  return parameter == Parameter::thickness ? "h"
         : parameter == Parameter::radius  ? "R"
                                           : name_in_words(parameter);
}

/// Returns the parameters on which a model's answers depend, out of those that are fitted.
std::vector<Parameter> parameters_of(const CalibrationProblem& problem, const ModelCard& model) {
  std::vector<Parameter> result;
  if (model.is_empirical) result = {Parameter::radius_coefficient, Parameter::radius_exponent};
  const bool fits_modulus = contains(problem.free, Parameter::youngs_modulus);
  const auto depends_on = [&](Parameter parameter) {
    const bool is_of_layer =
        parameter == Parameter::thickness || parameter == Parameter::poisson_ratio;
    switch (model.layer_constants) {
      case LayerConstants::all:
        return true;
      case LayerConstants::plane_strain_modulus:
        return !is_of_layer;
      case LayerConstants::foundation_modulus:  // one of E, nu and h stands for all
        return !is_of_layer || !fits_modulus;
      case LayerConstants::none:
        break;
    }
    return parameter == Parameter::friction_coefficient || parameter == Parameter::shear_strength ||
           range_of(parameter).is_nuisance;
  };
  std::copy_if(problem.free.begin(), problem.free.end(), std::back_inserter(result), depends_on);
  return result;
}

/// The problem with another model, without what does not count or, if asked, the upper loads.
struct Reduced {
  CalibrationProblem problem;
  std::vector<Weight> weights;
};

Reduced reduced(const CalibrationProblem& problem, const Calibration& calibration,
                double below_load_N) {
  Reduced result{problem, {}};
  auto& values = result.problem.measurements.values;
  values.clear();
  for (std::size_t i = 0; i < problem.measurements.values.size(); ++i) {
    const Measurement& measurement = problem.measurements.values[i];
    if (calibration.is_outlier(i) || load_N(problem, measurement) >= below_load_N) continue;
    values.push_back(measurement);
    result.weights.push_back(calibration.weights[i]);
  }
  return result;
}

/// The load from which on the upper third of the loads is held out.
double upper_third_N(const CalibrationProblem& problem) {
  std::vector<double> loads_N;
  for (const ContactProblem& contact : problem.measurements.contacts)
    loads_N.push_back(contact.load.normal_force_N);
  std::sort(loads_N.begin(), loads_N.end());
  return loads_N[loads_N.size() - std::max<std::size_t>(1, loads_N.size() / 3)];
}

/// Fits the free parameters; with a thickness, from thin and thick layers too.
Fit fit_of(const LeastSquares& squares, ParameterValues start, const std::vector<Parameter>& free) {
  Fit best = squares.solve(start, free);
  if (!contains(free, Parameter::thickness)) return best;
  for (const double factor : {0.3, 3.}) {
    ParameterValues other = start;
    other[index_of(Parameter::thickness)] *= factor;
    const Fit fit = squares.solve(other, free);
    if (fit.sum_of_squares < best.sum_of_squares) best = fit;
  }
  return best;
}

/// Relative deviations of what counts.
double root_mean_square(const PredictedMeasurements& predicted, const ParameterValues& values) {
  Eigen::VectorXd logs;
  predicted.evaluate(values, logs, nullptr);
  double sum = 0;
  for (Eigen::Index i = 0; i < logs.size(); ++i) {
    const double part =
        predicted.measurements.values[std::size_t(i)].value / std::exp(std::min(logs[i], 300.)) - 1;
    sum += part * part;
  }
  return std::sqrt(sum / double(logs.size()));
}

/// Fits one model or law for the comparison; a fit whose scatter is not below 100 % counts as no
/// answer.
Comparison compare(const CalibrationProblem& problem, const Calibration& calibration) {
  Comparison result{problem.model, problem.shear_law, problem.free, {}, 0, 0};
  const Reduced all = reduced(problem, calibration, kNoLimit_N);
  const PredictedMeasurements predicted{*problem.model, all.problem.measurements, problem.shear_law,
                                        problem.pressing};
  const bool has_thickness = contains(problem.free, Parameter::thickness);
  const Fit fit =
      fit_of(LeastSquares(predicted, all.weights, has_thickness), problem.start, problem.free);
  result.values = fit.values;
  result.scatter = root_mean_square(predicted, fit.values);
  const double count = double(all.weights.size());
  const bool has_own_errors =
      std::all_of(all.problem.measurements.values.begin(), all.problem.measurements.values.end(),
                  [](const Measurement& measurement) { return measurement.std > 0; });
  // An estimated scatter counts as one more parameter, and each model estimates its own.
  result.aic = has_own_errors ? fit.sum_of_squares + 2 * double(problem.free.size())
                              : count * std::log(std::max(fit.sum_of_squares, 1e-12) / count) +
                                    2 * (double(problem.free.size()) + 1);
  const double split_N = upper_third_N(problem);
  const Reduced lower = reduced(problem, calibration, split_N);
  Measurements upper{problem.measurements.contacts, {}};
  for (const Measurement& measurement : all.problem.measurements.values)
    if (load_N(problem, measurement) >= split_N) upper.values.push_back(measurement);
  if (lower.weights.size() <= problem.free.size() || upper.values.empty()) return result;
  const PredictedMeasurements below{*problem.model, lower.problem.measurements, problem.shear_law,
                                    problem.pressing};
  const Fit from_below =
      fit_of(LeastSquares(below, lower.weights, has_thickness), fit.values, problem.free);
  result.held_out_error = root_mean_square(
      {*problem.model, upper, problem.shear_law, problem.pressing}, from_below.values);
  return result;
}

void sort_by_aic(std::vector<Comparison>& comparisons) {
  std::stable_sort(
      comparisons.begin(), comparisons.end(),
      [](const Comparison& one, const Comparison& other) { return one.aic < other.aic; });
}

/// J^T J of the measurements that count and of the limit of compression, as the fit has it, in the
/// coordinates of the parameters.
Eigen::MatrixXd information(const CalibrationProblem& problem, const Calibration& calibration) {
  const PredictedMeasurements predicted{*problem.model, problem.measurements, problem.shear_law,
                                        problem.pressing};
  std::vector<Weight> weights = calibration.weights;
  for (const std::size_t outlier : calibration.outliers) weights[outlier].counts = false;
  const Eigen::MatrixXd slopes =
      LeastSquares(predicted, weights, contains(problem.free, Parameter::thickness))
          .jacobian(calibration.values, problem.free);
  return internal::gram(slopes);
}

/// Standard deviation of the coordinate `index`; infinite where nothing is known of it.
double std_of(const Eigen::MatrixXd& information, Eigen::Index index) {
  const internal::SymmetricEigen eigen = internal::symmetric_eigen(information);
  const double largest = eigen.values[information.rows() - 1];
  double variance = 0;
  for (Eigen::Index k = 0; k < information.rows(); ++k) {
    const double part = eigen.vectors(index, k);
    if (std::abs(part) < 1e-9) continue;
    if (!(eigen.values[k] > 1e-12 * largest)) return std::numeric_limits<double>::infinity();
    variance += part * part / eigen.values[k];
  }
  return std::sqrt(variance);
}

}  // namespace

std::vector<Comparison> compare_models(const CalibrationProblem& problem,
                                       const Calibration& calibration) {
  std::vector<Comparison> result;
  for (const PressureModel* model : all_pressure_models()) {
    if (!model->card().is_calibrated) continue;
    CalibrationProblem other = problem;
    other.model = model;
    other.free = parameters_of(problem, model->card());
    other.start = calibration.values;
    if (model->card().is_empirical) {
      // The indentation is no part of that law, and its contact is round.
      if (measures(problem, MeasuredQuantity::indentation)) continue;
      const GrowthExponent growth = growth_exponent(problem, calibration);
      if (!growth.is_known) continue;
      const ParameterRange& exponents = range_of(Parameter::radius_exponent);
      other.start[index_of(Parameter::radius_exponent)] =
          std::clamp(growth.value, exponents.lowest, exponents.highest);
      for (ContactProblem& contact : other.measurements.contacts)
        contact.options.power_law = {other.start[index_of(Parameter::radius_coefficient)],
                                     other.start[index_of(Parameter::radius_exponent)],
                                     contact.options.power_law.pressure_exponent};
    }
    if (other.free.empty()) continue;
    const Comparison comparison = compare(other, calibration);
    if (comparison.scatter < 1) result.push_back(comparison);
  }
  sort_by_aic(result);
  return result;
}

std::vector<Comparison> compare_shear_laws(const CalibrationProblem& problem,
                                           const Calibration& calibration) {
  std::vector<Comparison> result;
  if (!measures_friction(problem)) return result;
  using Kind = ShearLaw::Kind;
  for (const Kind law :
       {Kind::coulomb, Kind::shear_strength, Kind::limited, Kind::adhesive_shear}) {
    CalibrationProblem other = problem;
    other.shear_law = law;
    other.start = calibration.values;
    other.free.clear();
    for (const Parameter parameter : problem.free)
      if (parameter != Parameter::friction_coefficient && parameter != Parameter::shear_strength)
        other.free.push_back(parameter);
    if (ShearLaw{law}.has_friction_coefficient())
      other.free.push_back(Parameter::friction_coefficient);
    if (ShearLaw{law}.has_shear_strength()) other.free.push_back(Parameter::shear_strength);
    const Comparison comparison = compare(other, calibration);
    if (comparison.scatter < 1) result.push_back(comparison);
  }
  sort_by_aic(result);
  return result;
}

GrowthExponent growth_exponent(const CalibrationProblem& problem, const Calibration& calibration) {
  // Each quantity has a coefficient of its own and shares the exponent; an area counts by its root.
  struct Sums {
    double weight = 0, x = 0, y = 0;
  };
  std::array<Sums, kMeasuredQuantities> sums{};
  const auto counts = [&](std::size_t i) {
    const MeasuredQuantity quantity = problem.measurements.values[i].quantity;
    return !calibration.is_outlier(i) &&
           (quantity == MeasuredQuantity::a || quantity == MeasuredQuantity::b ||
            quantity == MeasuredQuantity::area);
  };
  const auto point = [&](std::size_t i, double* x, double* y, double* weight) {
    const Measurement& measurement = problem.measurements.values[i];
    const double half = measurement.quantity == MeasuredQuantity::area ? 0.5 : 1;
    const Weight& fitted = calibration.weights[i];
    const double std = half * (fitted.is_relative ? fitted.std : fitted.std / measurement.value);
    *x = std::log(load_N(problem, measurement));
    *y = half * std::log(measurement.value);
    *weight = 1 / (std * std);
  };
  double x = 0, y = 0, weight = 0;
  for (std::size_t i = 0; i < problem.measurements.values.size(); ++i) {
    if (!counts(i)) continue;
    point(i, &x, &y, &weight);
    Sums& sum = sums[std::size_t(problem.measurements.values[i].quantity)];
    sum.weight += weight;
    sum.x += weight * x;
    sum.y += weight * y;
  }
  double sum_xx = 0, sum_xy = 0;
  for (std::size_t i = 0; i < problem.measurements.values.size(); ++i) {
    if (!counts(i)) continue;
    point(i, &x, &y, &weight);
    const Sums& sum = sums[std::size_t(problem.measurements.values[i].quantity)];
    const double from_mean = x - sum.x / sum.weight;
    sum_xx += weight * from_mean * from_mean;
    sum_xy += weight * from_mean * (y - sum.y / sum.weight);
  }
  if (!(sum_xx > 0)) return {};
  return {true, sum_xy / sum_xx, 1 / std::sqrt(sum_xx)};
}

NextMeasurement next_measurement(const CalibrationProblem& problem,
                                 const Calibration& calibration) {
  NextMeasurement best;
  const Eigen::MatrixXd now = information(problem, calibration);
  Eigen::Index worst = 0;
  double largest = 0;
  for (std::size_t i = 0; i < problem.free.size(); ++i) {
    // A nuisance is found with the others; nobody measures for its sake.
    if (range_of(problem.free[i]).is_nuisance && problem.free.size() > 1) continue;
    const double std = std_of(now, Eigen::Index(i));
    // Half its range is no knowledge of nu.
    const double relative = range_of(problem.free[i]).logarithmic ? std : std / 0.25;
    if (!(relative > largest)) continue;
    largest = relative;
    worst = Eigen::Index(i);
  }
  best.parameter = problem.free[std::size_t(worst)];
  best.std_now = best.std_then = std_of(now, worst);
  double std = 0.03;  // where errors are known for no measurement
  std::vector<double> stds;
  for (std::size_t i = 0; i < calibration.weights.size(); ++i)
    stds.push_back(calibration.weights[i].is_relative
                       ? calibration.weights[i].std
                       : calibration.weights[i].std / problem.measurements.values[i].value);
  std::sort(stds.begin(), stds.end());
  if (!stds.empty()) std = std::max(1e-3, stds[stds.size() / 2]);
  const auto consider = [&](const Eigen::VectorXd& slopes, const NextMeasurement& candidate) {
    const double then = std_of(now + slopes * slopes.transpose(), worst);
    // A gain of less than a tenth does not justify another measurement.
    if (!(then < 0.9 * best.std_now) || (best.exists && !(then < best.std_then))) return;
    const double before = best.std_now;
    const Parameter parameter = best.parameter;
    best = candidate;
    best.exists = true;
    best.parameter = parameter;
    best.std_now = before;
    best.std_then = then;
  };
  for (std::size_t i = 0; i < problem.free.size(); ++i) {
    if (problem.free[i] != Parameter::thickness) continue;
    constexpr double kCaliper = 0.05;
    Eigen::VectorXd slopes = Eigen::VectorXd::Zero(Eigen::Index(problem.free.size()));
    slopes[Eigen::Index(i)] = 1 / kCaliper;
    NextMeasurement candidate;
    candidate.is_thickness = true;
    candidate.relative_std = kCaliper;
    consider(slopes, candidate);
  }
  const auto [least, most] = std::minmax_element(
      problem.measurements.contacts.begin(), problem.measurements.contacts.end(),
      [](const ContactProblem& one, const ContactProblem& other) {
        return one.load.normal_force_N < other.load.normal_force_N;
      });
  Measurements further{{*least, *most, *most}, {}};
  further.contacts[2].load.normal_force_N *= 2;
  for (std::size_t contact = 0; contact < further.contacts.size(); ++contact)
    for (std::size_t quantity = 0; quantity < kMeasuredQuantities; ++quantity) {
      if (is_frictional(MeasuredQuantity(quantity)) && !measures_friction(problem)) continue;
      further.values.push_back({MeasuredQuantity(quantity), contact, 1, std});
    }
  const PredictedMeasurements predicted{*problem.model, further, problem.shear_law,
                                        problem.pressing};
  const std::vector<Weight> weights(further.values.size(), Weight{std, true, 0, true});
  const Eigen::MatrixXd slopes =
      LeastSquares(predicted, weights, false).jacobian(calibration.values, problem.free);
  for (std::size_t i = 0; i < further.values.size(); ++i) {
    NextMeasurement candidate;
    candidate.quantity = further.values[i].quantity;
    candidate.load_N = further.contacts[further.values[i].contact].load.normal_force_N;
    candidate.relative_std = std;
    consider(slopes.row(Eigen::Index(i)).transpose(), candidate);
  }
  return best;
}

std::vector<std::string> cannot_tell(const CalibrationProblem& problem,
                                     const Calibration& calibration) {
  std::vector<std::string> sentences;
  std::vector<Parameter> open;
  for (const ParameterEstimate& estimate : calibration.parameters) {
    if (estimate.is_determined()) continue;
    const Parameter parameter = estimate.parameter;
    open.push_back(parameter);
    const std::string name = name_in_words(parameter);
    if (estimate.is_low_open && estimate.is_high_open)
      sentences.push_back("nothing is known of " + name + ": any value fits");
    else if (estimate.is_high_open)
      sentences.push_back("any value of " + name + " above " + in_words(parameter, estimate.low) +
                          " fits");
    else if (estimate.is_low_open)
      sentences.push_back("any value of " + name + " below " + in_words(parameter, estimate.high) +
                          " fits");
    else
      sentences.push_back(name + " is only known to lie between " +
                          in_words(parameter, estimate.low) + " and " +
                          in_words(parameter, estimate.high));
  }
  if (open.empty()) return sentences;
  const GrowthExponent growth = growth_exponent(problem, calibration);
  if (growth.is_known && contains(open, Parameter::thickness)) {
    const double t = statistics::student_quantile(0.05, calibration.freedom);
    const std::string measured =
        text("the contact grows with P^%.3f, give or take %.3f", growth.value, t * growth.std);
    const double least = growth.value - t * growth.std, most = growth.value + t * growth.std;
    if (most > 0.325 && least > 0.18)
      sentences.push_back(
          measured +
          ": like that of a body without a core (1/3), so that the thickness "
          "cannot be told from above; smaller contacts tell nothing, larger ones do");
    else if (most <= 0.325 && least < 0.18)
      sentences.push_back(measured +
                          ": like that of a thin incompressible layer (1/6), of which only E/h³ "
                          "and nu are seen together; measure the approach, or the thickness");
    else
      sentences.push_back(measured + ": not well enough to tell a/h from it");
  }
  // Finds the best determined product of powers of two undetermined parameters.
  const Eigen::MatrixXd known = information(problem, calibration);
  for (std::size_t i = 0; i < problem.free.size(); ++i)
    for (std::size_t k = i + 1; k < problem.free.size(); ++k) {
      const Parameter one = problem.free[i], other = problem.free[k];
      if (!contains(open, one) || !contains(open, other) || !range_of(one).logarithmic ||
          !range_of(other).logarithmic)
        continue;
      // With the others at their best: the Schur complement.
      std::vector<Eigen::Index> rest;
      for (std::size_t n = 0; n < problem.free.size(); ++n)
        if (n != i && n != k) rest.push_back(Eigen::Index(n));
      Eigen::Matrix2d pair;
      const std::array<Eigen::Index, 2> both{Eigen::Index(i), Eigen::Index(k)};
      Eigen::MatrixXd cross(2, Eigen::Index(rest.size())),
          corner(Eigen::Index(rest.size()), Eigen::Index(rest.size()));
      for (int row = 0; row < 2; ++row) {
        for (int column = 0; column < 2; ++column)
          pair(row, column) = known(both[std::size_t(row)], both[std::size_t(column)]);
        for (std::size_t n = 0; n < rest.size(); ++n)
          cross(row, Eigen::Index(n)) = known(both[std::size_t(row)], rest[n]);
      }
      for (std::size_t n = 0; n < rest.size(); ++n)
        for (std::size_t m = 0; m < rest.size(); ++m)
          corner(Eigen::Index(n), Eigen::Index(m)) = known(rest[n], rest[m]);
      if (!rest.empty()) pair -= cross * internal::pseudo_inverse(corner) * cross.transpose();
      const internal::SymmetricEigen eigen = internal::symmetric_eigen(pair);
      const Eigen::Vector2d best = eigen.vectors.col(1);
      if (!(eigen.values[1] > 25 * eigen.values[0])) continue;
      // Exponent of the second parameter for the exponent 1 of the first.
      const double power = best[1] / best[0];
      const double std = 1 / std::sqrt(eigen.values[1]) / std::abs(best[0]);
      if (!(std::abs(power) > 0.05 && std::abs(power) < 20 && std < 0.3)) continue;
      sentences.push_back(symbol(one) + " and " + symbol(other) +
                          text(" are seen only together, as %s %s^%.2g, known to %.2g %%",
                               symbol(one).c_str(), symbol(other).c_str(), power, 100 * std));
    }
  return sentences;
}

namespace {

constexpr double kLeastGoodness = 1e-6, kMostScatter = 0.3, kSupposedStd = 0.1;

double largest_scatter(const Calibration& calibration) {
  return *std::max_element(calibration.scatter.begin(), calibration.scatter.end());
}

bool explains_own_errors(const Calibration& calibration) {
  return calibration.goodness >= kLeastGoodness;
}

bool explains(const Calibration& calibration) {
  return explains_own_errors(calibration) && largest_scatter(calibration) <= kMostScatter;
}

bool explains(const CalibrationProblem& problem) {
  try {
    return explains(calibrate(problem));
  } catch (const InputError&) {
    return false;  // it has no answer
  }
}

}  // namespace

std::string contradiction(const CalibrationProblem& problem, const Calibration& calibration) {
  if (explains(calibration)) return {};
  for (const PressureModel* model : all_pressure_models()) {
    if (!model->card().is_calibrated || model->card().is_empirical || model == problem.model)
      continue;
    CalibrationProblem other = problem;
    other.model = model;
    other.free = parameters_of(problem, model->card());
    other.start = calibration.values;
    if (!other.free.empty() && explains(other)) return {};
  }
  const bool contradicts_errors = !explains_own_errors(calibration);
  std::vector<std::pair<double, std::size_t>> worst;
  for (std::size_t i = 0; i < calibration.deviation.size(); ++i) {
    const bool has_own_error = problem.measurements.values[i].std > 0;
    if (contradicts_errors && !has_own_error) continue;
    const double sigmas =
        has_own_error
            ? calibration.deviation[i] * calibration.error_factor
            : (problem.measurements.values[i].value / calibration.predicted[i] - 1) / kSupposedStd;
    worst.push_back({-std::abs(sigmas), i});
  }
  std::sort(worst.begin(), worst.end());
  std::string result =
      contradicts_errors
          ? "no model explains the data within their errors"
          : text("no model explains the data to better than %.0f %% (sigma below: 10 %%)",
                 100 * largest_scatter(calibration));
  for (std::size_t i = 0; i < std::min<std::size_t>(3, worst.size()); ++i) {
    const Measurement& measurement = problem.measurements.values[worst[i].second];
    result +=
        (i == 0 ? ": " : ", ") +
        std::string(kMeasuredQuantityNames[std::size_t(measurement.quantity)]) +
        text(" at %.4g N is off by %.1f sigma", load_N(problem, measurement), -worst[i].first);
  }
  return result;
}

}  // namespace softfinger
