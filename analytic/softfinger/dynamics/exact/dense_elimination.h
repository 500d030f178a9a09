#pragma once

#include <Eigen/Core>
#include <vector>

/// Internal: Gauss' elimination in place, which allocates nothing.
namespace softfinger::internal {

/// Gauss' elimination with row pivoting, in tiles of 4 x 4. Those that are zero are left out, and
/// rows stay where they are if they can: exchanged ones fill what was zero.
///
/// Not Eigen::PartialPivLU: it allocates in every call, two vectors of permutations, and buffers of
/// its products from 400 unknowns on, which a step of a simulator must not, and it does not leave
/// out what is zero. With Eigen's own products here there would be no wide instructions.
class DenseElimination {
 public:
  explicit DenseElimination(int capacity);

  using Matrix = Eigen::Ref<Eigen::MatrixXd>;
  /// Zeros, to be filled before `factorise`, which overwrites them.
  Matrix zeros(int size);
  /// False where the matrix is singular.
  bool factorise();
  /// Replaces `right` by the solution.
  void substitute(Eigen::VectorXd& right);

 private:
  Eigen::VectorXd values_;
  std::vector<int> pivots_;     ///< rows that were exchanged
  std::vector<char> has_tile_;  ///< whether a tile may have other elements than zero; by columns
  std::vector<int> rows_;       ///< tiles of a panel, while it factorises
  Eigen::VectorXd solution_;
  int size_ = 0;
};

}  // namespace softfinger::internal
