#include "softfinger/dynamics/bodies/symmetric_matrix.h"

#include <cmath>
#include <limits>

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

/// Each rotation makes one element off the diagonal zero. The sum of their squares falls by it, at
/// last quadratically: a few sweeps are enough.
SymmetricModes::SymmetricModes(Eigen::MatrixXd matrix)
    : vectors(Eigen::MatrixXd::Identity(matrix.rows(), matrix.rows())) {
  constexpr int kMostSweeps = 50;
  const double none =
      std::numeric_limits<double>::epsilon() * matrix.diagonal().cwiseAbs().maxCoeff();
  const Eigen::Index size = matrix.rows();
  const auto rotate = [](double cosine, double sine, double& a, double& b) {
    const double before = a;
    a = cosine * before - sine * b;
    b = sine * before + cosine * b;
  };
  bool turns = true;
  for (int sweep = 0; sweep < kMostSweeps && turns; ++sweep) {
    turns = false;
    for (Eigen::Index q = 1; q < size; ++q)
      for (Eigen::Index p = 0; p < q; ++p) {
        const double off = matrix(p, q);
        if (!(std::abs(off) > none)) continue;
        turns = true;
        const double ratio = (matrix(q, q) - matrix(p, p)) / (2 * off);
        const double tangent =
            std::copysign(1., ratio) / (std::abs(ratio) + std::sqrt(1 + ratio * ratio));
        const double cosine = 1 / std::sqrt(1 + tangent * tangent), sine = tangent * cosine;
        for (Eigen::Index k = 0; k < size; ++k) rotate(cosine, sine, matrix(k, p), matrix(k, q));
        for (Eigen::Index k = 0; k < size; ++k) rotate(cosine, sine, matrix(p, k), matrix(q, k));
        for (Eigen::Index k = 0; k < size; ++k) rotate(cosine, sine, vectors(k, p), vectors(k, q));
      }
  }
  values = matrix.diagonal();
}

}  // namespace softfinger::internal
