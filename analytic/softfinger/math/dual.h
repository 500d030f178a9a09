#pragma once

#include <array>

#include "softfinger/math/plain_functions.h"

namespace softfinger {

/// A number and its derivatives with respect to `N` others: what is computed with it carries exact
/// derivatives along (forward differentiation).
template <int N>
struct Dual {
  double value = 0;
  std::array<double, N> slope{};

  Dual() = default;
  Dual(double constant) noexcept : value(constant) {}  // NOLINT: constants mix with variables
  /// The variable number `index`.
  static Dual variable(double value, int index) noexcept {
    Dual result(value);
    result.slope[std::size_t(index)] = 1;
    return result;
  }
  /// A function of `of` with this value and this derivative.
  static Dual chain(const Dual& of, double value, double derivative) noexcept {
    Dual result(value);
    for (int i = 0; i < N; ++i) result.slope[i] = derivative * of.slope[i];
    return result;
  }

  friend Dual operator+(const Dual& x, const Dual& y) noexcept {
    Dual result(x.value + y.value);
    for (int i = 0; i < N; ++i) result.slope[i] = x.slope[i] + y.slope[i];
    return result;
  }
  friend Dual operator-(const Dual& x, const Dual& y) noexcept {
    Dual result(x.value - y.value);
    for (int i = 0; i < N; ++i) result.slope[i] = x.slope[i] - y.slope[i];
    return result;
  }
  friend Dual operator*(const Dual& x, const Dual& y) noexcept {
    Dual result(x.value * y.value);
    for (int i = 0; i < N; ++i) result.slope[i] = x.slope[i] * y.value + x.value * y.slope[i];
    return result;
  }
  friend Dual operator/(const Dual& x, const Dual& y) noexcept {
    const double inverse = 1 / y.value;
    Dual result(x.value / y.value);
    for (int i = 0; i < N; ++i)
      result.slope[i] = inverse * (x.slope[i] - result.value * y.slope[i]);
    return result;
  }
  // Operations with constants, which have no derivatives.
  friend Dual operator+(const Dual& x, double y) noexcept { return chain(x, x.value + y, 1); }
  friend Dual operator+(double x, const Dual& y) noexcept { return chain(y, x + y.value, 1); }
  friend Dual operator-(const Dual& x, double y) noexcept { return chain(x, x.value - y, 1); }
  friend Dual operator-(double x, const Dual& y) noexcept { return chain(y, x - y.value, -1); }
  friend Dual operator*(const Dual& x, double y) noexcept { return chain(x, x.value * y, y); }
  friend Dual operator*(double x, const Dual& y) noexcept { return chain(y, x * y.value, x); }
  friend Dual operator/(const Dual& x, double y) noexcept { return chain(x, x.value / y, 1 / y); }
  friend Dual operator/(double x, const Dual& y) noexcept {
    const double ratio = x / y.value;
    return chain(y, ratio, -ratio / y.value);
  }
  friend Dual operator-(const Dual& x) noexcept { return chain(x, -x.value, -1); }
  Dual& operator+=(const Dual& y) noexcept { return *this = *this + y; }
  Dual& operator*=(const Dual& y) noexcept { return *this = *this * y; }

  friend bool operator<(const Dual& x, const Dual& y) noexcept { return x.value < y.value; }
  friend bool operator>(const Dual& x, const Dual& y) noexcept { return x.value > y.value; }

  friend Dual exp(const Dual& x) noexcept {
    const double power = plain::exp(x.value);
    return chain(x, power, power);
  }
  friend Dual log(const Dual& x) noexcept { return chain(x, plain::log(x.value), 1 / x.value); }
  friend Dual sqrt(const Dual& x) noexcept {
    const double root = plain::sqrt(x.value);
    return chain(x, root, 0.5 / root);
  }
  friend Dual larger(const Dual& x, double least) noexcept {
    return x.value > least ? x : Dual(least);
  }
  friend Dual smaller(const Dual& x, double most) noexcept {
    return x.value < most ? x : Dual(most);
  }
};

}  // namespace softfinger
