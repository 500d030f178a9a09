#include "softfinger/dynamics/exact/elimination_pattern.h"

#include <algorithm>

namespace softfinger::internal {
namespace {

using Word = std::uint64_t;
constexpr int kWordBits = 64;
constexpr std::size_t words_of(int columns) {
  return std::size_t(columns + kWordBits - 1) / kWordBits;
}

constexpr Word bit(int row) { return Word(1) << row % kWordBits; }

}  // namespace

EliminationPattern::EliminationPattern(int capacity)
    : nonzero_(std::size_t(capacity) * words_of(capacity)) {
  first_.reserve(std::size_t(capacity) + 1);
  rows_.reserve(std::size_t(capacity) * std::size_t(capacity) / 2);
  width_.reserve(std::size_t(capacity));
}

std::uint64_t* EliminationPattern::words(int column) {
  return nonzero_.data() + std::size_t(column) * words_of(size_);
}

void EliminationPattern::set(const ContactRows& rows, int size) {
  size_ = size;
  std::fill_n(nonzero_.begin(), std::size_t(size) * words_of(size), Word(0));
  for (int i = 0; i < rows.contacts(); ++i) {
    const int* columns = rows.columns(i);
    const int count = rows.column_count(i);
    for (int a = 0; a < count; ++a) {
      Word* own = words(columns[a]);
      for (int b = a + 1; b < count; ++b) own[columns[b] / kWordBits] |= bit(columns[b]);
    }
  }
  find_rows();
  find_groups();
}

/// A column's rows are filled in the column of the first of them, from where later ones get them.
void EliminationPattern::find_rows() {
  rows_.clear();
  first_.assign(1, 0);
  for (int k = 0; k < size_; ++k) {
    const Word* own = words(k);
    const std::size_t first = rows_.size();
    for (int row = k + 1; row < size_; ++row)
      if (own[row / kWordBits] & bit(row)) rows_.push_back(row);
    first_.push_back(int(rows_.size()));
    if (rows_.size() == first) continue;
    const int next = rows_[first];
    Word* filled = words(next);
    for (std::size_t word = 0; word < words_of(size_); ++word) filled[word] |= own[word];
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
