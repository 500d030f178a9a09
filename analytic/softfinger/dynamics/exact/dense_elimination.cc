#include "softfinger/dynamics/exact/dense_elimination.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "softfinger/math/wide.h"

namespace softfinger::internal {
namespace {

constexpr int tiles_of(int size) { return (size + kFour - 1) / kFour; }

/// Columns lie an odd number of tiles apart, so that the elements of a row do not share a set of
/// the cache.
constexpr std::ptrdiff_t stride_of(int tiles) { return kFour * std::ptrdiff_t(tiles | 1); }

/// Columns of a matrix in tiles, `stride` apart, and which tiles are not zero.
struct Tiles {
  double* matrix;
  std::ptrdiff_t stride;
  int count;  ///< per row and column
  char* nonzero;

  double* column(int index) const { return matrix + index * stride; }
  char& has(int row, int column) const { return nonzero[column * count + row]; }
};

/// One tile, in its four columns.
struct Tile {
  Four a, b, c, d;

  Tile(const double* first, std::ptrdiff_t stride) {
    load(first, a);
    load(first + stride, b);
    load(first + 2 * stride, c);
    load(first + 3 * stride, d);
  }
  /// from -= tile x
  void subtract(const double* x, double* from) const {
    Four value;
    load(from, value);
    value = value - x[0] * a - x[1] * b - x[2] * c - x[3] * d;
    store(value, from);
  }
};

void find_tiles(const Tiles& tiles) {
  for (int j = 0; j < tiles.count; ++j)
    for (int i = 0; i < tiles.count; ++i) {
      const Tile tile(tiles.column(kFour * j) + kFour * i, tiles.stride);
      const auto nonzero = (tile.a != 0) | (tile.b != 0) | (tile.c != 0) | (tile.d != 0);
      tiles.has(i, j) = char((nonzero[0] | nonzero[1] | nonzero[2] | nonzero[3]) != 0);
    }
}

/// The row of the pivot of column p: p itself if its element is large enough. `rows`: the tiles
/// below p's own.
int find_pivot(const double* own, int p, const int* rows, const int* end) {
  constexpr double kLeastPivot = 1e-2;  // of the largest one
  const int own_end = (p / kFour + 1) * kFour;
  Four size, largest = {0, 0, 0, 0};
  for (const int* tile = rows; tile != end; ++tile) {
    load(own + kFour * *tile, size);
    size = size < 0 ? -size : size;
    largest = size > largest ? size : largest;
  }
  double most = std::max(std::max(largest[0], largest[1]), std::max(largest[2], largest[3]));
  for (int row = p + 1; row < own_end; ++row) most = std::max(most, std::abs(own[row]));
  if (std::abs(own[p]) >= kLeastPivot * most) return p;
  for (int row = p + 1; row < own_end; ++row)
    if (std::abs(own[row]) == most) return row;
  for (const int* tile = rows; tile != end; ++tile)
    for (int row = kFour * *tile; row < kFour * (*tile + 1); ++row)
      if (std::abs(own[row]) == most) return row;
  return p;
}

/// Exchanges rows p and `other`, which may then fill each other's tiles.
void exchange(const Tiles& tiles, int p, int other) {
  for (int column = 0; column < kFour * tiles.count; ++column)
    std::swap(tiles.column(column)[p], tiles.column(column)[other]);
  for (int j = 0; j < tiles.count; ++j) {
    const char either = tiles.has(p / kFour, j) | tiles.has(other / kFour, j);
    tiles.has(p / kFour, j) = tiles.has(other / kFour, j) = either;
  }
}

/// The four columns of tile k, of which `rows` are the tiles below the diagonal.
bool eliminate_panel(const Tiles& tiles, int k, const int* rows, const int* end, int* pivots) {
  const int first = kFour * k, next = first + kFour;
  for (int p = first; p < next; ++p) {
    double* own = tiles.column(p);
    pivots[p] = find_pivot(own, p, rows, end);
    if (pivots[p] != p) exchange(tiles, p, pivots[p]);
    if (!(std::abs(own[p]) >= std::numeric_limits<double>::min())) return false;
    const double inverse = 1 / own[p];
    for (int row = p + 1; row < next; ++row) own[row] *= inverse;
    for (int column = p + 1; column < next; ++column) {
      double* other = tiles.column(column);
      for (int row = p + 1; row < next; ++row) other[row] -= other[p] * own[row];
    }
    for (const int* tile = rows; tile != end; ++tile) {
      const int row = kFour * *tile;
      Four factor, value;
      load(own + row, factor);
      factor = factor * inverse;
      store(factor, own + row);
      for (int column = p + 1; column < next; ++column) {
        double* other = tiles.column(column);
        load(other + row, value);
        value = value - other[p] * factor;
        store(value, other + row);
      }
    }
  }
  return true;
}

/// Subtracts from `count` columns those of a panel times their factors, in the tiles of `rows`.
template <int count>
void subtract_panel(const double* panel, std::ptrdiff_t stride, const int* rows, const int* end,
                    const double (*factors)[kFour], double* const* columns) {
  Four x[count][kFour];
  for (int c = 0; c < count; ++c)
    for (int p = 0; p < kFour; ++p) x[c][p] = factors[c][p] - Four{};
  for (const int* tile = rows; tile != end; ++tile) {
    const int row = kFour * *tile;
    const Tile from(panel + row, stride);
    for (int c = 0; c < count; ++c) {
      Four value;
      load(columns[c] + row, value);
      value = value - x[c][0] * from.a - x[c][1] * from.b - x[c][2] * from.c - x[c][3] * from.d;
      store(value, columns[c] + row);
    }
  }
}

/// `rows`: room for a quarter of the rows.
bool eliminate(const Tiles& tiles, int* pivots, int* rows) {
  find_tiles(tiles);
  for (int k = 0; k < tiles.count; ++k) {
    int* end = rows;
    for (int i = k + 1; i < tiles.count; ++i)
      if (tiles.has(i, k)) *end++ = i;
    if (!eliminate_panel(tiles, k, rows, end, pivots)) return false;
    const int first = kFour * k;
    const double* panel = tiles.column(first);
    const double *a = panel + first, *b = a + tiles.stride, *c = b + tiles.stride;
    for (int j = k + 1; j < tiles.count; ++j) {
      if (!tiles.has(k, j)) continue;
      double factors[kFour][kFour], *columns[kFour];
      int count = 0;
      for (int column = kFour * j; column < kFour * (j + 1); ++column) {
        double *x = tiles.column(column) + first, *factor = factors[count];
        if (x[0] == 0 && x[1] == 0 && x[2] == 0 && x[3] == 0) continue;
        factor[0] = x[0];
        x[1] = factor[1] = x[1] - factor[0] * a[1];
        x[2] = factor[2] = x[2] - factor[0] * a[2] - factor[1] * b[2];
        x[3] = factor[3] = x[3] - factor[0] * a[3] - factor[1] * b[3] - factor[2] * c[3];
        columns[count++] = tiles.column(column);
      }
      if (count == 0) continue;
      for (const int* tile = rows; tile != end; ++tile) tiles.has(*tile, j) = char(true);
      int done = 0;
      for (; done + 2 <= count; done += 2)
        subtract_panel<2>(panel, tiles.stride, rows, end, factors + done, columns + done);
      if (done < count)
        subtract_panel<1>(panel, tiles.stride, rows, end, factors + done, columns + done);
    }
  }
  return true;
}

/// x = U^-1 L^-1 x
void substitute_tiles(const Tiles& tiles, double* x) {
  for (int k = 0; k < tiles.count; ++k) {
    double* own = x + kFour * k;
    const double* column = tiles.column(kFour * k);
    for (int p = 0; p < kFour; ++p)
      for (int row = p + 1; row < kFour; ++row)
        own[row] -= own[p] * column[p * tiles.stride + kFour * k + row];
    if (std::all_of(own, own + kFour, [](double value) { return value == 0; })) continue;
    for (int i = k + 1; i < tiles.count; ++i)
      if (tiles.has(i, k)) Tile(column + kFour * i, tiles.stride).subtract(own, x + kFour * i);
  }
  for (int k = tiles.count - 1; k >= 0; --k) {
    double* own = x + kFour * k;
    const double* column = tiles.column(kFour * k);
    for (int p = kFour - 1; p >= 0; --p) {
      const double* diagonal = column + p * tiles.stride + kFour * k;
      own[p] /= diagonal[p];
      for (int row = 0; row < p; ++row) own[row] -= own[p] * diagonal[row];
    }
    for (int i = 0; i < k; ++i)
      if (tiles.has(i, k)) Tile(column + kFour * i, tiles.stride).subtract(own, x + kFour * i);
  }
}

}  // namespace

DenseElimination::DenseElimination(int capacity)
    : values_(stride_of(tiles_of(capacity)) * kFour * tiles_of(capacity)),
      pivots_(std::size_t(kFour * tiles_of(capacity))),
      has_tile_(std::size_t(tiles_of(capacity)) * std::size_t(tiles_of(capacity))),
      rows_(std::size_t(tiles_of(capacity))),
      solution_(kFour * tiles_of(capacity)) {}

DenseElimination::Matrix DenseElimination::zeros(int size) {
  const int whole = kFour * tiles_of(size), rest = whole - size;
  size_ = size;
  const std::ptrdiff_t stride = stride_of(tiles_of(size));
  values_.head(stride * whole).setZero();
  using All = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;
  All(values_.data(), whole, whole, Eigen::OuterStride<>(stride)).diagonal().tail(rest).setOnes();
  return All(values_.data(), size, size, Eigen::OuterStride<>(stride));
}

bool DenseElimination::factorise() {
  const int tiles = tiles_of(size_);
  return with_best_instructions([&] {
    return eliminate({values_.data(), stride_of(tiles), tiles, has_tile_.data()}, pivots_.data(),
                     rows_.data());
  });
}

void DenseElimination::substitute(Eigen::VectorXd& right) {
  const int tiles = tiles_of(size_);
  solution_.head(size_) = right.head(size_);
  solution_.segment(size_, kFour * tiles - size_).setZero();
  for (int p = 0; p < size_; ++p) std::swap(solution_[pivots_[std::size_t(p)]], solution_[p]);
  with_best_instructions([&] {
    substitute_tiles({values_.data(), stride_of(tiles), tiles, has_tile_.data()}, solution_.data());
  });
  right.head(size_) = solution_.head(size_);
}

}  // namespace softfinger::internal
