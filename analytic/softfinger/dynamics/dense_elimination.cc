#include "softfinger/dynamics/dense_elimination.h"

#include <cmath>
#include <utility>

namespace softfinger::internal {

bool DenseElimination::factorise(int size) {
  size_ = 0;
  for (int p = 0; p < size; ++p) {
    int best = p;
    for (int row = p + 1; row < size; ++row)
      if (std::abs(matrix_(row, p)) > std::abs(matrix_(best, p))) best = row;
    const double pivot = matrix_(best, p);
    if (!(std::abs(pivot) > 0)) return false;
    pivots_[std::size_t(p)] = best;
    if (best != p) matrix_.row(best).segment(p, size - p).swap(matrix_.row(p).segment(p, size - p));
    // Of contacts in the order of their bodies only near ones feel each other: the rest is zero.
    int last = size - 1;
    while (last > p && matrix_(last, p) == 0) --last;
    auto multipliers = matrix_.col(p).segment(p + 1, last - p);
    multipliers /= pivot;
    for (int column = p + 1; column < size; ++column) {
      const double factor = matrix_(p, column);
      if (factor != 0)
        matrix_.col(column).segment(p + 1, last - p).noalias() -= factor * multipliers;
    }
  }
  size_ = size;
  return true;
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
