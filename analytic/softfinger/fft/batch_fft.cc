#include "softfinger/fft/batch_fft.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "softfinger/input/constants.h"

namespace softfinger::fft {
namespace {

/// One radix-4 step: `count` butterflies on runs of `run` neighbouring numbers; the twiddle factors
/// are every `stride`-th root of unity.
void radix4(int count, std::ptrdiff_t run, int stride, const double* cosine, const double* sine,
            const double* xr, const double* xi, double* yr, double* yi) {
  const std::ptrdiff_t quarter = count * run;
  for (int p = 0; p < count; ++p) {
    const double c1 = cosine[p * stride], s1 = -sine[p * stride];
    const double c2 = c1 * c1 - s1 * s1, s2 = 2 * c1 * s1;
    const double c3 = c1 * c2 - s1 * s2, s3 = c1 * s2 + s1 * c2;
    const double* __restrict ar = xr + p * run;
    const double* __restrict ai = xi + p * run;
    double* __restrict br = yr + 4 * p * run;
    double* __restrict bi = yi + 4 * p * run;
    for (std::ptrdiff_t q = 0; q < run; ++q) {
      const double sum02r = ar[q] + ar[q + 2 * quarter], sum02i = ai[q] + ai[q + 2 * quarter];
      const double dif02r = ar[q] - ar[q + 2 * quarter], dif02i = ai[q] - ai[q + 2 * quarter];
      const double sum13r = ar[q + quarter] + ar[q + 3 * quarter];
      const double sum13i = ai[q + quarter] + ai[q + 3 * quarter];
      const double dif13r = ar[q + quarter] - ar[q + 3 * quarter];
      const double dif13i = ai[q + quarter] - ai[q + 3 * quarter];
      br[q] = sum02r + sum13r;
      bi[q] = sum02i + sum13i;
      const double r1 = dif02r + dif13i, i1 = dif02i - dif13r;
      br[q + run] = c1 * r1 - s1 * i1;
      bi[q + run] = c1 * i1 + s1 * r1;
      const double r2 = sum02r - sum13r, i2 = sum02i - sum13i;
      br[q + 2 * run] = c2 * r2 - s2 * i2;
      bi[q + 2 * run] = c2 * i2 + s2 * r2;
      const double r3 = dif02r - dif13i, i3 = dif02i + dif13r;
      br[q + 3 * run] = c3 * r3 - s3 * i3;
      bi[q + 3 * run] = c3 * i3 + s3 * r3;
    }
  }
}

void radix2(std::ptrdiff_t run, const double* __restrict x, double* __restrict y) {
  for (std::ptrdiff_t q = 0; q < run; ++q) {
    y[q] = x[q] + x[q + run];
    y[q + run] = x[q] - x[q + run];
  }
}

}  // namespace

BatchFft::BatchFft(int length, int batch)
    : length_(length),
      batch_(batch),
      scratch_real_(static_cast<std::size_t>(length) * static_cast<std::size_t>(batch)),
      scratch_imaginary_(scratch_real_.size()) {
  for (int p = 0; p < length; ++p) {
    cosine_.push_back(std::cos(2 * kPi * p / length));
    sine_.push_back(std::sin(2 * kPi * p / length));
  }
}

void BatchFft::forward(double* real, double* imaginary) {
  double *xr = real, *xi = imaginary, *yr = scratch_real_.data(), *yi = scratch_imaginary_.data();
  std::ptrdiff_t run = batch_;
  int n = length_;
  for (; n >= 4; n /= 4, run *= 4) {
    radix4(n / 4, run, length_ / n, cosine_.data(), sine_.data(), xr, xi, yr, yi);
    std::swap(xr, yr);
    std::swap(xi, yi);
  }
  if (n == 2) {
    radix2(run, xr, yr);
    radix2(run, xi, yi);
    std::swap(xr, yr);
    std::swap(xi, yi);
  }
  if (xr != real) {
    std::copy_n(xr, scratch_real_.size(), real);
    std::copy_n(xi, scratch_real_.size(), imaginary);
  }
}

}  // namespace softfinger::fft
