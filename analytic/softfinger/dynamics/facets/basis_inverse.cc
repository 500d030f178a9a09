#include "softfinger/dynamics/facets/basis_inverse.h"

#include <cmath>
#include <limits>
#include <utility>

namespace softfinger {

using Vector = Eigen::Map<const Eigen::VectorXd>;

BasisInverse::BasisInverse(int capacity) : inverse_(capacity, capacity), scratch_(capacity) {}

void BasisInverse::solve(const double* right, double* solution) const noexcept {
  // Right-hand sides of contact problems are mostly zeros. Summing up columns, these cost nothing.
  Eigen::Map<Eigen::VectorXd> x(solution, size_);
  x.setZero();
  for (int p = 0; p < size_; ++p)
    if (right[p] != 0) x.noalias() += right[p] * inverse_.col(p).head(size_);
}

void BasisInverse::solve_transposed(const double* left, double* solution) const noexcept {
  const Vector y(left, size_);
  for (int p = 0; p < size_; ++p) solution[p] = y.dot(inverse_.col(p).head(size_));
}

void BasisInverse::grow(const double* solved_column, const double* solved_row,
                        double pivot) noexcept {
  const Vector c(solved_column, size_), r(solved_row, size_);
  for (int p = 0; p < size_; ++p) {
    const double factor = r[p] / pivot;
    if (factor != 0) inverse_.col(p).head(size_).noalias() += factor * c;
    inverse_(size_, p) = -factor;
  }
  inverse_.col(size_).head(size_).noalias() = c * (-1 / pivot);
  inverse_(size_, size_) = 1 / pivot;
  ++size_;
}

void BasisInverse::replace_column(int p, const double* solved_column) noexcept {
  Eigen::VectorXd& c = scratch_;
  c.head(size_) = Vector(solved_column, size_);
  const double pivot = c[p];
  c[p] = 0;
  for (int q = 0; q < size_; ++q) {
    const double value = inverse_(p, q) / pivot;
    if (value != 0) inverse_.col(q).head(size_).noalias() -= value * c.head(size_);
    inverse_(p, q) = value;
  }
}

void BasisInverse::replace_row(int p, const double* solved_row) noexcept {
  inverse_.col(p).head(size_) /= solved_row[p];
  for (int q = 0; q < size_; ++q)
    if (q != p && solved_row[q] != 0)
      inverse_.col(q).head(size_).noalias() -= solved_row[q] * inverse_.col(p).head(size_);
}

void BasisInverse::shrink(int row, int column) noexcept {
  Eigen::VectorXd& c = scratch_;
  c.head(size_) = inverse_.col(row).head(size_);
  const double pivot = c[column];
  const int last = size_ - 1;
  for (int q = 0; q < size_; ++q) {
    if (q == row) continue;
    const double factor = inverse_(column, q) / pivot;
    if (factor != 0) inverse_.col(q).head(size_).noalias() -= factor * c.head(size_);
  }
  if (row != last) inverse_.col(row).head(size_) = inverse_.col(last).head(size_);
  if (column != last)
    for (int q = 0; q < last; ++q) inverse_(column, q) = inverse_(last, q);
  size_ = last;
}

bool BasisInverse::invert(double* matrix, int stride, int size) noexcept {
  size_ = size;
  const auto a = [=](int row, int column) -> double& { return matrix[row + column * stride]; };
  inverse_.topLeftCorner(size, size).setIdentity();
  double largest = 0;
  for (int q = 0; q < size; ++q)
    for (int p = 0; p < size; ++p) largest = std::max(largest, std::abs(a(p, q)));
  // The rows of A and of the right-hand side are exchanged together, so the inverse needs no
  // permutation afterwards.
  for (int step = 0; step < size; ++step) {
    int best = step;
    for (int p = step + 1; p < size; ++p)
      if (std::abs(a(p, step)) > std::abs(a(best, step))) best = p;
    const double pivot = a(best, step);
    if (!(std::abs(pivot) > size * std::numeric_limits<double>::epsilon() * 1e-3 * largest))
      return false;
    for (int q = 0; q < size; ++q) {
      if (best != step) {
        std::swap(inverse_(best, q), inverse_(step, q));
        if (q >= step) std::swap(a(best, q), a(step, q));
      }
      inverse_(step, q) /= pivot;
      if (q > step) a(step, q) /= pivot;
    }
    Eigen::VectorXd& c = scratch_;
    for (int p = 0; p < size; ++p) c[p] = p == step ? 0 : a(p, step);
    for (int q = 0; q < size; ++q) {
      const double factor = inverse_(step, q);
      if (factor != 0) inverse_.col(q).head(size).noalias() -= factor * c.head(size);
      if (q <= step) continue;
      const double own = a(step, q);
      if (own != 0) Eigen::Map<Eigen::VectorXd>(&a(0, q), size).noalias() -= own * c.head(size);
    }
  }
  return true;
}

}  // namespace softfinger
