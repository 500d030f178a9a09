#include "softfinger/dynamics/dense_elimination.h"

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

/// Columns are `stride` apart.
bool eliminate(double* matrix, std::ptrdiff_t stride, int size, int* pivots) {
  constexpr double kLeastPivot = 0.1;  // of the largest one
  for (int p = 0; p < size; ++p) {
    double* own = matrix + p * stride;
    // Of contacts in the order of their bodies only near ones feel each other: the rest is zero.
    int best = p, last = p;
    for (int row = p + 1; row < size; ++row) {
      if (own[row] != 0) last = row;
      if (std::abs(own[row]) > std::abs(own[best])) best = row;
    }
    // Rows stay where they are if they can: exchanged ones fill what was zero.
    if (std::abs(own[p]) >= kLeastPivot * std::abs(own[best])) best = p;
    const double pivot = own[best];
    if (!(std::abs(pivot) > 0)) return false;
    pivots[p] = best;
    if (best != p)
      for (double* column = own; column < matrix + size * stride; column += stride)
        std::swap(column[p], column[best]);
    const int below = last - p;
    double* multipliers = own + p + 1;
    for (int i = 0; i < below; ++i) multipliers[i] /= pivot;
    for (double* column = own + stride; column < matrix + size * stride; column += stride)
      if (column[p] != 0) subtract(column[p], multipliers, below, column + p + 1);
  }
  return true;
}

}  // namespace

bool DenseElimination::factorise(int size) {
  const bool is_regular = with_best_instructions(
      [&] { return eliminate(matrix_.data(), matrix_.outerStride(), size, pivots_.data()); });
  size_ = is_regular ? size : 0;
  return is_regular;
}

void DenseElimination::substitute(Eigen::VectorXd& right) const {
  for (int p = 0; p < size_; ++p) {
    std::swap(right[pivots_[std::size_t(p)]], right[p]);
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
