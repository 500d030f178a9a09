#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "softfinger/dynamics/exact/elimination_pattern.h"

/// Internal: Gauss' elimination of a matrix whose pattern is known.
namespace softfinger::internal {

/// Gauss' elimination in place, without exchanges of rows, of 1 and a sum of L_i^T A_i L_i, by
/// groups of columns that share their rows. Nothing is done outside of the pattern.
/// DenseElimination, which does exchange rows, takes three times as long.
class PatternElimination {
 public:
  explicit PatternElimination(int capacity);

  /// Sets the pattern; to be called before its first matrix.
  void set(const EliminationPattern& pattern);

  using Matrix = Eigen::Ref<Eigen::MatrixXd>;
  /// Ones on the diagonal, zeros elsewhere in the pattern: to be added to before `factorise`.
  Matrix identity();
  /// False where a pivot is too small beside its column.
  bool factorise();
  /// Replaces `right` by the solution.
  void substitute(Eigen::VectorXd& right);

 private:
  struct Group {
    int first, width;
    int first_row, rows;    ///< in rows_: not zero below the group
    int first_part, parts;  ///< in parts_
    int nonzero_parts;      ///< of this matrix
    std::ptrdiff_t panel;   ///< in panels_
  };

  // Inlined, for else they would not get the instructions of what calls them.
  [[gnu::always_inline]] inline bool eliminate();
  template <int width>
  [[gnu::always_inline]] inline bool eliminate_group(Group& group);
  template <int width>
  [[gnu::always_inline]] inline bool eliminate_above(const Group& group, int right);
  template <int width, int count>
  [[gnu::always_inline]] inline void eliminate_columns(const Group& group, const int* const* right);
  [[gnu::always_inline]] inline void substitute_all(double* x);

  double* column(int index) { return values_.data() + index * stride_; }

  int size_ = 0;
  std::ptrdiff_t stride_ = 0;
  std::vector<Group> groups_;
  std::vector<int> rows_;
  /// Rows below each group in parts of a vector's length: the first row of each. What they hold
  /// besides the group's rows is zero in its columns.
  std::vector<int> parts_, nonzero_parts_;
  Eigen::VectorXd values_;  ///< in the groups, and right of them U_M; the pivots inverted
  Eigen::VectorXd panels_;  ///< L_M below the groups, part by part
  Eigen::VectorXd solution_;
};

}  // namespace softfinger::internal
