#include "fem/friction/coulomb_friction.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "fem/algebra/positive_definite.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {
namespace {

using Eigen::Index;

/// Minimum of q D q / 2 - b q over |q| <= limit, D symmetric positive definite.
Eigen::Vector2d minimum_on_disc(const Eigen::Matrix2d& D, const Eigen::Vector2d& b, double limit) {
  const Eigen::Vector2d free = D.ldlt().solve(b);
  if (free.norm() <= limit) return free;
  // (D + lambda) q = b with |q| = limit: Newton's method on 1/|q|, which is nearly linear in
  // lambda.
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
  eigen.computeDirect(D);
  const Eigen::Vector2d d = eigen.eigenvalues(), c = eigen.eigenvectors().transpose() * b;
  double lambda = 0;
  Eigen::Vector2d q;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Eigen::Vector2d shifted = d.array() + lambda;
    q = c.cwiseQuotient(shifted);
    const double norm = q.norm();
    const double slope = q.cwiseAbs2().cwiseQuotient(shifted).sum();  // -d(|q|²/2)/dlambda
    const double step = (norm / limit - 1) * norm * norm / slope;
    lambda += step;
    if (std::abs(step) <= 1e-14 * (lambda + d.maxCoeff())) break;
  }
  const Eigen::Vector2d on_edge = eigen.eigenvectors() * q;
  return on_edge * (limit / on_edge.norm());
}

class FrictionProblem {
 public:
  FrictionProblem(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& limit,
                  const Eigen::VectorXd& target, Eigen::VectorXd& force)
      : compliance_(compliance), limit_(limit), target_(target), force_(force) {
    for (Index i = 0; i < limit.size(); ++i) {
      auto q = force_.segment<2>(2 * i);
      if (limit[i] <= 0)
        q.setZero();
      else
        movable_.push_back(i);
      if (q.norm() > limit[i]) q *= limit[i] / q.norm();
    }
    update_residual();
  }

  void sweep() {
    for (const Index i : movable_) {
      auto q = force_.segment<2>(2 * i);
      const Eigen::Matrix2d D = compliance_.block<2, 2>(2 * i, 2 * i);
      const Eigen::Vector2d change =
          minimum_on_disc(D, residual_.segment<2>(2 * i) + D * q, limit_[i]) - q;
      if (change.squaredNorm() == 0) continue;
      q += change;
      residual_ -= compliance_.middleCols<2>(2 * i) * change;
    }
    update_residual();  // round-off of many small updates
  }

  /// Worst violation of the conditions; decides who slips.
  double violation() {
    slips_.assign(static_cast<std::size_t>(limit_.size()), false);
    double worst = 0;
    for (const Index i : movable_) {
      const auto q = force_.segment<2>(2 * i);
      const auto r = residual_.segment<2>(2 * i);
      const bool slips = q.norm() >= limit_[i] * (1 - 1e-12) && r.dot(q) > 0;
      slips_[static_cast<std::size_t>(i)] = slips;
      const double along = slips ? r.dot(q) / q.norm() : 0;
      worst = std::max(worst, slips ? (r - along / q.norm() * q).norm() : r.norm());
    }
    return worst;
  }

  /// Newton's step with the nodes that stick and slip at present. It is taken back if it would
  /// increase the energy. @returns whether it was kept
  bool newton_step(StickSlipFactor& kept, bool renew) {
    const std::vector<Direction> directions = free_directions();
    if (renew || kept.slips != slips_ || kept.movable != movable_) {
      kept.movable = movable_;
      kept.slips = slips_;
      kept.factor = hessian(directions);
      if (!factorise_positive_definite(kept.factor)) {
        kept.slips.clear();
        return false;
      }
    }
    const auto size = static_cast<Index>(directions.size());
    Eigen::VectorXd descent(size);
    for (Index j = 0; j < size; ++j) {
      const Direction& direction = directions[static_cast<std::size_t>(j)];
      descent[j] = residual_.segment<2>(direction.row).dot(direction.along);
    }
    const Eigen::VectorXd step =
        solve_vector_by_factor(kept.factor, descent.cast<float>()).cast<double>();

    const double before = energy();
    const Eigen::VectorXd old_force = force_, old_residual = residual_;
    for (Index j = 0; j < size; ++j) {
      const Direction& direction = directions[static_cast<std::size_t>(j)];
      force_.segment<2>(direction.row) += step[j] * direction.along;
    }
    for (const Index i : movable_) {
      auto q = force_.segment<2>(2 * i);
      if (slips_[static_cast<std::size_t>(i)] || q.norm() > limit_[i]) q *= limit_[i] / q.norm();
    }
    update_residual();
    // Next to the solution two energies differ by less than their round-off.
    constexpr double resolved = 1e-13;
    if (energy() <= before + resolved * std::abs(before)) return true;
    force_ = old_force;
    residual_ = old_residual;
    return false;
  }

 private:
  /// A direction in which the forces may change: any one where a point sticks, along the rim of its
  /// disc where it slips.
  struct Direction {
    Index row;  ///< first of the point's two
    Eigen::Vector2d along;
    double curvature;  ///< of the rim, times the slip
  };

  std::vector<Direction> free_directions() const {
    std::vector<Direction> directions;
    for (const Index i : movable_) {
      const Eigen::Vector2d q = force_.segment<2>(2 * i), r = residual_.segment<2>(2 * i);
      if (slips_[static_cast<std::size_t>(i)]) {
        const Eigen::Vector2d t = q / q.norm();
        directions.push_back({2 * i, {-t.y(), t.x()}, r.dot(t) / limit_[i]});
      } else {
        directions.push_back({2 * i, {1, 0}, 0});
        directions.push_back({2 * i, {0, 1}, 0});
      }
    }
    return directions;
  }

  /// The second derivatives of the energy along the directions, lower triangle.
  Eigen::MatrixXf hessian(const std::vector<Direction>& directions) const {
    const auto size = static_cast<Index>(directions.size());
    Eigen::MatrixXf result(size, size);
    for (Index j = 0; j < size; ++j) {
      const Direction& column = directions[static_cast<std::size_t>(j)];
      const Eigen::VectorXd moved = compliance_.middleCols<2>(column.row) * column.along;
      for (Index i = j; i < size; ++i) {
        const Direction& row = directions[static_cast<std::size_t>(i)];
        result(i, j) =
            static_cast<float>(row.along.x() * moved[row.row] + row.along.y() * moved[row.row + 1]);
      }
      result(j, j) += static_cast<float>(column.curvature);
    }
    return result;
  }

  void update_residual() {
    residual_ = target_;
    residual_.noalias() -= compliance_.selfadjointView<Eigen::Lower>() * force_;
  }
  double energy() const { return -0.5 * force_.dot(target_ + residual_); }

  const Eigen::MatrixXd& compliance_;
  const Eigen::VectorXd& limit_;
  const Eigen::VectorXd& target_;
  Eigen::VectorXd& force_;
  Eigen::VectorXd residual_;  ///< the slip
  std::vector<Index> movable_;
  std::vector<bool> slips_;
};

/// Rows of points in vectors and matrices of two components per point.
std::vector<Index> rows_of(const std::vector<Index>& points) {
  std::vector<Index> rows;
  for (const Index i : points) rows.insert(rows.end(), {2 * i, 2 * i + 1});
  return rows;
}

/// Makes sure that what is kept has all points with a limit that can move. A component that is
/// fixed gets a compliance of its own: with no target it bears no force.
void cover(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& limit, StickSlipFactor& kept) {
  const double largest = compliance.diagonal().maxCoeff(), least = 1e-12 * largest;
  std::vector<Index> movable, all;
  for (Index i = 0; i < limit.size(); ++i)
    if (limit[i] > 0 && compliance.diagonal().segment<2>(2 * i).maxCoeff() > least)
      movable.push_back(i);
  std::set_union(kept.points.begin(), kept.points.end(), movable.begin(), movable.end(),
                 std::back_inserter(all));
  if (all == kept.points) return;
  kept.points = std::move(all);
  const std::vector<Index> rows = rows_of(kept.points);
  kept.compliance = compliance(rows, rows);
  kept.fixed.clear();
  for (Index row = 0; row < kept.compliance.rows(); ++row)
    if (kept.compliance(row, row) <= least) {
      kept.compliance(row, row) = largest;
      kept.fixed.push_back(row);
    }
  kept.movable.clear();
}

FrictionSolution solve(FrictionProblem& problem, double scale, double tolerance,
                       StickSlipFactor& factor, bool renew) {
  constexpr int iteration_limit = 200;
  constexpr double slow = 0.1;  // a factor that leaves more of the violation is renewed
  FrictionSolution solution;
  for (solution.iterations = 1; solution.iterations <= iteration_limit; ++solution.iterations) {
    problem.sweep();
    solution.residual = scale > 0 ? problem.violation() / scale : 0;
    // Sweeps find who slips. Newton's steps after one another need no more of them.
    for (;;) {
      if (solution.residual <= tolerance) return solution;
      const double before = solution.residual;
      if (!problem.newton_step(factor, renew)) {
        renew = true;
        break;
      }
      solution.residual = problem.violation() / scale;
      renew = solution.residual > slow * before;
      if (renew) break;
    }
    if (solution.residual <= tolerance) return solution;
  }
  throw ConvergenceError("friction on the contact", iteration_limit, solution.residual,
                         "stick and slip keep changing; take smaller increments");
}

}  // namespace

FrictionSolution solve_friction(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& limit,
                                const Eigen::VectorXd& target, Eigen::VectorXd& force,
                                StickSlipFactor* kept, double tolerance) {
  StickSlipFactor own;
  StickSlipFactor& factor = kept ? *kept : own;
  cover(compliance, limit, factor);
  if (factor.points.empty()) {
    force.setZero();
    return {};
  }
  const std::vector<Index> rows = rows_of(factor.points);
  const Eigen::VectorXd limit_of_points = limit(factor.points);
  Eigen::VectorXd target_of_points = target(rows);
  target_of_points(factor.fixed).setZero();
  Eigen::VectorXd force_of_points = force(rows);
  force_of_points(factor.fixed).setZero();
  FrictionProblem problem(factor.compliance, limit_of_points, target_of_points, force_of_points);
  const FrictionSolution solution =
      solve(problem, target.cwiseAbs().maxCoeff(), tolerance, factor, kept == nullptr);
  force.setZero();
  for (std::size_t k = 0; k < rows.size(); ++k)
    force[rows[k]] = force_of_points[static_cast<Index>(k)];
  return solution;
}

}  // namespace softfinger::fem
