#include "softfinger/dynamics/elimination_pattern.h"

#include <cstddef>

namespace softfinger::internal {

void EliminationPattern::set(const VelocityFactor& factor, int contacts) {
  size_ = factor.rank();
  nonzero_.assign(std::size_t(size_) * std::size_t(size_), char(false));
  for (int i = 0; i < contacts; ++i) {
    const int* columns = factor.rows().columns(i);
    const int count = factor.rows().column_count(i);
    for (int a = 0; a < count; ++a)
      for (int b = 0; b < count; ++b)
        nonzero_[std::size_t(columns[a]) * std::size_t(size_) + std::size_t(columns[b])] = true;
  }
  find_rows();
  find_groups();
}

/// A pivot fills the rows and columns that it meets.
void EliminationPattern::find_rows() {
  rows_.clear();
  first_.assign(1, 0);
  for (int k = 0; k < size_; ++k) {
    const char* column = &nonzero_[std::size_t(k) * std::size_t(size_)];
    const std::size_t first = rows_.size();
    for (int row = k + 1; row < size_; ++row)
      if (column[row]) rows_.push_back(row);
    first_.push_back(int(rows_.size()));
    for (std::size_t a = first; a < rows_.size(); ++a)
      for (std::size_t b = first; b < rows_.size(); ++b)
        nonzero_[std::size_t(rows_[a]) * std::size_t(size_) + std::size_t(rows_[b])] = true;
  }
}

void EliminationPattern::find_groups() {
  width_.assign(std::size_t(size_), 1);
  for (int first = 0; first < size_; first += width(first)) {
    int& width = width_[std::size_t(first)];
    for (int next = first + 1; next < size_ && width < kWidestGroup; ++next, ++width) {
      const Rows last = rows(next - 1);
      if (last.count == 0 || last.first[0] != next || rows(next).count != last.count - 1) break;
    }
  }
}

}  // namespace softfinger::internal
