#include "softfinger/calibration/calibrate.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "softfinger/calibration/statistics.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"
#include "softfinger/math/dense_solvers.h"

namespace softfinger {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const char* const kWhere = "calibration";

void check(const CalibrationProblem& problem) {
  const auto refuse = [](const std::string& field, double value, const std::string& allowed) {
    throw InputError(kWhere, field, value, allowed);
  };
  const auto& [contacts, values] = problem.measurements;
  if (problem.free.empty())
    throw InputError(kWhere, "parameters", "none", "at least one parameter to find");
  if (values.size() <= problem.free.size())
    refuse("number of measurements", double(values.size()),
           "more than the " + std::to_string(problem.free.size()) + " parameters to find");
  for (const Measurement& measurement : values) {
    const std::string name(kMeasuredQuantityNames[std::size_t(measurement.quantity)]);
    if (measurement.contact >= contacts.size())
      refuse("contact of " + name, double(measurement.contact), "one of the contacts");
    if (!(measurement.value > 0) || !std::isfinite(measurement.value))
      refuse(name, measurement.value, "finite numbers > 0");
    if (!(measurement.std >= 0) || !std::isfinite(measurement.std))
      refuse("standard deviation of " + name, measurement.std, "finite numbers > 0");
  }
  for (const ParameterRange& range : kParameterRanges) {
    const double value = problem.start[index_of(range.parameter)];
    if (!contains(problem.free, range.parameter)) continue;
    if (!(value >= range.lowest && value <= range.highest))
      refuse(std::string(range.name), value,
             internal::number_text(range.lowest, 3) + " to " +
                 internal::number_text(range.highest, 3));
  }
}

/// Own errors that are the same part of every value of a quantity were meant as a part of it, and
/// then of the true value. Others are taken as they are.
bool are_errors_relative(const std::vector<Measurement>& values, MeasuredQuantity quantity) {
  double least = kInfinity, largest = 0;
  for (const Measurement& measurement : values) {
    if (measurement.quantity != quantity || measurement.std == 0) continue;
    const double part = measurement.std / measurement.value;
    least = std::min(least, part);
    largest = std::max(largest, part);
  }
  // Values and errors are written with three digits or so.
  return largest <= 1.02 * least;
}

/// The calibration while it is being made.
class Calibrator {
 public:
  explicit Calibrator(const CalibrationProblem& problem)
      : problem_(problem),
        predicted_{*problem.model, problem.measurements, problem.shear_law, problem.pressing},
        squares_(predicted_, weights_, contains(problem.free, Parameter::thickness)) {
    const auto& values = problem.measurements.values;
    weights_.resize(values.size());
    scale_.assign(values.size(), 1);
    // A reading from an unknown zero has the same error everywhere, not a part of itself.
    const bool reads_travel =
        contains(problem.free, Parameter::zero) || contains(problem.free, Parameter::compliance);
    double largest_m = 0;
    for (const Measurement& value : values)
      if (value.quantity == MeasuredQuantity::indentation)
        largest_m = std::max(largest_m, value.value);
    for (std::size_t i = 0; i < values.size(); ++i) {
      Weight& weight = weights_[i];
      const bool is_travel = reads_travel && values[i].quantity == MeasuredQuantity::indentation;
      if (is_travel && values[i].std == 0) {
        weight.is_relative = false;
        weight.std = scale_[i] = largest_m;
      }
      if (values[i].std == 0) continue;
      weight.is_relative = !is_travel && are_errors_relative(values, values[i].quantity);
      weight.std = weight.is_relative ? values[i].std / values[i].value : values[i].std;
    }
  }

  Calibration calibrate() {
    find_start();
    take_out_outliers();
    settle_scatter();
    // Looking for an interval's end may find a better fit than the one that it started from.
    constexpr int kMostRounds = 3;
    Calibration result;
    for (int round = 0; round < kMostRounds; ++round) {
      const double sum = best_.sum_of_squares;
      result = summary();
      find_intervals(result);
      if (best_.sum_of_squares > 0.999 * sum) break;
      restore_errors();
      settle_scatter();
    }
    return result;
  }

 private:
  bool has_own_error(std::size_t i) const { return problem_.measurements.values[i].std > 0; }
  std::size_t counted() const {
    return std::size_t(std::count_if(weights_.begin(), weights_.end(),
                                     [](const Weight& weight) { return weight.counts; }));
  }

  /// The best fit of several starting points: the caller's, and thin, middling and thick layers on
  /// compressible and incompressible material, where these are free.
  void find_start() {
    best_ = squares_.solve(problem_.start, problem_.free);
    optima_ = {best_.values};
    const std::vector<double> as_it_is{0};
    const bool thickness = contains(problem_.free, Parameter::thickness);
    const bool poisson_ratio = contains(problem_.free, Parameter::poisson_ratio);
    const ContactProblem& middle =
        problem_.measurements.contacts[problem_.measurements.contacts.size() / 2];
    const double size_m = std::sqrt(middle.radii.minor_m) * std::sqrt(middle.radii.major_m);
    for (const double part : thickness ? std::vector<double>{0.02, 0.1, 0.5} : as_it_is)
      for (const double nu : poisson_ratio ? std::vector<double>{0.2, 0.48} : as_it_is) {
        if (!thickness && !poisson_ratio) return;
        ParameterValues start = problem_.start;
        if (thickness) start[index_of(Parameter::thickness)] = std::clamp(part * size_m, 2e-5, 0.5);
        if (poisson_ratio) start[index_of(Parameter::poisson_ratio)] = nu;
        settle_scale(start);
        const Fit fit = squares_.solve(start, problem_.free);
        optima_.push_back(fit.values);
        if (fit.sum_of_squares < best_.sum_of_squares) best_ = fit;
      }
  }

  /// A first fit of what scales the numbers only, so that the search starts near the data.
  void settle_scale(ParameterValues& start) const {
    std::vector<Parameter> scales;
    for (const Parameter parameter : problem_.free)
      if (parameter != Parameter::thickness && parameter != Parameter::poisson_ratio)
        scales.push_back(parameter);
    start = squares_.solve(start, scales).values;
  }

  /// Residuals in the scatter of the middle half, which outliers do not spoil.
  double robust_scatter(const Eigen::VectorXd& residuals) const {
    std::vector<double> sizes(residuals.size());
    for (Eigen::Index i = 0; i < residuals.size(); ++i)
      sizes[std::size_t(i)] = std::abs(residuals[i]);
    std::sort(sizes.begin(), sizes.end());
    // The fit passes close to as many points as it has parameters.
    const std::size_t free = problem_.free.size();
    const double part = double(free) + 0.5 * double(sizes.size() - free);
    const double median = sizes[std::min(sizes.size() - 1, std::size_t(part))];
    return std::max(median / 0.6745, 1e-12);
  }

  /// A fit in which distant points count less (weights of Cauchy's distribution).
  Fit robust_fit() {
    const std::vector<Weight> plain = weights_;
    Fit fit = best_;
    for (int i = 0; i < 8; ++i) {
      weights_ = plain;
      const Eigen::VectorXd residuals = squares_.residuals(fit.values);
      const double scatter = robust_scatter(residuals);
      for (std::size_t k = 0; k < weights_.size(); ++k) {
        const double size = residuals[Eigen::Index(k)] / (2.385 * scatter);
        weights_[k].std *= std::sqrt(1 + size * size);
      }
      fit = squares_.solve(fit.values, problem_.free);
    }
    weights_ = plain;
    fit.sum_of_squares = squares_.sum_of_squares(fit.values);
    return fit;
  }

  /// The points in this order without those that would leave a quantity less than the greater part
  /// of its own: where most are far off, the model of that quantity is wrong, not they.
  std::vector<std::size_t> without_majorities(const std::vector<std::size_t>& order) const {
    const auto& values = problem_.measurements.values;
    std::array<std::size_t, kMeasuredQuantities> all{}, taken{};
    for (const Measurement& value : values) ++all[std::size_t(value.quantity)];
    std::vector<std::size_t> result;
    for (const std::size_t i : order) {
      const std::size_t quantity = std::size_t(values[i].quantity);
      if (2 * (taken[quantity] + 1) >= all[quantity]) continue;
      ++taken[quantity];
      result.push_back(i);
    }
    return result;
  }

  /// Candidates are the points farthest from the robust fit, at most a fifth of all. From the most
  /// downwards: a number of candidates are outliers when the least of them is one before the fit to
  /// the points that remain (Rosner's many-outlier procedure, backwards, so that none hides
  /// another).
  void take_out_outliers() {
    const std::size_t count = weights_.size(), free = problem_.free.size();
    const std::size_t most = std::min(count / 5, count > free + 3 ? count - free - 3 : 0);
    if (most == 0) return;
    const Fit robust = robust_fit();
    const Eigen::VectorXd residuals = squares_.residuals(robust.values);
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](std::size_t one, std::size_t other) {
      return std::abs(residuals[Eigen::Index(one)]) > std::abs(residuals[Eigen::Index(other)]);
    });
    order = without_majorities(order);
    const std::vector<Weight> plain = weights_;
    for (std::size_t number = std::min(most, order.size()); number > 0; --number) {
      weights_ = plain;
      for (std::size_t i = 0; i < number; ++i) weights_[order[i]].counts = false;
      const Fit fit = squares_.solve(robust.values, problem_.free);
      if (!is_outlier(order[number - 1], fit, count - number)) continue;
      best_ = fit;
      return;
    }
    weights_ = plain;
  }

  /// Whether a point that does not count lies farther from the fit to the others than chance
  /// allows.
  bool is_outlier(std::size_t candidate, const Fit& fit, std::size_t others) {
    constexpr double kChance = 0.01;  // for the whole set of measurements
    const double freedom = double(others) - double(problem_.free.size());
    const double scatter = std::sqrt(fit.sum_of_squares / freedom);
    const bool is_known = has_own_error(candidate);
    const Eigen::MatrixXd slopes = squares_.jacobian(fit.values, problem_.free);
    weights_[candidate].counts = true;
    const Eigen::VectorXd own =
        squares_.jacobian(fit.values, problem_.free).row(Eigen::Index(candidate)).transpose();
    weights_[candidate].counts = false;
    const double leverage = own.dot(internal::pseudo_inverse(internal::gram(slopes)) * own);
    const double size = std::abs(squares_.residuals(fit.values)[Eigen::Index(candidate)]) /
                        ((is_known ? std::max(1., scatter) : scatter) * std::sqrt(1 + leverage));
    return size > statistics::student_quantile(kChance / double(others + 1),
                                               is_known ? kInfinity : freedom);
  }

  /// Standard deviations of what has no error of its own, from the fit: one for all quantities, or
  /// each its own where they differ more than by chance (Bartlett's test at 1 in 1000).
  void settle_scatter() {
    const auto& values = problem_.measurements.values;
    best_ = squares_.solve(best_.values, problem_.free);
    for (int round = 0; round < 3; ++round) {
      const Eigen::VectorXd residuals = squares_.counted_residuals(best_.values);
      std::array<double, kMeasuredQuantities> sums{}, counts{};
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (has_own_error(i) || !weights_[i].counts) continue;
        const double log_residual = residuals[Eigen::Index(i)] * weights_[i].std / scale_[i];
        sums[std::size_t(values[i].quantity)] += log_residual * log_residual;
        ++counts[std::size_t(values[i].quantity)];
      }
      const double all = std::accumulate(counts.begin(), counts.end(), 0.);
      if (all == 0) {
        freedom_ = kInfinity;
        return;
      }
      // Each measurement carries its part of the parameters.
      const double per_measurement = 1 - double(problem_.free.size()) / double(counted());
      freedom_ = std::max(1., all * per_measurement);
      const double pooled = std::accumulate(sums.begin(), sums.end(), 0.) / (all * per_measurement);
      double bartlett = 0;
      int groups = 0;
      for (std::size_t q = 0; q < kMeasuredQuantities; ++q) {
        if (counts[q] == 0) continue;
        const double freedom = counts[q] * per_measurement;
        bartlett += freedom * std::log(pooled / std::max(sums[q] / freedom, 1e-300));
        ++groups;
      }
      const bool differ =
          groups > 1 && statistics::chi_squared_exceeds(bartlett, groups - 1) < 1e-3;
      for (std::size_t q = 0; q < kMeasuredQuantities; ++q) {
        if (counts[q] == 0) continue;
        // Measurements without any scatter are no more exact than arithmetic.
        scatter_[q] =
            std::max(1e-9, std::sqrt(differ ? sums[q] / (counts[q] * per_measurement) : pooled));
      }
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (has_own_error(i)) continue;
        const double scatter = scatter_[std::size_t(values[i].quantity)];
        if (scatter == 0) continue;
        weights_[i].std = scatter * scale_[i];
      }
      for (Weight& weight : weights_)
        if (weight.is_relative) weight.shift = 0.5 * weight.std * weight.std;
      best_ = squares_.solve(best_.values, problem_.free);
    }
  }

  void multiply_errors(double factor) {
    for (std::size_t i = 0; i < weights_.size(); ++i)
      if (has_own_error(i)) weights_[i].std *= factor;
  }

  /// Own errors as they were given: whether they explain a better fit is to be asked anew.
  void restore_errors() {
    multiply_errors(1 / error_factor_);
    error_factor_ = 1;
  }

  Calibration summary() {
    const auto& values = problem_.measurements.values;
    Calibration result;
    result.freedom = freedom_;
    result.scatter = scatter_;
    const bool has_scatter = freedom_ != kInfinity;
    double own_sum = 0, own_count = 0;
    const Eigen::VectorXd before = squares_.residuals(best_.values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!weights_[i].counts || !has_own_error(i)) continue;
      own_sum += before[Eigen::Index(i)] * before[Eigen::Index(i)];
      ++own_count;
    }
    // Each measurement carries its part of the parameters.
    const double freedom = own_count * (1 - double(problem_.free.size()) /
                                                double(std::max<std::size_t>(1, counted())));
    const int whole = int(freedom + 0.5);
    if (whole > 0) {
      result.goodness = statistics::chi_squared_exceeds(own_sum, whole);
      // The particle physicists' factor: errors that do not explain the fit are enlarged until they
      // do.
      if (result.goodness < 0.01) {
        result.error_factor = std::sqrt(own_sum / freedom);
        if (!has_scatter) freedom_ = result.freedom = freedom;
      }
    }
    error_factor_ = result.error_factor;
    multiply_errors(error_factor_);
    best_.sum_of_squares = squares_.sum_of_squares(best_.values);
    result.weights = weights_;
    result.values = best_.values;
    result.sum_of_squares = best_.sum_of_squares;
    Eigen::VectorXd log_values;
    predicted_.evaluate(best_.values, log_values, nullptr);
    const Eigen::VectorXd residuals = squares_.residuals(best_.values);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!weights_[i].counts) result.outliers.push_back(i);
      result.predicted.push_back(std::exp(log_values[Eigen::Index(i)]));
      result.deviation.push_back(residuals[Eigen::Index(i)]);
      if (!weights_[i].counts) continue;
      const double std =
          weights_[i].is_relative ? weights_[i].std * result.predicted[i] : weights_[i].std;
      result.log_likelihood -= 0.5 * residuals[Eigen::Index(i)] * residuals[Eigen::Index(i)] +
                               std::log(std) + 0.5 * std::log(2 * kPi);
    }
    const Eigen::MatrixXd slopes = squares_.jacobian(best_.values, problem_.free);
    const Eigen::MatrixXd information = internal::gram(slopes);
    // An undetermined combination of parameters has no information but rounding.
    const Eigen::VectorXd known = internal::symmetric_eigen(information).values;
    if (known[0] > 1e-12 * known[known.size() - 1])
      result.covariance = internal::inverse(information);
    return result;
  }

  /// Returns how many standard deviations the best fit with this parameter held at this coordinate
  /// is worse than the best fit of all. `values`: start of the fit, then its result.
  double distance(Parameter parameter, double coordinate, ParameterValues& values) {
    std::vector<Parameter> others;
    for (const Parameter free : problem_.free)
      if (free != parameter) others.push_back(free);
    values[index_of(parameter)] = value_at(parameter, coordinate);
    const Fit fit = squares_.solve(values, others);
    values = fit.values;
    if (fit.sum_of_squares < best_.sum_of_squares) best_ = fit;
    return std::sqrt(std::max(0., fit.sum_of_squares - best_.sum_of_squares));
  }

  /// Returns the coordinate at which that distance reaches `limit`, searched upwards (sign 1) or
  /// downwards (sign -1); the end of the parameter's range, with `*is_open` set, if it does not.
  double border(ParameterValues values, Parameter parameter, double std, int sign, double limit,
                bool* is_open) {
    const ParameterRange& range = range_of(parameter);
    const double end = coordinate(parameter, sign > 0 ? range.highest : range.lowest);
    const double start = coordinate(parameter, values[index_of(parameter)]);
    const double whole = coordinate(parameter, range.highest) - coordinate(parameter, range.lowest);
    double step = std::clamp(limit * std, 1e-6 * whole, 0.05 * whole);
    double inner = start, inner_distance = 0, outer = start, outer_distance = 0;
    ParameterValues inner_values = values;
    *is_open = false;
    while (true) {
      outer = sign > 0 ? std::min(end, outer + step) : std::max(end, outer - step);
      outer_distance = distance(parameter, outer, values);
      if (outer_distance >= limit) break;
      inner = outer;
      inner_distance = outer_distance;
      inner_values = values;
      if (outer == end) {
        *is_open = true;
        return end;
      }
      step *= 1.7;
    }
    // The distance is nearly linear: regula falsi, with the end that stays counting half
    // (Illinois).
    double inner_weighed = inner_distance - limit, outer_weighed = outer_distance - limit;
    int side = 0;
    for (int i = 0; i < 20 && std::abs(outer - inner) > 1e-3 * std::abs(outer - start); ++i) {
      const double middle =
          (inner * outer_weighed - outer * inner_weighed) / (outer_weighed - inner_weighed);
      values = inner_values;
      const double value = distance(parameter, middle, values) - limit;
      if (std::abs(value) < 1e-3 * limit) return middle;
      if (value < 0) {
        inner = middle;
        inner_weighed = value;
        inner_values = values;
        if (side == -1) outer_weighed *= 0.5;
        side = -1;
      } else {
        outer = middle;
        outer_weighed = value;
        if (side == 1) inner_weighed *= 0.5;
        side = 1;
      }
    }
    return 0.5 * (inner + outer);
  }

  void find_intervals(Calibration& result) {
    const double limit = statistics::student_quantile(0.05, freedom_);
    // Other optima that differ from the best one by no more than chance.
    std::vector<ParameterValues> rivals;
    for (const ParameterValues& optimum : optima_) {
      const Fit fit = squares_.solve(optimum, problem_.free);
      if (fit.sum_of_squares < best_.sum_of_squares) best_ = fit;
      if (fit.sum_of_squares < best_.sum_of_squares + limit * limit) rivals.push_back(fit.values);
    }
    for (std::size_t i = 0; i < problem_.free.size(); ++i) {
      const Parameter parameter = problem_.free[i];
      ParameterEstimate estimate{parameter, best_.values[index_of(parameter)]};
      const double std = result.covariance.size() > 0
                             ? std::sqrt(result.covariance(Eigen::Index(i), Eigen::Index(i)))
                             : kInfinity;
      estimate.std = range_of(parameter).logarithmic ? std * estimate.value : std;
      const auto reach = [&](const ParameterValues& from, int sign, bool* is_open) {
        return value_at(parameter, border(from, parameter, std, sign, limit, is_open));
      };
      estimate.low = reach(best_.values, -1, &estimate.is_low_open);
      estimate.high = reach(best_.values, 1, &estimate.is_high_open);
      // At a border of the search, rounding must not move an end of the interval past the value.
      estimate.low = std::min(estimate.low, estimate.value);
      estimate.high = std::max(estimate.high, estimate.value);
      for (const ParameterValues& rival : rivals) {
        if (rival[index_of(parameter)] < estimate.low)
          estimate.low = reach(rival, -1, &estimate.is_low_open);
        if (rival[index_of(parameter)] > estimate.high)
          estimate.high = reach(rival, 1, &estimate.is_high_open);
      }
      result.parameters.push_back(estimate);
    }
  }

  const CalibrationProblem& problem_;
  PredictedMeasurements predicted_;
  std::vector<Weight> weights_;
  std::vector<double> scale_;  ///< to which a scatter is relative: 1 for logarithms
  LeastSquares squares_;
  Fit best_;
  std::vector<ParameterValues> optima_;  ///< where the searches from all starting points ended
  std::array<double, kMeasuredQuantities> scatter_{};
  double freedom_ = kInfinity, error_factor_ = 1;
};

}  // namespace

bool Calibration::is_outlier(std::size_t measurement) const {
  return std::find(outliers.begin(), outliers.end(), measurement) != outliers.end();
}

Calibration calibrate(const CalibrationProblem& problem) {
  check(problem);
  Calibration found = Calibrator(problem).calibrate();
  for (const double predicted : found.predicted)
    if (!std::isfinite(predicted))
      throw InputError(kWhere, "model", std::string(problem.model->card().name),
                       "a model that has an answer for every contact and measured quantity");
  return found;
}

}  // namespace softfinger
