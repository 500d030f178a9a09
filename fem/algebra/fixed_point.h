#pragma once

#include <Eigen/Core>

namespace softfinger::fem {

/// Anderson's mixing for x = g(x) (D. G. Anderson, J. ACM 12, 1965): the next x is the combination
/// of the latest images g(x) whose residuals g(x) - x would cancel best if g were affine.
class FixedPoint {
 public:
  /// @param residual  g(x) - x of the latest x
  /// @returns weights of the latest images, that of the latest x first, which sum to 1
  Eigen::VectorXd weights(const Eigen::VectorXd& residual);

  /// @param x      where g was evaluated
  /// @param image  g(x)
  /// @returns where to evaluate it next
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& image);

  /// Forgets all, as when g has become another function.
  void restart();

 private:
  Eigen::MatrixXd residuals_, images_;  ///< latest first
};

}  // namespace softfinger::fem
