#include "softfinger/dynamics/exact/velocity_factor.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>

#include "softfinger/math/wide.h"

namespace softfinger::internal {
namespace {

constexpr int kNotCounted = -1, kNoPivot = -2;
constexpr int kEliminated = std::numeric_limits<int>::max();

using Word = std::uint64_t;
constexpr int kWordBits = 64;
constexpr int words_of(int columns) { return (columns + kWordBits - 1) / kWordBits; }

}  // namespace

VelocityFactor::VelocityFactor(int contact_capacity)
    : units_(4 * contact_capacity),
      original_(4 * contact_capacity),
      left_(4 * contact_capacity),
      rows_(contact_capacity),
      elimination_(4 * contact_capacity),
      pattern_(std::size_t(4 * contact_capacity)),
      neighbours_(std::size_t(contact_capacity)),
      rest_(4 * contact_capacity, 4 * contact_capacity),
      pivots_(std::size_t(4 * contact_capacity)),
      eliminated_(std::size_t(4 * contact_capacity)),
      meet_((4 * std::size_t(contact_capacity) + 1) * std::size_t(words_of(4 * contact_capacity))),
      met_(std::size_t(4 * contact_capacity)),
      order_(std::size_t(4 * contact_capacity)) {}

void VelocityFactor::factorise(const ContactOperator& contacts) {
  const int nc = contacts.contacts();
  size_ = 4 * nc;
  for (int i = 0; i < nc; ++i) {
    auto unit = units_.segment<4>(4 * i);
    unit.setOnes();
    if (!contacts.has_friction(i)) continue;
    for (int row = 1; row < 4; ++row) {
      const double impulse = contacts.impulse_scale()[4 * i + row];
      if (impulse > 0) unit[row] = contacts.velocity_scale()[4 * i + row] / impulse;
    }
  }
  rank_ = 0;
  if (contacts.given_root())
    take_root(contacts);
  else
    decompose(contacts);
  is_known_ = true;
  order_columns(nc);
  rows_.clear();
  for (int i = 0; i < nc; ++i)
    rows_.append(4, rank_, [this, i](int k) { return &rest_(4 * i, pivots_[std::size_t(k)]); });
  elimination_.set(rows_, rank_);
}

/// The columns that are given, scaled.
void VelocityFactor::take_root(const ContactOperator& contacts) {
  const Eigen::SparseMatrix<double>& root = *contacts.given_root();
  for (Eigen::Index column = 0; column < root.cols(); ++column) {
    auto own = rest_.col(rank_).head(size_);
    own.setZero();
    bool is_zero = true;
    for (Eigen::SparseMatrix<double>::InnerIterator one(root, column); one; ++one) {
      const Eigen::Index row = one.row();
      if (row % 4 != 0 && !contacts.has_friction(int(row / 4))) continue;
      own[row] = contacts.impulse_scale()[row] * one.value();
      is_zero = is_zero && own[row] == 0;
    }
    if (is_zero) continue;
    pivots_[std::size_t(rank_)] = rank_;
    ++rank_;
  }
}

void VelocityFactor::decompose(const ContactOperator& contacts) {
  const int nc = contacts.contacts();
  rest_.topLeftCorner(size_, size_).setZero();
  for (int j = 0; j < nc; ++j)
    for (const int i : contacts.neighbours(j)) {
      auto block = rest_.block<4, 4>(4 * i, 4 * j);
      block = units_.segment<4>(4 * i).cwiseInverse().asDiagonal() *
              contacts.delassus().block<4, 4>(4 * i, 4 * j);
      if (!contacts.has_friction(i)) block.bottomRows<3>().setZero();
      if (!contacts.has_friction(j)) block.rightCols<3>().setZero();
    }
  original_.head(size_) = rest_.diagonal().head(size_);
  left_.head(size_) = original_.head(size_);
  std::fill(eliminated_.begin(), eliminated_.begin() + size_, char(false));
  // Small pivots come last: they would enlarge the rounding of what is left.
  for (const double least : {1e-1, 1e-2, 1e-4, 1e-8, 1e-12}) {
    std::fill(neighbours_.begin(), neighbours_.begin() + nc, kNotCounted);
    for (int contact = next_contact(nc, least); contact >= 0; contact = next_contact(nc, least))
      for (int pivot = largest_pivot(contact, least); pivot >= 0;
           pivot = largest_pivot(contact, least))
        eliminate(pivot);
  }
}

/// Columns of L that meet the fewest others left come first (least degree), so that sums of
/// L_i^T A L_i stay sparse when they are eliminated in this order.
void VelocityFactor::order_columns(int contacts) {
  const int words = words_of(rank_);
  const auto meet = [this, words](int column) { return meet_.data() + column * words; };
  const auto bit = [](int column) { return Word(1) << column % kWordBits; };
  const auto count = [words, &meet](int column) {
    int sum = 0;
    for (int k = 0; k < words; ++k) sum += int(std::bitset<kWordBits>(meet(column)[k]).count());
    return sum;
  };
  std::fill(meet_.begin(), meet_.begin() + rank_ * words, Word(0));
  Word* own = meet(rank_);
  for (int i = 0; i < contacts; ++i) {
    std::fill(own, own + words, Word(0));
    int met = 0;
    for (int column = 0; column < rank_; ++column) {
      if (rest_.col(pivots_[std::size_t(column)]).segment<4>(4 * i).isZero(0)) continue;
      own[column / kWordBits] |= bit(column);
      pattern_[std::size_t(met++)] = column;
    }
    for (int a = 0; a < met; ++a)
      for (int k = 0; k < words; ++k) meet(pattern_[std::size_t(a)])[k] |= own[k];
  }
  for (int column = 0; column < rank_; ++column) met_[std::size_t(column)] = count(column);
  for (int place = 0; place < rank_; ++place) {
    const auto first = met_.begin(), last = first + rank_;
    const int next = int(std::min_element(first, last) - first);
    order_[std::size_t(place)] = pivots_[std::size_t(next)];
    met_[std::size_t(next)] = kEliminated;
    for (int column = 0; column < rank_; ++column) {
      if (column == next || !(meet(next)[column / kWordBits] & bit(column))) continue;
      for (int k = 0; k < words; ++k) meet(column)[k] |= meet(next)[k];
      meet(column)[next / kWordBits] &= ~bit(next);
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

/// Finds the contact with a pivot above `least` whose pivot meets the fewest rows in what is left;
/// -1: none.
int VelocityFactor::next_contact(int contacts, double least) {
  int best = -1;
  for (int i = 0; i < contacts; ++i) {
    int& count = neighbours_[std::size_t(i)];
    if (count == kNotCounted) {
      const int pivot = largest_pivot(i, least);
      count = pivot < 0 ? kNoPivot : count_left(pivot);
    }
    if (count != kNoPivot && (best < 0 || count < neighbours_[std::size_t(best)])) best = i;
  }
  return best;
}

/// Rows that the pivot meets in what is left.
int VelocityFactor::count_left(int pivot) const {
  const double rounding = kRoundingLeft * kRoundingLeft * original_[pivot];
  const double *column = &rest_(0, pivot), *rows = left_.data();
  return with_best_instructions([&] {
    int count = 0;
    for (int row = 0; row < size_; ++row) count += column[row] * column[row] > rounding * rows[row];
    return count;
  });
}

/// Makes the pivot's column of what is left one of L.
void VelocityFactor::eliminate(int pivot) {
  const double value = rest_(pivot, pivot), root = std::sqrt(value);
  auto column = rest_.col(pivot).head(size_);
  column /= root;
  const double rounding = kRoundingLeft * std::sqrt(original_[pivot]) / root;
  int count = 0;  // of contacts with elements that are not zero
  for (int i = 0; i < size_ / 4; ++i) {
    bool is_zero = true;
    for (int row = 4 * i; row < 4 * i + 4; ++row) {
      if (column[row] == 0) continue;
      if (eliminated_[std::size_t(row)] ||
          std::abs(column[row]) <= rounding * std::sqrt(original_[row]))
        column[row] = 0;
      else
        is_zero = false;
    }
    if (is_zero) continue;
    pattern_[std::size_t(count++)] = i;
    neighbours_[std::size_t(i)] = kNotCounted;
  }
  eliminated_[std::size_t(pivot)] = true;
  left_[pivot] = std::numeric_limits<double>::infinity();
  const double* from = column.data();
  with_best_instructions([&] {
    for (int a = 0; a < count; ++a)
      for (int to = 4 * pattern_[std::size_t(a)], end = to + 4; to < end; ++to) {
        if (from[to] == 0 || to == pivot) continue;
        double* own = &rest_(0, to);
        for (int b = 0; b < count; ++b) {
          const int row = 4 * pattern_[std::size_t(b)];
          Four left, part;
          load(own + row, left);
          load(from + row, part);
          left = left - from[to] * part;
          store(left, own + row);
        }
      }
  });
  pivots_[std::size_t(rank_++)] = pivot;
}

}  // namespace softfinger::internal
