#pragma once

#include <Eigen/Core>

namespace softfinger {

/// The explicit inverse of a square matrix A, the active part of a complementary basis, that grows,
/// shrinks and exchanges rows and columns one at a time, in O(k²) each. Row p of the inverse
/// belongs to column p of A and the other way round.
///
/// No operation allocates after construction. The updates do not pivot for stability: the caller
/// chooses pivots that are large enough, measures the error of what it solves, and calls `invert`
/// when that has grown.
class BasisInverse {
 public:
  explicit BasisInverse(int capacity = 0);

  int capacity() const noexcept { return int(inverse_.rows()); }
  int size() const noexcept { return size_; }
  void clear() noexcept { size_ = 0; }

  /// inverse * `right`: the solution x of A x = right. Both of length size().
  void solve(const double* right, double* solution) const noexcept;

  /// left^T * inverse: the solution y of y^T A = left^T.
  void solve_transposed(const double* left, double* solution) const noexcept;

  /// Column p of the inverse: the solution of A x = e_p, e_p of row p.
  const double* column(int p) const noexcept { return inverse_.col(p).data(); }

  /// A becomes [A, c; r^T, s] with `solved_column` = A^-1 c and `solved_row` = r^T A^-1; `pivot` is
  /// s - r^T A^-1 c.
  void grow(const double* solved_column, const double* solved_row, double pivot) noexcept;

  /// Column p of A is replaced by c with `solved_column` = A^-1 c.
  void replace_column(int p, const double* solved_column) noexcept;

  /// Row p of A is replaced by r with `solved_row` = r^T A^-1.
  void replace_row(int p, const double* solved_row) noexcept;

  /// Row `row` and column `column` of A are dropped; the last ones take their places.
  void shrink(int row, int column) noexcept;

  /// Inverts A anew, by Gauss-Jordan elimination with row pivoting, O(k³). (Eigen's decompositions
  /// allocate.) False when A is singular to round-off; the old inverse is then lost.
  /// @param matrix  A, its columns `stride` apart; overwritten
  bool invert(double* matrix, int stride, int size) noexcept;

 private:
  Eigen::MatrixXd inverse_;
  Eigen::VectorXd scratch_;
  int size_ = 0;
};

}  // namespace softfinger
