#include "softfinger/dynamics/exact/contact_rows.h"

#include "softfinger/math/repeat.h"
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
    double along[kFour];
    if constexpr (rows == kFour) {
      Four sum = {};
      repeat<rows>([&](int k) {
        Four part;
        load(own + rows * k, part);
        sum = sum + of[k][a] * part;
      });
      store(sum, along);
    } else {
      static_assert(rows == 1);
      along[0] = of[0][a] * own[0];
    }
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

/// x += L_i^T y, row by row.
template <int rows>
inline void add_transposed_of(const double* values, const int* columns, int width, const double* y,
                              double* x) {
  const int whole = width / kFour * kFour;
  for (int k = 0; k < whole; k += kFour) {
    Four sum, own;
    const bool follow_each_other = columns[k + kFour - 1] == columns[k] + kFour - 1;
    if (follow_each_other)
      load(x + columns[k], sum);
    else
      sum = Four{x[columns[k]], x[columns[k + 1]], x[columns[k + 2]], x[columns[k + 3]]};
    for (int row = 0; row < rows; ++row) {
      load(values + row * width + k, own);
      sum = sum + y[row] * own;
    }
    if (follow_each_other)
      store(sum, x + columns[k]);
    else
      for (int n = 0; n < kFour; ++n) x[columns[k + n]] = sum[n];
  }
  for (int k = whole; k < width; ++k)
    for (int row = 0; row < rows; ++row) x[columns[k]] += y[row] * values[row * width + k];
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
  const double* own = values(contact);
  const int* column = columns(contact);
  const int width = column_count(contact);
  with_best_instructions([&] {
    if (rows_[std::size_t(contact)] == 1)
      add_transposed_of<1>(own, column, width, y, x.data());
    else
      add_transposed_of<kMostRows>(own, column, width, y, x.data());
  });
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
