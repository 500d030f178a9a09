#include "softfinger/calibration/least_squares.h"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/NonLinearOptimization>

#include "softfinger/input/constants.h"

namespace softfinger {
namespace {

struct CoordinateRange {
  double middle, half;
};

CoordinateRange coordinate_range(Parameter parameter) noexcept {
  const ParameterRange& range = range_of(parameter);
  const double low = coordinate(parameter, range.lowest);
  const double high = coordinate(parameter, range.highest);
  return {0.5 * (low + high), 0.5 * (high - low)};
}

/// Distance from a border, as a fraction of half the range, within which no search starts; a
/// parameter within twice this distance counts as lying on the border.
constexpr double kAtBorder = 1e-4;

struct HeldAtBorders {
  ParameterValues values;  ///< those near a border moved onto it
  std::vector<Parameter> at_border, others;
};

HeldAtBorders hold_at_borders(const ParameterValues& values, const std::vector<Parameter>& free) {
  HeldAtBorders result{values, {}, {}};
  for (const Parameter parameter : free) {
    double& value = result.values[std::size_t(parameter)];
    const CoordinateRange range = coordinate_range(parameter);
    const double from_middle = (coordinate(parameter, value) - range.middle) / range.half;
    if (std::abs(from_middle) < 1 - 2 * kAtBorder) {
      result.others.push_back(parameter);
      continue;
    }
    value = from_middle > 0 ? range_of(parameter).highest : range_of(parameter).lowest;
    result.at_border.push_back(parameter);
  }
  return result;
}

double excess(double log_compression) noexcept {
  return std::max(0., log_compression - std::log(kMostCompression)) / kCompressionStd;
}

/// The problem in the form of Eigen's solver, a port of MINPACK's lmder.
struct SolverProblem {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  const LeastSquares& least_squares;
  const ParameterValues& start;
  const std::vector<Parameter>& free;
  const std::size_t measurements;

  int inputs() const { return int(free.size()); }
  int values() const { return int(measurements) + 1; }

  ParameterValues values_at(const Eigen::VectorXd& y) const {
    ParameterValues result = start;
    for (std::size_t i = 0; i < free.size(); ++i) {
      const CoordinateRange range = coordinate_range(free[i]);
      result[std::size_t(free[i])] =
          value_at(free[i], range.middle + range.half * std::sin(y[Eigen::Index(i)]));
    }
    return result;
  }
  int operator()(const Eigen::VectorXd& y, Eigen::VectorXd& residuals) const {
    residuals = least_squares.counted_residuals(values_at(y));
    return 0;
  }
  int df(const Eigen::VectorXd& y, Eigen::MatrixXd& jacobian) const {
    jacobian = least_squares.jacobian(values_at(y), free);
    for (std::size_t i = 0; i < free.size(); ++i)
      jacobian.col(Eigen::Index(i)) *=
          coordinate_range(free[i]).half * std::cos(y[Eigen::Index(i)]);
    return 0;
  }
};

}  // namespace

double coordinate(Parameter parameter, double value) noexcept {
  return range_of(parameter).logarithmic ? std::log(value) : value;
}

double value_at(Parameter parameter, double coordinate) noexcept {
  const ParameterRange& range = range_of(parameter);
  return std::clamp(range.logarithmic ? std::exp(coordinate) : coordinate, range.lowest,
                    range.highest);
}

Eigen::VectorXd LeastSquares::residuals(const ParameterValues& values) const {
  Eigen::VectorXd result;
  predicted_.evaluate(values, result, nullptr);
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const Weight& weight = weights_[std::size_t(i)];
    const double measured = predicted_.measurements.values[std::size_t(i)].value;
    result[i] = weight.is_relative ? (std::log(measured) + weight.shift - result[i]) / weight.std
                                   : (measured - std::exp(std::min(result[i], 300.))) / weight.std;
  }
  return result;
}

Eigen::VectorXd LeastSquares::counted_residuals(const ParameterValues& values) const {
  Eigen::VectorXd result = residuals(values);
  for (Eigen::Index i = 0; i < result.size(); ++i)
    if (!weights_[std::size_t(i)].counts) result[i] = 0;
  result.conservativeResize(result.size() + 1);
  result[result.size() - 1] =
      is_thickness_free_ ? excess(predicted_.log_compression(values, nullptr)) : 0;
  return result;
}

double LeastSquares::sum_of_squares(const ParameterValues& values) const {
  return counted_residuals(values).squaredNorm();
}

Eigen::MatrixXd LeastSquares::jacobian(const ParameterValues& values,
                                       const std::vector<Parameter>& free) const {
  Eigen::VectorXd log_values;
  Eigen::MatrixXd slopes;
  predicted_.evaluate(values, log_values, &slopes);
  Eigen::MatrixXd result(slopes.rows() + 1, Eigen::Index(free.size()));
  Eigen::RowVectorXd compression_slopes = Eigen::RowVectorXd::Zero(Eigen::Index(kParameters));
  if (is_thickness_free_ && !(excess(predicted_.log_compression(values, &compression_slopes)) > 0))
    compression_slopes.setZero();
  for (std::size_t k = 0; k < free.size(); ++k)
    result(slopes.rows(), Eigen::Index(k)) =
        compression_slopes[Eigen::Index(free[k])] / kCompressionStd;
  for (Eigen::Index i = 0; i < slopes.rows(); ++i) {
    const Weight& weight = weights_[std::size_t(i)];
    const double factor = !weight.counts ? 0
                          : weight.is_relative
                              ? -1 / weight.std
                              : -std::exp(std::min(log_values[i], 300.)) / weight.std;
    for (std::size_t k = 0; k < free.size(); ++k)
      result(i, Eigen::Index(k)) = factor * slopes(i, Eigen::Index(free[k]));
  }
  return result;
}

Fit LeastSquares::solve_inside(const ParameterValues& start,
                               const std::vector<Parameter>& free) const {
  Fit best{start, sum_of_squares(start)};
  if (free.empty()) return best;
  SolverProblem problem{*this, start, free, weights_.size()};
  Eigen::VectorXd y(Eigen::Index(free.size()));
  for (std::size_t i = 0; i < free.size(); ++i) {
    const CoordinateRange range = coordinate_range(free[i]);
    const double x = coordinate(free[i], start[std::size_t(free[i])]);
    // At a border itself the sine has no slope, and the search would never leave it.
    y[Eigen::Index(i)] =
        std::asin(std::clamp((x - range.middle) / range.half, kAtBorder - 1, 1 - kAtBorder));
  }
  Eigen::LevenbergMarquardt<SolverProblem> solver(problem);
  // Far below any error of measurement.
  solver.parameters.ftol = 1e-7;
  solver.parameters.xtol = 1e-6;
  solver.parameters.maxfev = 40;
  solver.minimize(y);
  const ParameterValues found = problem.values_at(y);
  const double sum = sum_of_squares(found);
  if (sum < best.sum_of_squares) best = {found, sum};
  return best;
}

Fit LeastSquares::solve(const ParameterValues& start, const std::vector<Parameter>& free) const {
  // A parameter that starts on a border often stays there.
  if (const auto [held, at_border, others] = hold_at_borders(start, free); !at_border.empty()) {
    const Fit fit = solve_inside(held, others);
    if (push_outwards(fit.values, at_border)) return fit;
  }
  const Fit fit = solve_inside(start, free);
  // Next to a border the sine makes the search slow: it is finished on the border.
  const auto [held, at_border, others] = hold_at_borders(fit.values, free);
  if (at_border.empty()) return fit;
  const Fit finished = solve_inside(held, others);
  return finished.sum_of_squares < fit.sum_of_squares ? finished : fit;
}

bool LeastSquares::push_outwards(const ParameterValues& values,
                                 const std::vector<Parameter>& at_border) const {
  const Eigen::VectorXd gradient =
      jacobian(values, at_border).transpose() * counted_residuals(values);
  for (std::size_t i = 0; i < at_border.size(); ++i) {
    const bool is_upper = values[std::size_t(at_border[i])] == range_of(at_border[i]).highest;
    if (is_upper ? gradient[Eigen::Index(i)] > 0 : gradient[Eigen::Index(i)] < 0) return false;
  }
  return true;
}

}  // namespace softfinger
