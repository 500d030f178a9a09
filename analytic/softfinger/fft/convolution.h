#pragma once

#include <Eigen/Core>
#include <memory>

namespace softfinger::fft {

/// Linear (not cyclic) convolution with a kernel that is even in x and in y, on a rectangular grid:
/// the sequences are padded with zeros to twice their length, so that no periodic image is felt.
/// Grids are stored row by row, index = row * columns + column, x along a row.
class Convolution {
 public:
  virtual ~Convolution() = default;
  /// result_i = sum_j kernel(|i - j|) field_j; arrays of rows * columns numbers, which must not
  /// overlap. Not for use by two threads at once.
  virtual void apply(const Eigen::ArrayXd& field, Eigen::ArrayXd& result) = 0;
};

/// Kernel values kernel(row offset, column offset) for offsets 0 .. N, N a power of two; the last
/// row and column, which no pair of cells needs, may hold anything finite.
using KernelQuadrant = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Any field on an N_rows x N_columns grid. About 1.5 ms at 128 x 128 (one core, SSE2).
std::unique_ptr<Convolution> make_convolution(const KernelQuadrant& kernel);

/// Fields that are even in x and in y: only the quarter x > 0, y > 0 is stored, N_rows/2 x
/// N_columns/2, cell (0, 0) touching both axes. Cosine transforms of half the length; about four
/// times as fast.
std::unique_ptr<Convolution> make_even_convolution(const KernelQuadrant& kernel);

}  // namespace softfinger::fft
