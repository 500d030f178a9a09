#include "softfinger/dynamics/dense_elimination.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "softfinger/math/wide.h"

namespace softfinger::internal {
namespace {

/// to -= factor * from
inline void subtract(double factor, const double* __restrict from, int count,
                     double* __restrict to) {
  for (int i = 0; i < count; ++i) to[i] -= factor * from[i];
}

/// Columns that are eliminated together: each number of the rest is then read and written once
/// instead of once per column.
constexpr int kPanel = 4;

/// Rows of a panel that are not all zero: groups of as many as `Four` has, and the last few.
struct PanelRows {
  const int *first, *last;  ///< where the groups start
  int rest, end;            ///< rows after the last whole group
};

/// What the elimination of a panel's columns, whose pivots are in the rows from `first` on, changes
/// in one of the columns that follow.
inline void subtract_panel(const double* panel, std::ptrdiff_t stride, int first,
                           const PanelRows& rows, double* __restrict column) {
  const double *a = panel, *b = a + stride, *c = b + stride, *d = c + stride;
  double* pivots = column + first;
  const double p = pivots[0];
  const double q = pivots[1] - p * a[first + 1];
  const double r = pivots[2] - p * a[first + 2] - q * b[first + 2];
  const double s = pivots[3] - p * a[first + 3] - q * b[first + 3] - r * c[first + 3];
  if (p == 0 && q == 0 && r == 0 && s == 0) return;
  pivots[1] = q;
  pivots[2] = r;
  pivots[3] = s;
  for (const int* group = rows.first; group != rows.last; ++group) {
    const int row = *group;
    Four value, of_a, of_b, of_c, of_d;
    load(column + row, value);
    load(a + row, of_a);
    load(b + row, of_b);
    load(c + row, of_c);
    load(d + row, of_d);
    value = value - p * of_a - q * of_b - r * of_c - s * of_d;
    store(value, column + row);
  }
  for (int row = rows.rest; row < rows.end; ++row)
    column[row] = column[row] - p * a[row] - q * b[row] - r * c[row] - s * d[row];
}

/// The column's pivot goes to row `p` of all columns and divides what is below; returns the row
/// after the last one that is not zero, 0 where there is no pivot.
inline int find_pivot(double* matrix, std::ptrdiff_t stride, int size, int p, int* pivots) {
  constexpr double kLeastPivot = 0.1;  // of the largest one
  double* own = matrix + p * stride;
  // Of contacts in the order of their bodies only near ones feel each other: the rest is zero.
  int end = size;
  while (end > p + 1 && own[end - 1] == 0) --end;
  double largest = 0;
  for (int row = p + 1; row < end; ++row) largest = std::max(largest, std::abs(own[row]));
  // Rows stay where they are if they can: exchanged ones fill what was zero.
  int best = p;
  if (!(std::abs(own[p]) >= kLeastPivot * largest))
    for (int row = p + 1; row < end; ++row)
      if (std::abs(own[row]) > std::abs(own[best])) best = row;
  if (!(std::abs(own[best]) > 0)) return 0;
  pivots[p] = best;
  if (best != p)
    for (double* column = matrix; column < matrix + size * stride; column += stride)
      std::swap(column[p], column[best]);
  for (int row = p + 1; row < end; ++row) own[row] /= own[p];
  return end;
}

/// Columns are `stride` apart. `groups`: room for a quarter of the rows.
bool eliminate(double* matrix, std::ptrdiff_t stride, int size, int* pivots, int* groups) {
  for (int first = 0; first < size; first += kPanel) {
    const int next = std::min(first + kPanel, size);
    double* panel = matrix + first * stride;
    int end = next;
    for (int p = first; p < next; ++p) {
      const int own_end = find_pivot(matrix, stride, size, p, pivots);
      if (own_end == 0) return false;
      end = std::max(end, own_end);
      const double* own = matrix + p * stride + p + 1;
      for (double* column = matrix + (p + 1) * stride; column < matrix + next * stride;
           column += stride)
        if (column[p] != 0) subtract(column[p], own, own_end - p - 1, column + p + 1);
    }
    if (next == size) break;
    const int rest = next + (end - next) / kFour * kFour;
    int count = 0;
    for (int row = next; row < rest; row += kFour) {
      const auto is_zero = [row, stride](const double* column) {
        return std::all_of(column + row, column + row + kFour, [](double x) { return x == 0; });
      };
      if (!is_zero(panel) || !is_zero(panel + stride) || !is_zero(panel + 2 * stride) ||
          !is_zero(panel + 3 * stride))
        groups[count++] = row;
    }
    const PanelRows rows{groups, groups + count, rest, end};
    for (double* column = matrix + next * stride; column < matrix + size * stride; column += stride)
      subtract_panel(panel, stride, first, rows, column);
  }
  return true;
}

}  // namespace

bool DenseElimination::factorise(int size) {
  const bool is_regular = with_best_instructions([&] {
    return eliminate(matrix_.data(), matrix_.outerStride(), size, pivots_.data(), groups_.data());
  });
  size_ = is_regular ? size : 0;
  return is_regular;
}

void DenseElimination::substitute(Eigen::VectorXd& right) const {
  for (int p = 0; p < size_; ++p) std::swap(right[pivots_[std::size_t(p)]], right[p]);
  for (int p = 0; p < size_; ++p) {
    if (right[p] != 0)
      right.segment(p + 1, size_ - p - 1).noalias() -=
          right[p] * matrix_.col(p).segment(p + 1, size_ - p - 1);
  }
  for (int p = size_ - 1; p >= 0; --p) {
    right[p] /= matrix_(p, p);
    if (right[p] != 0) right.head(p).noalias() -= right[p] * matrix_.col(p).head(p);
  }
}

}  // namespace softfinger::internal
