#pragma once

#include <Eigen/Core>
#include <vector>

namespace softfinger::fem {

/// Tangential forces under Coulomb friction with given limits.
struct FrictionSolution {
  int iterations = 0;
  double residual =
      0;  ///< worst violation of stick or of the slip's direction, over the largest target
};

/// The largest `FrictionSolution::residual` that is accepted, where the limits are those that
/// count.
constexpr double friction_tolerance = 1e-9;

/// Problems with one compliance share this. Of all points, those with a limit are far fewer: their
/// compliance is copied, so that the others' is not read in each iteration. Newton's factor is that
/// of one state of stick and slip: while the same points stick and slip, and their limits change
/// little, it still leads to the solution, at a tenth of the cost of another factor.
struct StickSlipFactor {
  std::vector<Eigen::Index> points;  ///< that have had a limit; the following are among these
  Eigen::MatrixXd compliance;
  std::vector<Eigen::Index> fixed;    ///< rows of it that cannot move, on mirror planes
  std::vector<Eigen::Index> movable;  ///< points with a limit
  std::vector<bool> slips;            ///< per point
  /// Lower triangle. A step of Newton's method need not be exact: single precision.
  Eigen::MatrixXf factor;
};

/// Finds q with C q + s = target, |q_i| <= limit_i, s_i = 0 where less, s_i parallel to q_i and of
/// its sense where equal: the minimum of q C q / 2 - q target over a product of discs, which is
/// unique. Block Gauss-Seidel with exact discs decides who slips, Newton's method on the stuck
/// forces and the directions of the slipping ones makes it exact. Any consistent units.
///
/// @param compliance  symmetric positive definite on points that can move, 2n x 2n, blocks x, y;
///                    zero rows for components that cannot: they bear no force
/// @param limit       n, >= 0
/// @param target      2n: displacement that full stick would need
/// @param force       2n: first guess and result
/// @param kept        of an earlier problem with the same compliance, whose copy it holds: made
///                    anew for another one; replaced; may be null
/// @param tolerance   of the solution's residual
/// @throws ConvergenceError
FrictionSolution solve_friction(const Eigen::MatrixXd& compliance, const Eigen::VectorXd& limit,
                                const Eigen::VectorXd& target, Eigen::VectorXd& force,
                                StickSlipFactor* kept = nullptr,
                                double tolerance = friction_tolerance);

}  // namespace softfinger::fem
