#pragma once

#include <Eigen/Core>

namespace softfinger {

/// The mass matrix M of a tree whose velocities v obey G v = b: how forces accelerate it.
///
/// Eliminates the equality rows of the complementarity problem of a step,
///
///   M v = x + G^T y,   G v = b   =>   v = P x + K S^+ b,   P = M^-1 - K S^+ K^T,
///
/// with K = M^-1 G^T and S = G K, which is exact. Rows that repeat others, as those of a planar
/// linkage on hinges do, have no part: S^+ is the pseudo-inverse of S with its rows scaled to
/// diagonal 1, where eigenvalues below 1e-10 of the largest count as zero.
class ConstrainedMass {
 public:
  /// @param mass  symmetric, positive definite
  /// @param constraints  G, any number of rows
  void compute(const Eigen::MatrixXd& mass, const Eigen::MatrixXd& constraints);
  void compute(const Eigen::MatrixXd& mass) { compute(mass, Eigen::MatrixXd(0, mass.cols())); }

  bool is_constrained() const { return along_.rows() > 0; }
  /// P x: what forces change of velocities that obey the constraints.
  Eigen::VectorXd solve(const Eigen::VectorXd& x) const;
  void solve_in_place(Eigen::Ref<Eigen::VectorXd> x) const;
  /// K S^+ b: the least change of velocity, measured by its energy, with G v = b.
  Eigen::VectorXd velocity_with(const Eigen::VectorXd& b) const;
  /// X and Y with J P J^T = X X^T - Y Y^T, of which Y is what the constraints take away.
  void half(const Eigen::MatrixXd& jacobian, Eigen::MatrixXd& half) const;
  Eigen::MatrixXd half_taken(const Eigen::MatrixXd& jacobian) const {
    return jacobian * along_.transpose();
  }

 private:
  Eigen::MatrixXd factor_;  ///< L of M = L L^T, in the lower triangle
  Eigen::MatrixXd root_;    ///< S^+ = root^T root
  Eigen::MatrixXd along_;   ///< root K^T
};

}  // namespace softfinger
