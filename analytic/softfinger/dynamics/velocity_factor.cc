#include "softfinger/dynamics/velocity_factor.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace softfinger::internal {

VelocityFactor::VelocityFactor(int contact_capacity)
    : units_(4 * contact_capacity),
      values_(16 * std::ptrdiff_t(contact_capacity) * contact_capacity),
      original_(4 * contact_capacity),
      first_(std::size_t(contact_capacity) + 1),
      columns_(4 * std::size_t(contact_capacity) * std::size_t(contact_capacity)),
      order_(std::size_t(contact_capacity)),
      pattern_(std::size_t(4 * contact_capacity)),
      rest_(4 * contact_capacity, 4 * contact_capacity),
      pivots_(std::size_t(4 * contact_capacity)),
      eliminated_(std::size_t(4 * contact_capacity)),
      meet_(16 * std::size_t(contact_capacity) * std::size_t(contact_capacity)),
      met_(std::size_t(4 * contact_capacity)) {}

void VelocityFactor::factorise(const ContactOperator& contacts) {
  const int nc = contacts.contacts();
  size_ = 4 * nc;
  rest_.topLeftCorner(size_, size_).setZero();
  for (int i = 0; i < nc; ++i) {
    auto unit = units_.segment<4>(4 * i);
    unit.setOnes();
    if (!contacts.has_friction(i)) continue;
    for (int row = 1; row < 4; ++row) {
      const double impulse = contacts.impulse_scale()[4 * i + row];
      if (impulse > 0) unit[row] = contacts.velocity_scale()[4 * i + row] / impulse;
    }
  }
  for (int j = 0; j < nc; ++j)
    for (const int i : contacts.neighbours(j)) {
      auto block = rest_.block<4, 4>(4 * i, 4 * j);
      block = units_.segment<4>(4 * i).cwiseInverse().asDiagonal() *
              contacts.delassus().block<4, 4>(4 * i, 4 * j);
      if (!contacts.has_friction(i)) block.bottomRows<3>().setZero();
      if (!contacts.has_friction(j)) block.rightCols<3>().setZero();
    }
  original_.head(size_) = rest_.diagonal().head(size_);
  std::iota(order_.begin(), order_.begin() + nc, 0);
  std::sort(order_.begin(), order_.begin() + nc, [&contacts](int i, int j) {
    const auto a = contacts.neighbours(i).size(), b = contacts.neighbours(j).size();
    return a != b ? a < b : i < j;
  });

  std::fill(eliminated_.begin(), eliminated_.begin() + size_, char(false));
  rank_ = 0;
  is_known_ = true;
  // Small pivots come last: they would enlarge the rounding of what is left.
  for (const double least : {1e-2, 1e-4, 1e-8, 1e-12})
    for (int k = 0; k < nc; ++k) {
      const int contact = order_[std::size_t(k)];
      for (int rows = 0; rows < 4; ++rows) {
        int best = -1;
        for (int row = 4 * contact; row < 4 * contact + 4; ++row)
          if (!eliminated_[std::size_t(row)] && (best < 0 || rest_(row, row) > rest_(best, best)))
            best = row;
        if (best < 0 || !eliminate(best, least)) break;
      }
    }

  order_columns(nc);
  std::ptrdiff_t end = 0;
  for (int i = 0; i < nc; ++i) {
    first_[std::size_t(i)] = end;
    for (int column = 0; column < rank_; ++column) {
      const auto rows = rest_.col(pivots_[std::size_t(column)]).segment<4>(4 * i);
      if (rows.isZero(0)) continue;
      columns_[std::size_t(end)] = column;
      values_.segment<4>(4 * end++) = rows;
    }
  }
  first_[std::size_t(nc)] = end;
}

/// Columns of L that share contacts with few others come first, so that sums of L_i^T A L_i stay
/// sparse when they are eliminated in this order.
void VelocityFactor::order_columns(int contacts) {
  const auto meet = [this](int a, int b) -> char& {
    return meet_[std::size_t(a) * std::size_t(rank_) + std::size_t(b)];
  };
  std::fill(meet_.begin(), meet_.begin() + std::ptrdiff_t(rank_) * rank_, char(false));
  for (int i = 0; i < contacts; ++i) {
    int count = 0;
    for (int column = 0; column < rank_; ++column)
      if (!rest_.col(pivots_[std::size_t(column)]).segment<4>(4 * i).isZero(0))
        pattern_[std::size_t(count++)] = column;
    for (int a = 0; a < count; ++a)
      for (int b = 0; b < count; ++b)
        meet(pattern_[std::size_t(a)], pattern_[std::size_t(b)]) = char(true);
  }
  for (int column = 0; column < rank_; ++column)
    met_[std::size_t(pivots_[std::size_t(column)])] =
        int(std::count(&meet(column, 0), &meet(column, 0) + rank_, char(true)));
  std::sort(pivots_.begin(), pivots_.begin() + rank_, [this](int a, int b) {
    const int of_a = met_[std::size_t(a)], of_b = met_[std::size_t(b)];
    return of_a != of_b ? of_a < of_b : a < b;
  });
}

/// Makes the pivot's column of what is left one of L. False where the pivot is too small.
bool VelocityFactor::eliminate(int pivot, double least) {
  constexpr double kRounding = 1e-15;
  const double value = rest_(pivot, pivot);
  if (!(value > least * original_[pivot])) return false;
  auto column = rest_.col(pivot).head(size_);
  column /= std::sqrt(value);
  int count = 0;
  for (int row = 0; row < size_; ++row) {
    if (column[row] == 0) continue;
    if (eliminated_[std::size_t(row)] ||
        std::abs(column[row]) <= kRounding * std::sqrt(original_[row])) {
      column[row] = 0;
      continue;
    }
    pattern_[std::size_t(count++)] = row;
  }
  eliminated_[std::size_t(pivot)] = true;
  for (int a = 0; a < count; ++a) {
    const int to = pattern_[std::size_t(a)];
    if (eliminated_[std::size_t(to)]) continue;
    const double factor = column[to];
    for (int b = 0; b < count; ++b) {
      const int row = pattern_[std::size_t(b)];
      rest_(row, to) -= factor * column[row];
    }
  }
  for (int a = 0; a < count; ++a) {
    const int row = pattern_[std::size_t(a)];
    if (!eliminated_[std::size_t(row)]) rest_(pivot, row) = 0;
  }
  pivots_[std::size_t(rank_++)] = pivot;
  return true;
}

Eigen::Vector4d VelocityFactor::multiply(int contact, const Eigen::VectorXd& x) const {
  const Rows own = rows(contact);
  const int* column = columns(contact);
  Eigen::Vector4d result = Eigen::Vector4d::Zero();
  for (Eigen::Index k = 0; k < own.cols(); ++k) result += x[column[k]] * own.col(k);
  return result;
}

void VelocityFactor::add_transposed(int contact, const Eigen::Vector4d& y,
                                    Eigen::VectorXd& x) const {
  const Rows own = rows(contact);
  const int* column = columns(contact);
  for (Eigen::Index k = 0; k < own.cols(); ++k) x[column[k]] += own.col(k).dot(y);
}

}  // namespace softfinger::internal
