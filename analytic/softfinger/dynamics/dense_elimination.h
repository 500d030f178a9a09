#pragma once

#include <Eigen/Core>
#include <vector>

/// Internal: Gauss' elimination in place, which allocates nothing.
namespace softfinger::internal {

/// Gauss' elimination with row pivoting.
///
/// Not Eigen::PartialPivLU: it allocates in every call, two vectors of permutations, and buffers of
/// its products from 400 unknowns on, which a step of a simulator must not. Up to 80 unknowns it
/// takes 1.3 to 1.8 times as long as this, at 160 the same, at 400 0.84 times. Plain loops, because
/// with Eigen's own products there are no wide instructions, and columns are short.
class DenseElimination {
 public:
  explicit DenseElimination(int capacity)
      : matrix_(capacity, capacity), pivots_(std::size_t(capacity)) {}

  /// To be filled before `factorise`, which overwrites it.
  Eigen::MatrixXd& matrix() { return matrix_; }
  /// False where the matrix is singular.
  bool factorise(int size);
  /// Replaces `right` by the solution.
  void substitute(Eigen::VectorXd& right) const;
  void forget() { size_ = 0; }
  int size() const { return size_; }  ///< of the last decomposition; 0: none

 private:
  Eigen::MatrixXd matrix_;
  std::vector<int> pivots_;  ///< rows that were exchanged
  int size_ = 0;
};

}  // namespace softfinger::internal
