#include "softfinger/dynamics/constrained_mass.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace softfinger {

void ConstrainedMass::compute(const Eigen::MatrixXd& mass, const Eigen::MatrixXd& constraints) {
  factors_.compute(mass);
  root_.resize(0, constraints.rows());
  along_.resize(0, mass.cols());
  if (constraints.rows() == 0) return;
  const Eigen::MatrixXd response = factors_.solve(constraints.transpose());  // K
  const Eigen::MatrixXd coupling = constraints * response;                   // S
  const Eigen::VectorXd scale =
      coupling.diagonal().unaryExpr([](double x) { return x > 0 ? 1 / std::sqrt(x) : 0.; });
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(scale.asDiagonal() * coupling *
                                                             scale.asDiagonal());
  constexpr double kRepeated = 1e-10;
  const Eigen::VectorXd& values = modes.eigenvalues();
  const double least = kRepeated * values.tail<1>()[0];
  const Eigen::Index count = (values.array() > least).count();
  if (!(least > 0) || count == 0) return;
  root_ = values.tail(count).cwiseSqrt().cwiseInverse().asDiagonal() *
          modes.eigenvectors().rightCols(count).transpose() * scale.asDiagonal();
  along_ = root_ * response.transpose();
}

Eigen::VectorXd ConstrainedMass::solve(const Eigen::VectorXd& x) const {
  Eigen::VectorXd result = factors_.solve(x);
  if (is_constrained()) result -= along_.transpose() * (along_ * x);
  return result;
}

Eigen::VectorXd ConstrainedMass::velocity_with(const Eigen::VectorXd& b) const {
  return along_.transpose() * (root_ * b);
}

}  // namespace softfinger
