#include "softfinger/layer/layer_kernel.h"

#include <cmath>

namespace softfinger {
namespace {

/// Everything is divided by exp(2x), so that nothing overflows.
struct Terms {
  double kappa, decay, denominator;

  Terms(double compressibility, double x)
      : kappa(1 + 2 * compressibility),
        decay(std::exp(-2 * x)),
        denominator(kappa * (1 + decay * decay) + decay * (4 * x * x + 1 + kappa * kappa)) {}
};

/// (sinh y - y) without its cancellation, 0 <= y <= 2: nine terms leave 2^18/20! < 1e-13 of y³/6.
double sinh_minus_argument(double y) {
  const double y2 = y * y;
  double sum = 1;
  for (int n = 10; n >= 2; --n) sum = 1 + sum * y2 / ((2 * n) * (2 * n + 1));
  return sum * y * y2 / 6;
}

}  // namespace

double LayerKernel::compliance(double x) const noexcept {
  const Terms terms(compressibility_, x);
  // kappa sinh 2x - 2x = (kappa - 1) sinh 2x + (sinh 2x - 2x): two positive terms.
  const double half_sinh = -0.5 * std::expm1(-4 * x);  // sinh(2x) exp(-2x)
  const double excess =
      x < 1 ? sinh_minus_argument(2 * x) * terms.decay : half_sinh - 2 * x * terms.decay;
  return 2 * (2 * compressibility_ * half_sinh + excess) / terms.denominator;
}

double LayerKernel::stiffening(double x) const noexcept {
  const Terms terms(compressibility_, x);
  const double kappa = terms.kappa;
  return terms.decay * (2 * kappa * terms.decay + 4 * x * (x + 1) + 1 + kappa * kappa) /
         terms.denominator;
}

double LayerKernel::tangential_stiffening(double x) const noexcept {
  const Terms terms(compressibility_, x);
  const double kappa = terms.kappa, root = 2 * x - 1;
  return terms.decay * (2 * kappa * terms.decay + root * root + kappa * kappa) / terms.denominator;
}

double LayerKernel::antiplane_stiffening(double x) noexcept {
  const double decay = std::exp(-2 * x);
  return 2 * decay / (1 + decay);
}

}  // namespace softfinger
