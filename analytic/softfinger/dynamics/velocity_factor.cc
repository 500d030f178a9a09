#include "softfinger/dynamics/velocity_factor.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace softfinger::internal {
namespace {

/// What is left of W where it would be zero but for rounding, over the roots of W's diagonal
/// elements: a dozen roundings. A small pivot would enlarge it to elements of L between
/// contacts that have no velocity in common.
constexpr double kRounding = 3e-15;
constexpr int kNotCounted = -1, kNoPivot = -2;
constexpr int kEliminated = std::numeric_limits<int>::max();

}  // namespace

VelocityFactor::VelocityFactor(int contact_capacity)
    : units_(4 * contact_capacity),
      values_(16 * std::ptrdiff_t(contact_capacity) * contact_capacity),
      original_(4 * contact_capacity),
      first_(std::size_t(contact_capacity) + 1),
      columns_(4 * std::size_t(contact_capacity) * std::size_t(contact_capacity)),
      pattern_(std::size_t(4 * contact_capacity)),
      neighbours_(std::size_t(contact_capacity)),
      rest_(4 * contact_capacity, 4 * contact_capacity),
      pivots_(std::size_t(4 * contact_capacity)),
      eliminated_(std::size_t(4 * contact_capacity)),
      meet_(16 * std::size_t(contact_capacity) * std::size_t(contact_capacity)),
      met_(std::size_t(4 * contact_capacity)),
      order_(std::size_t(4 * contact_capacity)) {}

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
  std::fill(eliminated_.begin(), eliminated_.begin() + size_, char(false));
  rank_ = 0;
  is_known_ = true;
  // Small pivots come last: they would enlarge the rounding of what is left.
  for (const double least : {1e-1, 1e-2, 1e-4, 1e-8, 1e-12}) {
    std::fill(neighbours_.begin(), neighbours_.begin() + nc, kNotCounted);
    for (int contact = next_contact(nc, least); contact >= 0; contact = next_contact(nc, least))
      for (int pivot = largest_pivot(contact, least); pivot >= 0;
           pivot = largest_pivot(contact, least))
        eliminate(pivot);
  }

  order_columns(nc);
  std::ptrdiff_t end = 0;
  for (int i = 0; i < nc; ++i) {
    first_[std::size_t(i)] = end;
    const std::ptrdiff_t first = end;
    for (int column = 0; column < rank_; ++column)
      if (!rest_.col(pivots_[std::size_t(column)]).segment<4>(4 * i).isZero(0))
        columns_[std::size_t(end++)] = column;
    Eigen::Map<Eigen::Matrix<double, 4, Eigen::Dynamic, Eigen::RowMajor>> own(
        values_.data() + 4 * first, 4, end - first);
    for (std::ptrdiff_t k = first; k < end; ++k)
      own.col(k - first) =
          rest_.col(pivots_[std::size_t(columns_[std::size_t(k)])]).segment<4>(4 * i);
  }
  first_[std::size_t(nc)] = end;
}

/// Columns of L that meet the fewest others left come first (least degree), so that sums of
/// L_i^T A L_i stay sparse when they are eliminated in this order.
void VelocityFactor::order_columns(int contacts) {
  const auto meet = [this](int a, int b) -> char& {
    return meet_[std::size_t(a) * std::size_t(rank_) + std::size_t(b)];
  };
  const auto count = [this, &meet](int column) {
    return int(std::count(&meet(column, 0), &meet(column, 0) + rank_, char(true)));
  };
  std::fill(meet_.begin(), meet_.begin() + std::ptrdiff_t(rank_) * rank_, char(false));
  for (int i = 0; i < contacts; ++i) {
    int own = 0;
    for (int column = 0; column < rank_; ++column)
      if (!rest_.col(pivots_[std::size_t(column)]).segment<4>(4 * i).isZero(0))
        pattern_[std::size_t(own++)] = column;
    for (int a = 0; a < own; ++a)
      for (int b = 0; b < own; ++b)
        meet(pattern_[std::size_t(a)], pattern_[std::size_t(b)]) = char(true);
  }
  for (int column = 0; column < rank_; ++column) met_[std::size_t(column)] = count(column);
  for (int place = 0; place < rank_; ++place) {
    const auto first = met_.begin(), last = first + rank_;
    const int next = int(std::min_element(first, last) - first);
    order_[std::size_t(place)] = pivots_[std::size_t(next)];
    met_[std::size_t(next)] = kEliminated;
    int left = 0;
    for (int column = 0; column < rank_; ++column) {
      if (!meet(next, column)) continue;
      meet(column, next) = char(false);
      if (column != next) pattern_[std::size_t(left++)] = column;
    }
    for (int a = 0; a < left; ++a) {
      const int column = pattern_[std::size_t(a)];
      for (int b = 0; b < left; ++b) meet(column, pattern_[std::size_t(b)]) = char(true);
      met_[std::size_t(column)] = count(column);
    }
  }
  std::copy(order_.begin(), order_.begin() + rank_, pivots_.begin());
}

/// The contact's row with the largest pivot left above `least` of W's; -1: none.
int VelocityFactor::largest_pivot(int contact, double least) const {
  int best = -1;
  for (int row = 4 * contact; row < 4 * contact + 4; ++row)
    if (!eliminated_[std::size_t(row)] && rest_(row, row) > least * original_[row] &&
        (best < 0 || rest_(row, row) > rest_(best, best)))
      best = row;
  return best;
}

/// Of the contacts with a pivot above `least` the one whose pivot meets the fewest rows in what is
/// left; -1: none.
int VelocityFactor::next_contact(int contacts, double least) {
  int best = -1;
  for (int i = 0; i < contacts; ++i) {
    int& count = neighbours_[std::size_t(i)];
    if (count == kNotCounted) {
      const int pivot = largest_pivot(i, least);
      count = pivot < 0
                  ? kNoPivot
                  : int((rest_.col(pivot).head(size_).array().square() >
                         kRounding * kRounding * original_[pivot] * original_.head(size_).array())
                            .count());
    }
    if (count != kNoPivot && (best < 0 || count < neighbours_[std::size_t(best)])) best = i;
  }
  return best;
}

/// Makes the pivot's column of what is left one of L.
void VelocityFactor::eliminate(int pivot) {
  const double value = rest_(pivot, pivot), root = std::sqrt(value);
  auto column = rest_.col(pivot).head(size_);
  column /= root;
  const double rounding = kRounding * std::sqrt(original_[pivot]) / root;
  int count = 0;
  for (int row = 0; row < size_; ++row) {
    if (column[row] == 0) continue;
    if (eliminated_[std::size_t(row)] ||
        std::abs(column[row]) <= rounding * std::sqrt(original_[row])) {
      column[row] = 0;
      continue;
    }
    pattern_[std::size_t(count++)] = row;
    neighbours_[std::size_t(row / 4)] = kNotCounted;
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
