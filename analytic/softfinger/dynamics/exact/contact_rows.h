#pragma once

#include <Eigen/Core>
#include <vector>

/// Internal: matrices of which each contact has a few rows.
namespace softfinger::internal {

/// A decomposition leaves this of elements of W that would be zero but for rounding, over the roots
/// of W's diagonal elements: a dozen roundings. A small pivot would enlarge it to elements of L
/// between contacts that have no velocity in common.
constexpr double kRoundingLeft = 3e-15;

/// A matrix L in which each contact has one row or four, and each of its columns belongs to a few
/// contacts: kept are, of each contact, the columns that are not all zero.
class ContactRows {
 public:
  explicit ContactRows(int contact_capacity);

  void clear();
  /// The rows of the next contact.
  /// @param rows    1 or 4
  /// @param column  the contact's `rows` elements of column k: const double* column(int k)
  template <class Column>
  void append(int rows, int columns, const Column& column);

  int contacts() const { return int(rows_.size()); }
  /// Indices of the columns that are stored of the contact's rows L_i, ascending.
  const int* columns(int contact) const { return columns_.data() + first_[std::size_t(contact)]; }
  int column_count(int contact) const {
    return int(first_[std::size_t(contact) + 1] - first_[std::size_t(contact)]);
  }
  /// The kept elements, row by row.
  const double* values(int contact) const {
    return values_.data() + kMostRows * first_[std::size_t(contact)];
  }

  /// y = L_i x
  void multiply(int contact, const Eigen::VectorXd& x, double* y) const;
  /// x += L_i^T y
  void add_transposed(int contact, const double* y, Eigen::VectorXd& x) const;
  /// matrix += L_i^T A L_i
  /// @param own  A, column by column, as large as the contact has rows
  void add_product(int contact, const double* own, Eigen::Ref<Eigen::MatrixXd> matrix) const;
  /// Adds the same product for a symmetric A to the lower half of the matrix; the entries above the
  /// diagonal are then meaningless.
  void add_lower_product(int contact, const double* own, Eigen::Ref<Eigen::MatrixXd> matrix) const;

 private:
  template <bool lower>
  void add_part(int contact, const double* own, Eigen::Ref<Eigen::MatrixXd> matrix) const;

  static constexpr int kMostRows = 4;

  std::vector<int> rows_;
  std::vector<std::ptrdiff_t> first_;  ///< in columns_
  std::vector<int> columns_;
  Eigen::VectorXd values_;
};

template <class Column>
void ContactRows::append(int rows, int columns, const Column& column) {
  const std::ptrdiff_t first = first_.back();
  std::ptrdiff_t end = first;
  for (int k = 0; k < columns; ++k) {
    const double* own = column(k);
    bool is_zero = true;
    for (int row = 0; row < rows; ++row) is_zero = is_zero && own[row] == 0;
    if (!is_zero) columns_[std::size_t(end++)] = k;
  }
  double* values = values_.data() + kMostRows * first;
  for (int row = 0; row < rows; ++row)
    for (std::ptrdiff_t k = first; k < end; ++k) *values++ = column(columns_[std::size_t(k)])[row];
  rows_.push_back(rows);
  first_.push_back(end);
}

}  // namespace softfinger::internal
