#include "softfinger/dynamics/bodies/constrained_mass.h"

#include <cmath>

#include "softfinger/dynamics/bodies/symmetric_matrix.h"
#include "softfinger/math/wide.h"

namespace softfinger {

void ConstrainedMass::compute(const Eigen::MatrixXd& mass, const Eigen::MatrixXd& constraints) {
  factor_ = mass;
  internal::factorise_cholesky(factor_);
  root_.resize(0, constraints.rows());
  along_.resize(0, mass.cols());
  if (constraints.rows() == 0) return;
  Eigen::MatrixXd response = constraints.transpose();  // becomes K
  for (Eigen::Index row = 0; row < constraints.rows(); ++row)
    internal::solve_cholesky(factor_, response.col(row));
  const Eigen::MatrixXd coupling = constraints * response;  // S
  const Eigen::VectorXd scale =
      coupling.diagonal().unaryExpr([](double x) { return x > 0 ? 1 / std::sqrt(x) : 0.; });
  const internal::SymmetricModes modes(scale.asDiagonal() * coupling * scale.asDiagonal());
  constexpr double kRepeated = 1e-10;
  const double least = kRepeated * modes.values.maxCoeff();
  const Eigen::Index count = (modes.values.array() > least).count();
  if (!(least > 0) || count == 0) return;
  root_.resize(count, constraints.rows());
  Eigen::Index row = 0;
  for (Eigen::Index mode = 0; mode < modes.values.size(); ++mode)
    if (modes.values[mode] > least)
      root_.row(row++) =
          modes.vectors.col(mode).cwiseProduct(scale).transpose() / std::sqrt(modes.values[mode]);
  along_.noalias() = root_ * response.transpose();
}

Eigen::VectorXd ConstrainedMass::solve(const Eigen::VectorXd& x) const {
  Eigen::VectorXd result = x;
  solve_in_place(result);
  return result;
}

void ConstrainedMass::solve_in_place(Eigen::Ref<Eigen::VectorXd> x) const {
  if (!is_constrained()) {
    internal::solve_cholesky(factor_, x);
    return;
  }
  const Eigen::VectorXd taken = along_.transpose() * (along_ * x);
  internal::solve_cholesky(factor_, x);
  x -= taken;
}

/// X = J L^-T with M = L L^T, column after column: of few contacts there is little to do in each,
/// and of free bodies half of L is zero.
void ConstrainedMass::half(const Eigen::MatrixXd& jacobian, Eigen::MatrixXd& half) const {
  half = jacobian;
  const Eigen::Index rows = half.rows();
  with_best_instructions([&] {
    for (Eigen::Index k = 0; k < half.cols(); ++k) {
      double* own = half.data() + k * rows;
      for (Eigen::Index other = 0; other < k; ++other) {
        const double share = factor_(k, other);
        const double* from = half.data() + other * rows;
        if (share == 0) continue;
        for (Eigen::Index row = 0; row < rows; ++row) own[row] -= share * from[row];
      }
      for (Eigen::Index row = 0; row < rows; ++row) own[row] /= factor_(k, k);
    }
  });
}

Eigen::VectorXd ConstrainedMass::velocity_with(const Eigen::VectorXd& b) const {
  return along_.transpose() * (root_ * b);
}

}  // namespace softfinger
