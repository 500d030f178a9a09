#include "softfinger/fft/convolution.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "softfinger/fft/batch_fft.h"
#include "softfinger/input/constants.h"

namespace softfinger::fft {
namespace {

std::size_t size_of(int rows, int columns) {
  return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
}

/// Cosine sums sum_j' w_j x_j cos(pi j k / N), w = 1 at both ends and 2 between, of the columns of
/// `values`: the transform of the even sequence of period 2 N. Two columns share a complex
/// transform, whose real and imaginary parts are both real sequences' transforms.
KernelQuadrant transform_columns(const KernelQuadrant& values) {
  const int n = static_cast<int>(values.rows()) - 1, columns = static_cast<int>(values.cols());
  const int half = (columns + 1) / 2;
  BatchFft transform(2 * n, half);
  std::vector<double> real(size_of(2 * n, half)), imaginary(real.size());
  for (int j = 0; j < 2 * n; ++j) {
    const int row = std::min(j, 2 * n - j);
    for (int k = 0; k < half; ++k) {
      real[size_of(j, half) + static_cast<std::size_t>(k)] = values(row, k);
      if (half + k < columns)
        imaginary[size_of(j, half) + static_cast<std::size_t>(k)] = values(row, half + k);
    }
  }
  transform.forward(real.data(), imaginary.data());
  KernelQuadrant result(n + 1, columns);
  for (int j = 0; j <= n; ++j)
    for (int k = 0; k < half; ++k) {
      result(j, k) = real[size_of(j, half) + static_cast<std::size_t>(k)];
      if (half + k < columns)
        result(j, half + k) = imaginary[size_of(j, half) + static_cast<std::size_t>(k)];
    }
  return result;
}

KernelQuadrant symbol_of(const KernelQuadrant& kernel) {
  const KernelQuadrant along_y = transform_columns(kernel);
  return transform_columns(along_y.transpose()).transpose();
}

class GeneralConvolution final : public Convolution {
 public:
  explicit GeneralConvolution(const KernelQuadrant& kernel)
      : rows_(static_cast<int>(kernel.rows()) - 1),
        columns_(static_cast<int>(kernel.cols()) - 1),
        symbol_(symbol_of(kernel) / (4.0 * rows_ * columns_)),
        along_x_(2 * columns_, rows_ / 2),
        along_y_(2 * rows_, columns_ + 1),
        x_real_(size_of(2 * columns_, rows_ / 2)),
        x_imaginary_(x_real_.size()),
        y_real_(size_of(2 * rows_, columns_ + 1)),
        y_imaginary_(y_real_.size()) {}

  void apply(const Eigen::ArrayXd& field, Eigen::ArrayXd& result) override {
    const int pairs = rows_ / 2, width = columns_ + 1;
    // Rows i and i + pairs are the real and the imaginary part of one complex sequence.
    for (int x = 0; x < columns_; ++x)
      for (int i = 0; i < pairs; ++i) {
        x_real_[size_of(x, pairs) + static_cast<std::size_t>(i)] = field[i * columns_ + x];
        x_imaginary_[size_of(x, pairs) + static_cast<std::size_t>(i)] =
            field[(i + pairs) * columns_ + x];
      }
    const auto padding = static_cast<std::ptrdiff_t>(size_of(columns_, pairs));
    std::fill(x_real_.begin() + padding, x_real_.end(), 0.0);
    std::fill(x_imaginary_.begin() + padding, x_imaginary_.end(), 0.0);
    along_x_.forward(x_real_.data(), x_imaginary_.data());
    for (int k = 0; k < width; ++k) {
      const int mirror = (2 * columns_ - k) % (2 * columns_);
      const double* r1 = &x_real_[size_of(k, pairs)];
      const double* i1 = &x_imaginary_[size_of(k, pairs)];
      const double* r2 = &x_real_[size_of(mirror, pairs)];
      const double* i2 = &x_imaginary_[size_of(mirror, pairs)];
      for (int i = 0; i < pairs; ++i) {
        const std::size_t upper = size_of(i, width) + static_cast<std::size_t>(k);
        const std::size_t lower = size_of(i + pairs, width) + static_cast<std::size_t>(k);
        y_real_[upper] = 0.5 * (r1[i] + r2[i]);
        y_imaginary_[upper] = 0.5 * (i1[i] - i2[i]);
        y_real_[lower] = 0.5 * (i1[i] + i2[i]);
        y_imaginary_[lower] = 0.5 * (r2[i] - r1[i]);
      }
    }
    std::fill(y_real_.begin() + static_cast<std::ptrdiff_t>(size_of(rows_, width)), y_real_.end(),
              0.0);
    std::fill(y_imaginary_.begin() + static_cast<std::ptrdiff_t>(size_of(rows_, width)),
              y_imaginary_.end(), 0.0);
    along_y_.forward(y_real_.data(), y_imaginary_.data());
    for (int j = 0; j < 2 * rows_; ++j) {
      const double* symbol = &symbol_(std::min(j, 2 * rows_ - j), 0);
      double* real = &y_real_[size_of(j, width)];
      double* imaginary = &y_imaginary_[size_of(j, width)];
      for (int k = 0; k < width; ++k) {
        real[k] *= symbol[k];
        imaginary[k] *= symbol[k];
      }
    }
    along_y_.inverse(y_real_.data(), y_imaginary_.data());
    for (int k = 0; k < width; ++k) {
      const int mirror = (2 * columns_ - k) % (2 * columns_);
      double* r1 = &x_real_[size_of(k, pairs)];
      double* i1 = &x_imaginary_[size_of(k, pairs)];
      double* r2 = &x_real_[size_of(mirror, pairs)];
      double* i2 = &x_imaginary_[size_of(mirror, pairs)];
      for (int i = 0; i < pairs; ++i) {
        const std::size_t upper = size_of(i, width) + static_cast<std::size_t>(k);
        const std::size_t lower = size_of(i + pairs, width) + static_cast<std::size_t>(k);
        r2[i] = y_real_[upper] + y_imaginary_[lower];
        i2[i] = y_real_[lower] - y_imaginary_[upper];
        r1[i] = y_real_[upper] - y_imaginary_[lower];
        i1[i] = y_real_[lower] + y_imaginary_[upper];
      }
    }
    along_x_.inverse(x_real_.data(), x_imaginary_.data());
    result.resize(rows_ * columns_);
    for (int x = 0; x < columns_; ++x)
      for (int i = 0; i < pairs; ++i) {
        result[i * columns_ + x] = x_real_[size_of(x, pairs) + static_cast<std::size_t>(i)];
        result[(i + pairs) * columns_ + x] =
            x_imaginary_[size_of(x, pairs) + static_cast<std::size_t>(i)];
      }
  }

 private:
  int rows_, columns_;
  KernelQuadrant symbol_;
  BatchFft along_x_, along_y_;
  std::vector<double> x_real_, x_imaginary_, y_real_, y_imaginary_;
};

/// The cosine transform X_k = sum_j x_j cos(pi k (j + 1/2) / m), j, k = 0 .. m - 1, by one complex
/// transform of length m (Makhoul 1980): with v = (x_0, x_2, .. x_3, x_1) and V its transform,
/// exp(-i pi k/2m) V_k = X_k - i X_(m-k). Two real sequences share a complex one.
class CosineTransform {
 public:
  CosineTransform(int length, int pairs)
      : m_(length), pairs_(pairs), transform_(length, pairs), real_(size_of(length, pairs)) {
    imaginary_.resize(real_.size());
    for (int k = 0; k <= m_ / 2; ++k) {
      cosine_.push_back(std::cos(kPi * k / (2.0 * m_)));
      sine_.push_back(std::sin(kPi * k / (2.0 * m_)));
    }
  }

  int place(int j) const { return j % 2 == 0 ? j / 2 : m_ - 1 - j / 2; }
  /// Row of sample j: first the real parts, one per pair.
  double* real_row(int j) { return &real_[size_of(place(j), pairs_)]; }
  double* imaginary_row(int j) { return &imaginary_[size_of(place(j), pairs_)]; }
  void clear() {
    std::fill(real_.begin(), real_.end(), 0.0);
    std::fill(imaginary_.begin(), imaginary_.end(), 0.0);
  }
  void transform() { transform_.forward(real_.data(), imaginary_.data()); }
  void inverse() { transform_.inverse(real_.data(), imaginary_.data()); }

  /// Calls visit(k, mirror, pair, X_k, X_mirror, Y_k, Y_mirror) for the coefficients of both
  /// sequences of each pair, which may be changed; mirror = m - k. For k = 0 the mirrored ones are
  /// zero and ignored.
  template <class Visitor>
  void for_each_coefficient(Visitor visit, bool write) {
    for (int k = 0; k <= m_ / 2; ++k) {
      const int mirror = (m_ - k) % m_;
      const double c = cosine_[static_cast<std::size_t>(k)], s = sine_[static_cast<std::size_t>(k)];
      double* r1 = &real_[size_of(k, pairs_)];
      double* i1 = &imaginary_[size_of(k, pairs_)];
      double* r2 = &real_[size_of(mirror, pairs_)];
      double* i2 = &imaginary_[size_of(mirror, pairs_)];
      for (int i = 0; i < pairs_; ++i) {
        const double vr = 0.5 * (r1[i] + r2[i]), vi = 0.5 * (i1[i] - i2[i]);
        const double wr = 0.5 * (i1[i] + i2[i]), wi = 0.5 * (r2[i] - r1[i]);
        double X = c * vr + s * vi, X_mirror = s * vr - c * vi;
        double Y = c * wr + s * wi, Y_mirror = s * wr - c * wi;
        visit(k, mirror, i, X, X_mirror, Y, Y_mirror);
        if (!write) continue;
        // V_k = exp(i pi k/2m) (X_k - i X_mirror), the transform at the mirror is its conjugate.
        const double nr = c * X + s * X_mirror, ni = s * X - c * X_mirror;
        const double or_ = c * Y + s * Y_mirror, oi = s * Y - c * Y_mirror;
        r2[i] = nr + oi;
        i2[i] = or_ - ni;
        r1[i] = nr - oi;
        i1[i] = or_ + ni;
      }
    }
  }

 private:
  int m_, pairs_;
  BatchFft transform_;
  std::vector<double> real_, imaginary_, cosine_, sine_;
};

class EvenConvolution final : public Convolution {
 public:
  explicit EvenConvolution(const KernelQuadrant& kernel)
      : rows_(static_cast<int>(kernel.rows() - 1) / 2),
        columns_(static_cast<int>(kernel.cols() - 1) / 2),
        symbol_(symbol_of(kernel) / (4.0 * rows_ * columns_)),
        along_x_(2 * columns_, rows_ / 2),
        along_y_(2 * rows_, columns_) {
    spectrum_.resize(size_of(rows_, 2 * columns_));
  }

  void apply(const Eigen::ArrayXd& field, Eigen::ArrayXd& result) override {
    const int pairs = rows_ / 2, width = 2 * columns_;
    along_x_.clear();
    for (int x = 0; x < columns_; ++x) {
      double* real = along_x_.real_row(x);
      double* imaginary = along_x_.imaginary_row(x);
      for (int i = 0; i < pairs; ++i) {
        real[i] = field[i * columns_ + x];
        imaginary[i] = field[(i + pairs) * columns_ + x];
      }
    }
    along_x_.transform();
    along_x_.for_each_coefficient(
        [&](int k, int mirror, int i, double X, double X_mirror, double Y, double Y_mirror) {
          double* upper = &spectrum_[size_of(i, width)];
          double* lower = &spectrum_[size_of(i + pairs, width)];
          if (mirror > 0) {
            upper[mirror] = X_mirror;
            lower[mirror] = Y_mirror;
          }
          upper[k] = X;
          lower[k] = Y;
        },
        false);
    along_y_.clear();
    for (int i = 0; i < rows_; ++i) {
      std::copy_n(&spectrum_[size_of(i, width)], columns_, along_y_.real_row(i));
      std::copy_n(&spectrum_[size_of(i, width)] + columns_, columns_, along_y_.imaginary_row(i));
    }
    along_y_.transform();
    along_y_.for_each_coefficient(
        [&](int k, int mirror, int i, double& X, double& X_mirror, double& Y, double& Y_mirror) {
          X *= symbol_(k, i);
          Y *= symbol_(k, i + columns_);
          X_mirror = mirror > 0 ? X_mirror * symbol_(mirror, i) : 0;
          Y_mirror = mirror > 0 ? Y_mirror * symbol_(mirror, i + columns_) : 0;
        },
        true);
    along_y_.inverse();
    for (int i = 0; i < rows_; ++i) {
      std::copy_n(along_y_.real_row(i), columns_, &spectrum_[size_of(i, width)]);
      std::copy_n(along_y_.imaginary_row(i), columns_, &spectrum_[size_of(i, width)] + columns_);
    }
    along_x_.for_each_coefficient(
        [&](int k, int mirror, int i, double& X, double& X_mirror, double& Y, double& Y_mirror) {
          const double* upper = &spectrum_[size_of(i, width)];
          const double* lower = &spectrum_[size_of(i + pairs, width)];
          X = upper[k];
          Y = lower[k];
          X_mirror = mirror > 0 ? upper[mirror] : 0;
          Y_mirror = mirror > 0 ? lower[mirror] : 0;
        },
        true);
    along_x_.inverse();
    result.resize(rows_ * columns_);
    for (int x = 0; x < columns_; ++x) {
      const double* real = along_x_.real_row(x);
      const double* imaginary = along_x_.imaginary_row(x);
      for (int i = 0; i < pairs; ++i) {
        result[i * columns_ + x] = real[i];
        result[(i + pairs) * columns_ + x] = imaginary[i];
      }
    }
  }

 private:
  int rows_, columns_;  // of the quarter
  KernelQuadrant symbol_;
  CosineTransform along_x_, along_y_;
  std::vector<double> spectrum_;
};

}  // namespace

std::unique_ptr<Convolution> make_convolution(const KernelQuadrant& kernel) {
  return std::make_unique<GeneralConvolution>(kernel);
}

std::unique_ptr<Convolution> make_even_convolution(const KernelQuadrant& kernel) {
  return std::make_unique<EvenConvolution>(kernel);
}

}  // namespace softfinger::fft
