#include "softfinger/dynamics/contact_rows.h"

#include "softfinger/math/wide.h"

namespace softfinger::internal {
namespace {

/// matrix += L_i^T A L_i, of `width` kept columns. `lower`: above the diagonal hardly anything.
template <int rows, bool lower>
inline void add_product_of(const double* values, const int* columns, int width, const double* own,
                           Eigen::Ref<Eigen::MatrixXd> matrix) {
  const int whole = width / kFour * kFour;
  const double* of[rows];
  for (int row = 0; row < rows; ++row) of[row] = values + row * width;
  for (int a = 0; a < width; ++a) {
    double along[rows] = {};
    for (int k = 0; k < rows; ++k)
      for (int row = 0; row < rows; ++row) along[row] += of[k][a] * own[rows * k + row];
    double* to = &matrix(0, columns[a]);
    for (int b = lower ? a / kFour * kFour : 0; b < whole; b += kFour) {
      Four part, sum;
      load(of[0] + b, part);
      sum = along[0] * part;
      for (int row = 1; row < rows; ++row) {
        load(of[row] + b, part);
        sum = sum + along[row] * part;
      }
      if (columns[b + kFour - 1] == columns[b] + kFour - 1) {
        load(to + columns[b], part);
        store(part + sum, to + columns[b]);
      } else {
        for (int k = 0; k < kFour; ++k) to[columns[b + k]] += sum[k];
      }
    }
    for (int b = whole; b < width; ++b) {
      double sum = along[0] * of[0][b];
      for (int row = 1; row < rows; ++row) sum += along[row] * of[row][b];
      to[columns[b]] += sum;
    }
  }
}

}  // namespace

ContactRows::ContactRows(int contact_capacity)
    : columns_(kMostRows * std::size_t(contact_capacity) * std::size_t(contact_capacity)),
      values_(kMostRows * kMostRows * std::ptrdiff_t(contact_capacity) * contact_capacity) {
  rows_.reserve(std::size_t(contact_capacity));
  first_.reserve(std::size_t(contact_capacity) + 1);
  clear();
}

void ContactRows::clear() {
  rows_.clear();
  first_.assign(1, 0);
}

void ContactRows::multiply(int contact, const Eigen::VectorXd& x, double* y) const {
  const int width = column_count(contact);
  const int* column = columns(contact);
  const double* own = values(contact);
  for (int row = 0; row < rows_[std::size_t(contact)]; ++row, own += width) {
    double sum = 0;
    for (int k = 0; k < width; ++k) sum += own[k] * x[column[k]];
    y[row] = sum;
  }
}

void ContactRows::add_transposed(int contact, const double* y, Eigen::VectorXd& x) const {
  const int width = column_count(contact);
  const int* column = columns(contact);
  const double* own = values(contact);
  for (int row = 0; row < rows_[std::size_t(contact)]; ++row, own += width)
    for (int k = 0; k < width; ++k) x[column[k]] += y[row] * own[k];
}

template <bool lower>
void ContactRows::add_part(int contact, const double* own,
                           Eigen::Ref<Eigen::MatrixXd> matrix) const {
  const double* own_rows = values(contact);
  const int* column = columns(contact);
  const int width = column_count(contact);
  with_best_instructions([&] {
    if (rows_[std::size_t(contact)] == 1)
      add_product_of<1, lower>(own_rows, column, width, own, matrix);
    else
      add_product_of<kMostRows, lower>(own_rows, column, width, own, matrix);
  });
}

void ContactRows::add_product(int contact, const double* own,
                              Eigen::Ref<Eigen::MatrixXd> matrix) const {
  add_part<false>(contact, own, matrix);
}

void ContactRows::add_lower_product(int contact, const double* own,
                                    Eigen::Ref<Eigen::MatrixXd> matrix) const {
  add_part<true>(contact, own, matrix);
}

}  // namespace softfinger::internal
