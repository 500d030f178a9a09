#include "softfinger/time/relaxation_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

constexpr int kMostFittedTerms = 3, kGridTimes = 24;

/// F(t) = rest + sum amplitude exp(-t/exp(log_time)).
struct Decay {
  double rest = 0;
  Eigen::ArrayXd amplitudes, log_times;

  Eigen::ArrayXd at(const Eigen::ArrayXd& times) const {
    Eigen::ArrayXd force = Eigen::ArrayXd::Constant(times.size(), rest);
    for (Eigen::Index i = 0; i < amplitudes.size(); ++i)
      force += amplitudes[i] * (-times * std::exp(-log_times[i])).exp();
    return force;
  }
  /// Derivatives: rest, amplitudes, log times.
  Eigen::MatrixXd jacobian(const Eigen::ArrayXd& times) const {
    const Eigen::Index count = amplitudes.size();
    Eigen::MatrixXd jacobian(times.size(), 1 + 2 * count);
    jacobian.col(0).setOnes();
    for (Eigen::Index i = 0; i < count; ++i) {
      const Eigen::ArrayXd x = times * std::exp(-log_times[i]);
      jacobian.col(1 + i) = (-x).exp();
      jacobian.col(1 + count + i) = amplitudes[i] * x * (-x).exp();
    }
    return jacobian;
  }
  bool is_relaxation() const {
    return rest > 1e-3 * (rest + amplitudes.sum()) && (amplitudes > 0).all();
  }
};

double misfit(const Decay& decay, const Eigen::ArrayXd& times, const Eigen::ArrayXd& forces) {
  return (decay.at(times) - forces).square().sum();
}

/// The best decay with these many of the grid's times; infinite misfit where there is none.
Decay best_on_grid(const Eigen::ArrayXd& times, const Eigen::ArrayXd& forces,
                   const Eigen::ArrayXd& grid, int count) {
  Eigen::MatrixXd columns(times.size(), 1 + grid.size());
  columns.col(0).setOnes();
  for (Eigen::Index i = 0; i < grid.size(); ++i)
    columns.col(1 + i) = (-times * std::exp(-grid[i])).exp();
  const Eigen::MatrixXd gram = columns.transpose() * columns;
  const Eigen::VectorXd projected = columns.transpose() * forces.matrix();
  Decay best;
  double least = kInfinity;
  std::vector<int> chosen(static_cast<std::size_t>(count));
  const auto solve = [&] {
    const Eigen::Index size = 1 + count;
    std::vector<Eigen::Index> places = {0};
    for (const int place : chosen) places.push_back(1 + place);
    Eigen::MatrixXd matrix(size, size);
    Eigen::VectorXd side(size);
    for (Eigen::Index i = 0; i < size; ++i) {
      side[i] = projected[places[std::size_t(i)]];
      for (Eigen::Index j = 0; j < size; ++j)
        matrix(i, j) = gram(places[std::size_t(i)], places[std::size_t(j)]);
    }
    const Eigen::VectorXd solution = matrix.ldlt().solve(side);
    Decay decay{solution[0], solution.tail(count).array(), Eigen::ArrayXd(count)};
    for (int i = 0; i < count; ++i) decay.log_times[i] = grid[chosen[std::size_t(i)]];
    if (!solution.allFinite() || !decay.is_relaxation()) return;
    const double here = misfit(decay, times, forces);
    if (here < least) {
      least = here;
      best = decay;
    }
  };
  // All ascending choices of `count` places.
  const auto choose = [&](const auto& self, int place, int from) -> void {
    if (place == count) return solve();
    for (int i = from; i < int(grid.size()); ++i) {
      chosen[std::size_t(place)] = i;
      self(self, place + 1, i + 1);
    }
  };
  choose(choose, 0, 0);
  return best;
}

/// Refines a decay by least squares (Levenberg and Marquardt). Amplitudes and times stay those of a
/// relaxation.
Decay refined(Decay decay, const Eigen::ArrayXd& times, const Eigen::ArrayXd& forces) {
  double damping = 1e-3, here = misfit(decay, times, forces);
  const Eigen::Index count = decay.amplitudes.size();
  for (int step = 0; step < 200 && damping < 1e12; ++step) {
    const Eigen::MatrixXd jacobian = decay.jacobian(times);
    const Eigen::VectorXd left = (forces - decay.at(times)).matrix();
    Eigen::MatrixXd matrix = jacobian.transpose() * jacobian;
    matrix.diagonal() *= 1 + damping;
    const Eigen::VectorXd move = matrix.ldlt().solve(jacobian.transpose() * left);
    Decay tried = decay;
    tried.rest += move[0];
    tried.amplitudes += move.segment(1, count).array();
    tried.log_times += move.tail(count).array();
    const bool is_allowed = move.allFinite() && tried.is_relaxation();
    const double there = is_allowed ? misfit(tried, times, forces) : kInfinity;
    if (there <= here) {
      const bool is_done = here - there <= 1e-15 * here;
      decay = tried;
      here = there;
      damping /= 5;
      if (is_done) break;
    } else {
      damping *= 5;
    }
  }
  return decay;
}

void check_forces(const std::vector<HeldForce>& forces) {
  constexpr std::size_t kFewest = 6;
  if (forces.size() < kFewest)
    throw InputError("relaxation", "number of forces", double(forces.size()), "at least 6");
  std::vector<double> times;
  for (const HeldForce& one : forces) {
    if (!(one.time_s >= 0) || !std::isfinite(one.time_s))
      throw InputError("relaxation", "time_s", one.time_s, "a finite number >= 0");
    if (!(one.force_N > 0) || !std::isfinite(one.force_N))
      throw InputError("relaxation", "force", one.force_N, "a finite number > 0");
    times.push_back(one.time_s);
  }
  std::sort(times.begin(), times.end());
  const auto twice = std::adjacent_find(times.begin(), times.end());
  if (twice != times.end()) throw InputError("relaxation", "time_s", *twice, "each time once");
}

}  // namespace

RelaxationFit fit_relaxation(const std::vector<HeldForce>& data) {
  check_forces(data);
  const auto size = Eigen::Index(data.size());
  Eigen::ArrayXd times(size), forces(size);
  for (Eigen::Index k = 0; k < size; ++k) {
    times[k] = data[std::size_t(k)].time_s;
    forces[k] = data[std::size_t(k)].force_N;
  }
  double first_s = kInfinity;
  for (const double time_s : times)
    if (time_s > 0) first_s = std::min(first_s, time_s);
  const Eigen::ArrayXd grid =
      Eigen::ArrayXd::LinSpaced(kGridTimes, std::log(first_s / 2), std::log(2 * times.maxCoeff()));
  RelaxationFit fit;
  Decay best{forces.mean(), Eigen::ArrayXd(0), Eigen::ArrayXd(0)};
  const auto criterion_of = [&](const Decay& decay) {
    const double unknowns = 2. + 2. * double(decay.amplitudes.size()), n = double(size);
    if (n - unknowns - 1 <= 0) return kInfinity;
    // Forces are not known better than to rounding.
    const double variance =
        std::max(misfit(decay, times, forces) / n, std::pow(1e-13 * forces.mean(), 2));
    return n * std::log(variance) + 2 * unknowns * n / (n - unknowns - 1);
  };
  fit.criterion.push_back(criterion_of(best));
  for (int count = 1; count <= kMostFittedTerms; ++count) {
    Decay decay = best_on_grid(times, forces, grid, count);
    if (decay.amplitudes.size() == 0) {
      fit.criterion.push_back(kInfinity);
      continue;
    }
    decay = refined(decay, times, forces);
    fit.criterion.push_back(criterion_of(decay));
    if (fit.criterion.back() < *std::min_element(fit.criterion.begin(), fit.criterion.end() - 1))
      best = decay;
  }

  const Eigen::Index count = best.amplitudes.size();
  const double total = best.rest + best.amplitudes.sum();
  const double freedom = double(size - 1 - 2 * count);
  const double variance = misfit(best, times, forces) / std::max(1., freedom);
  const Eigen::MatrixXd jacobian = best.jacobian(times);
  const Eigen::MatrixXd covariance =
      variance *
      (jacobian.transpose() * jacobian).completeOrthogonalDecomposition().pseudoInverse();
  // Share i is amplitude i over the sum of all amplitudes and the rest.
  const auto share_std = [&](Eigen::Index place, double share) {
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(covariance.rows());
    slope.head(1 + count).setConstant(-share / total);
    slope[place] += 1 / total;
    return std::sqrt(std::max(0., double(slope.transpose() * covariance * slope)));
  };
  fit.force_at_once_N = total;
  fit.long_time_modulus = best.rest / total;
  fit.long_time_modulus_std = share_std(0, fit.long_time_modulus);
  fit.scatter_N = std::sqrt(variance);
  for (Eigen::Index i = 0; i < count; ++i) {
    FittedTerm term;
    term.term = {best.amplitudes[i] / total, std::exp(best.log_times[i])};
    term.share_std = share_std(1 + i, term.term.share);
    term.log_time_std = std::sqrt(std::max(0., covariance(1 + count + i, 1 + count + i)));
    fit.terms.push_back(term);
  }
  std::sort(fit.terms.begin(), fit.terms.end(), [](const FittedTerm& one, const FittedTerm& other) {
    return one.term.time_s > other.term.time_s;
  });
  const Eigen::ArrayXd predicted = best.at(times);
  fit.predicted_N.assign(predicted.data(), predicted.data() + predicted.size());
  return fit;
}

}  // namespace softfinger
