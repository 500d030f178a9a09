#include "softfinger/dynamics/bodies/cholesky.h"

#include <cmath>

namespace softfinger::internal {

bool factorise_cholesky(Eigen::Ref<Eigen::MatrixXd> matrix) {
  const Eigen::Index size = matrix.rows(), stride = matrix.outerStride();
  double* const first = matrix.data();
  for (Eigen::Index k = 0; k < size; ++k) {
    double* own = first + k * stride;
    // Half of the matrix of a free body is zero.
    for (Eigen::Index other = 0; other < k; ++other) {
      const double* from = first + other * stride;
      const double share = from[k];
      if (share == 0) continue;
      for (Eigen::Index row = k; row < size; ++row) own[row] -= share * from[row];
    }
    if (!(own[k] > 0)) return false;
    own[k] = std::sqrt(own[k]);
    for (Eigen::Index row = k + 1; row < size; ++row) own[row] /= own[k];
  }
  return true;
}

void solve_cholesky(const Eigen::Ref<const Eigen::MatrixXd>& factor,
                    Eigen::Ref<Eigen::VectorXd> x) {
  const Eigen::Index size = factor.rows(), stride = factor.outerStride();
  for (Eigen::Index k = 0; k < size; ++k) {
    const double* own = factor.data() + k * stride;
    x[k] /= own[k];
    for (Eigen::Index row = k + 1; row < size; ++row) x[row] -= own[row] * x[k];
  }
  for (Eigen::Index k = size - 1; k >= 0; --k) {
    const double* own = factor.data() + k * stride;
    for (Eigen::Index row = k + 1; row < size; ++row) x[k] -= own[row] * x[row];
    x[k] /= own[k];
  }
}

}  // namespace softfinger::internal
