#include "softfinger/dynamics/exact/pattern_elimination.h"

#include <algorithm>
#include <cmath>

#include "softfinger/math/repeat.h"
#include "softfinger/math/wide.h"

namespace softfinger::internal {
namespace {

constexpr int kPart = kFour;
/// Number of columns that are updated together, to share what is read for them.
constexpr int kColumns = 2;

/// Between columns: room for a part that begins in the last row, and an odd number of parts, so
/// that the elements of a row do not share a set of the cache.
constexpr std::ptrdiff_t stride_of(int size) {
  return kPart * std::ptrdiff_t((size + 3 * kPart - 2) / kPart | 1);
}

}  // namespace

PatternElimination::PatternElimination(int capacity)
    : values_(Eigen::VectorXd::Zero(stride_of(capacity) * capacity)),
      // A column has less than a part for each row below it.
      panels_(kPart * std::ptrdiff_t(capacity) * capacity / 2),
      solution_(Eigen::VectorXd::Zero(stride_of(capacity))) {
  groups_.reserve(std::size_t(capacity));
  rows_.reserve(std::size_t(capacity) * std::size_t(capacity) / 2);
  parts_.reserve(rows_.capacity());
  nonzero_parts_.reserve(rows_.capacity());
}

void PatternElimination::set(const EliminationPattern& pattern) {
  size_ = pattern.size();
  stride_ = stride_of(size_);
  groups_.clear();
  rows_.clear();
  parts_.clear();
  std::ptrdiff_t panel = 0;
  for (int first = 0; first < size_; first += pattern.width(first)) {
    const int width = pattern.width(first);
    const EliminationPattern::Rows rows = pattern.rows(first + width - 1);
    Group group = {first, width, int(rows_.size()), rows.count, int(parts_.size()), 0, 0, panel};
    for (int a = 0; a < rows.count; ++a) {
      const int row = rows.first[a];
      rows_.push_back(row);
      if (group.parts > 0 && row < parts_.back() + kPart) continue;
      parts_.push_back(row);
      ++group.parts;
    }
    groups_.push_back(group);
    panel += std::ptrdiff_t(width) * kPart * group.parts;
  }
  nonzero_parts_.resize(parts_.size());
}

PatternElimination::Matrix PatternElimination::identity() {
  with_best_instructions([&] {
    const Four zeros = {};
    for (const Group& group : groups_) {
      for (int p = 0; p < group.width; ++p) {
        double* own = column(group.first + p);
        store(zeros, own + group.first);
        store(zeros, own + group.first + kFour);
        for (int k = 0; k < group.parts; ++k)
          store(zeros, own + parts_[std::size_t(group.first_part + k)]);
      }
      for (int a = 0; a < group.rows; ++a) {
        double* right = column(rows_[std::size_t(group.first_row + a)]) + group.first;
        store(zeros, right);
        store(zeros, right + kFour);
      }
    }
  });
  for (int j = 0; j < size_; ++j) column(j)[j] = 1;
  return Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>(values_.data(), size_, size_,
                                                              Eigen::OuterStride<>(stride_));
}

bool PatternElimination::factorise() {
  return with_best_instructions([this] { return eliminate(); });
}

bool PatternElimination::eliminate() {
  static_assert(EliminationPattern::kWidestGroup == 6);
  for (Group& group : groups_) {
    const bool is_regular = group.width == 1   ? eliminate_group<1>(group)
                            : group.width == 2 ? eliminate_group<2>(group)
                            : group.width == 3 ? eliminate_group<3>(group)
                            : group.width == 4 ? eliminate_group<4>(group)
                            : group.width == 5 ? eliminate_group<5>(group)
                                               : eliminate_group<6>(group);
    if (!is_regular) return false;
  }
  return true;
}

/// The columns of a group, then what they change in others.
template <int width>
bool PatternElimination::eliminate_group(Group& group) {
  constexpr double kLeastPivot = 1e-8;  // of its column
  double *block[width], largest[width];
  for (int p = 0; p < width; ++p) {
    double* own = block[p] = column(group.first + p) + group.first;
    for (int q = 0; q < p; ++q)
      for (int row = q + 1; row < width; ++row) own[row] -= block[q][row] * own[q];
    largest[p] = 0;
    for (int row = p + 1; row < width; ++row) largest[p] = std::max(largest[p], std::abs(own[row]));
    if (!(std::abs(own[p]) > kLeastPivot * largest[p])) return false;
    own[p] = 1 / own[p];
    for (int row = p + 1; row < width; ++row) own[row] *= own[p];
  }
  const int* parts = parts_.data() + group.first_part;
  int* nonzero = nonzero_parts_.data() + group.first_part;
  double* panel = panels_.data() + group.panel;
  Four squares = {};
  group.nonzero_parts = 0;
  for (int k = 0; k < group.parts; ++k) {
    Four values[width];
    auto any = Four{} != Four{};
    repeat<width>([&](int p) {
      load(block[p] + (parts[k] - group.first), values[p]);
      any = any | (values[p] != 0);
    });
    if ((any[0] | any[1] | any[2] | any[3]) == 0) continue;
    repeat<width>([&](int p) {
      Four value = values[p];
      for (int q = 0; q < p; ++q) value = value - block[p][q] * values[q];
      value = value * block[p][p];
      values[p] = value;
      store(value, panel + kPart * p);
      squares = squares + value * value;
    });
    panel += kPart * width;
    nonzero[group.nonzero_parts++] = parts[k];
  }
  const auto is_small = squares < 1 / (kLeastPivot * kLeastPivot);  // NaN is not
  if ((is_small[0] & is_small[1] & is_small[2] & is_small[3]) == 0) return false;
  const int *right = rows_.data() + group.first_row, *end = right + group.rows;
  const int* pair[kColumns];
  int count = 0;
  for (; right < end; ++right) {
    if (!eliminate_above<width>(group, *right)) continue;
    pair[count++] = right;
    if (count < kColumns) continue;
    eliminate_columns<width, kColumns>(group, pair);
    count = 0;
  }
  if (count > 0) eliminate_columns<width, 1>(group, pair);
  return true;
}

/// Eliminates the group's own rows in a column right of it. False if these are zero.
template <int width>
bool PatternElimination::eliminate_above(const Group& group, int right) {
  double* own = column(right) + group.first;
  double values[width];
  bool is_zero = true;
  repeat<width>([&](int p) {
    values[p] = own[p];
    is_zero = is_zero && values[p] == 0;
  });
  if (is_zero) return false;
  repeat<width>([&](int p) {
    const double* factors = column(group.first + p) + group.first;
    for (int row = p + 1; row < width; ++row) values[row] -= factors[row] * values[p];
    own[p] = values[p];
  });
  return true;
}

/// `count` of the columns right of a group.
template <int width, int count>
void PatternElimination::eliminate_columns(const Group& group, const int* const* right) {
  double* columns[count];
  Four above[count][width];
  for (int c = 0; c < count; ++c) {
    columns[c] = column(*right[c]);
    repeat<width>([&](int p) { above[c][p] = columns[c][group.first + p] - Four{}; });
  }
  const int* parts = nonzero_parts_.data() + group.first_part;
  const double* panel = panels_.data() + group.panel;
  for (int k = 0; k < group.nonzero_parts; ++k) {
    Four values[count];
    repeat<count>([&](int c) { load(columns[c] + parts[k], values[c]); });
    repeat<width>([&](int p) {
      Four factor;
      load(panel + kPart * p, factor);
      repeat<count>([&](int c) { values[c] = values[c] - above[c][p] * factor; });
    });
    repeat<count>([&](int c) { store(values[c], columns[c] + parts[k]); });
    panel += kPart * width;
  }
}

void PatternElimination::substitute(Eigen::VectorXd& right) {
  solution_.head(size_) = right.head(size_);
  with_best_instructions([&] { substitute_all(solution_.data()); });
  right.head(size_) = solution_.head(size_);
}

/// x = U_M^-1 L_M^-1 x, with room for a part that begins in the last row.
void PatternElimination::substitute_all(double* x) {
  for (const Group& group : groups_) {
    double* own = x + group.first;
    bool is_zero = true;
    for (int p = 0; p < group.width; ++p) {
      is_zero = is_zero && own[p] == 0;
      const double* factors = column(group.first + p) + group.first;
      for (int row = p + 1; row < group.width; ++row) own[row] -= factors[row] * own[p];
    }
    if (is_zero) continue;
    const double* panel = panels_.data() + group.panel;
    for (int k = 0; k < group.nonzero_parts; ++k) {
      double* below = x + nonzero_parts_[std::size_t(group.first_part + k)];
      Four value, factor;
      load(below, value);
      for (int p = 0; p < group.width; ++p, panel += kPart) {
        load(panel, factor);
        value = value - own[p] * factor;
      }
      store(value, below);
    }
  }
  for (auto group = groups_.rbegin(); group != groups_.rend(); ++group) {
    double* own = x + group->first;
    Four first, second;
    load(own, first);
    load(own + kPart, second);
    for (int a = 0; a < group->rows; ++a) {
      const int right = rows_[std::size_t(group->first_row + a)];
      const double* above = column(right) + group->first;
      Four factor;
      load(above, factor);
      first = first - factor * x[right];
      load(above + kPart, factor);
      second = second - factor * x[right];
    }
    // Elements behind the group are not its own.
    double sums[2 * kPart];
    store(first, sums);
    store(second, sums + kPart);
    std::copy_n(sums, group->width, own);
    for (int p = group->width - 1; p >= 0; --p) {
      const double* above = column(group->first + p) + group->first;
      own[p] *= above[p];
      for (int row = 0; row < p; ++row) own[row] -= above[row] * own[p];
    }
  }
}

}  // namespace softfinger::internal
