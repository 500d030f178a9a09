#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/math/wide.h"

/// Internal: Gauss' elimination in place, which allocates nothing.
namespace softfinger::internal {

/// Gauss' elimination with row pivoting.
///
/// Not Eigen::PartialPivLU: it allocates in every call, two vectors of permutations, and buffers of
/// its products from 400 unknowns on, which a step of a simulator must not. It takes 1.8 to 2.2
/// times as long as this up to 80 unknowns, 1.6 times at 160, 1.4 times at 400, and does not leave
/// out what is zero. With Eigen's own products here there would be no wide instructions.
class DenseElimination {
 public:
  explicit DenseElimination(int capacity)
      : matrix_(capacity, capacity),
        pivots_(std::size_t(capacity)),
        groups_(std::size_t(capacity / kFour + 1)) {}

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
  std::vector<int> groups_;  ///< of rows, while it factorises
  int size_ = 0;
};

}  // namespace softfinger::internal
