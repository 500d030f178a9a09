#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "softfinger/dynamics/exact/contact_rows.h"

/// Internal: what is not zero when sums of L_i^T A L_i are eliminated.
namespace softfinger::internal {

/// The elements below the diagonal of L_M and, mirrored, right of that of U_M, for the sum M of
/// L_i^T A_i L_i over contacts, whatever the A_i: M = L_M U_M without an exchange of rows.
/// Neighbouring columns whose elements lie in the same rows make a group.
class EliminationPattern {
 public:
  static constexpr int kWidestGroup = 6;  ///< as many as a body has velocities

  /// @param capacity  of columns; `set` allocates nothing
  explicit EliminationPattern(int capacity);

  /// @param size  columns of L
  void set(const ContactRows& rows, int size);

  int size() const { return size_; }
  struct Rows {
    const int* first;
    int count;
  };
  /// Below the diagonal of this column, in rising order.
  Rows rows(int column) const {
    const int first = first_[std::size_t(column)];
    return {rows_.data() + first, first_[std::size_t(column) + 1] - first};
  }
  /// Columns of the group that begins with this one.
  int width(int column) const { return width_[std::size_t(column)]; }

 private:
  void find_rows();
  void find_groups();
  std::uint64_t* words(int column);

  int size_ = 0;
  std::vector<std::uint64_t> nonzero_;  ///< a bit per element, by columns
  std::vector<int> first_, rows_, width_;
};

}  // namespace softfinger::internal
