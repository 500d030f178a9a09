#include "fem/algebra/fixed_point.h"

#include <Eigen/QR>
#include <algorithm>
#include <utility>

namespace softfinger::fem {

using Eigen::Index;

namespace {

/// Columns of the latest few, latest first.
void remember(const Eigen::VectorXd& latest, Eigen::MatrixXd& columns) {
  constexpr Index most = 8;
  const Index kept = std::min<Index>(most, columns.cols());
  Eigen::MatrixXd moved(latest.size(), kept + 1);
  moved.col(0) = latest;
  if (kept > 0) moved.rightCols(kept) = columns.leftCols(kept);
  columns = std::move(moved);
}

}  // namespace

Eigen::VectorXd FixedPoint::weights(const Eigen::VectorXd& residual) {
  remember(residual, residuals_);
  const Index differences = residuals_.cols() - 1;
  Eigen::VectorXd result = Eigen::VectorXd::Unit(differences + 1, 0);
  if (differences == 0) return result;
  const Eigen::MatrixXd changes =
      residuals_.leftCols(differences) - residuals_.rightCols(differences);
  const Eigen::VectorXd share = changes.colPivHouseholderQr().solve(residual);
  result.head(differences) -= share;
  result.tail(differences) += share;
  return result;
}

Eigen::VectorXd FixedPoint::next(const Eigen::VectorXd& x, const Eigen::VectorXd& image) {
  remember(image, images_);
  return images_ * weights(image - x);
}

void FixedPoint::restart() {
  residuals_.resize(0, 0);
  images_.resize(0, 0);
}

}  // namespace softfinger::fem
