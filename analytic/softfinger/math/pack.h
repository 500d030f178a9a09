#pragma once

#include "softfinger/math/always_inline.h"
#include "softfinger/math/plain_functions.h"

namespace softfinger {
namespace plain::detail {

typedef double PackNumbers __attribute__((vector_size(32)));
typedef std::int64_t PackMask __attribute__((vector_size(32)));
typedef std::uint64_t PackBits __attribute__((vector_size(32)));
template <>
struct BitsOf<PackNumbers> {
  using type = PackBits;
};

}  // namespace plain::detail

/// Four numbers at once. The compiler makes of a pack what the processor has.
struct Pack {
  using Numbers = plain::detail::PackNumbers;
  static constexpr int kSize = 4;

  Numbers numbers{};

  Pack() = default;
  SOFTFINGER_ALWAYS_INLINE Pack(double of_all) noexcept
      : numbers(Numbers{} + of_all) {}  // NOLINT: constants mix with packs
  SOFTFINGER_ALWAYS_INLINE explicit Pack(Numbers given) noexcept : numbers(given) {}

  double operator[](int i) const noexcept { return numbers[i]; }
  void set(int i, double value) noexcept { numbers[i] = value; }
  static Pack from(const double* array) noexcept {
    Pack pack;
    std::memcpy(&pack.numbers, array, sizeof(pack.numbers));
    return pack;
  }
  void write(double* array) const noexcept { std::memcpy(array, &numbers, sizeof(numbers)); }

  SOFTFINGER_ALWAYS_INLINE friend Pack operator+(const Pack& x, const Pack& y) noexcept {
    return Pack(x.numbers + y.numbers);
  }
  SOFTFINGER_ALWAYS_INLINE friend Pack operator-(const Pack& x, const Pack& y) noexcept {
    return Pack(x.numbers - y.numbers);
  }
  SOFTFINGER_ALWAYS_INLINE friend Pack operator*(const Pack& x, const Pack& y) noexcept {
    return Pack(x.numbers * y.numbers);
  }
  SOFTFINGER_ALWAYS_INLINE friend Pack operator/(const Pack& x, const Pack& y) noexcept {
    return Pack(x.numbers / y.numbers);
  }
  Pack& operator+=(const Pack& y) noexcept { return *this = *this + y; }

  /// Result of a comparison, one truth value for each number.
  using Mask = plain::detail::PackMask;
  SOFTFINGER_ALWAYS_INLINE friend Mask operator>=(const Pack& x, const Pack& y) noexcept {
    return x.numbers >= y.numbers;
  }
  SOFTFINGER_ALWAYS_INLINE friend Mask operator<=(const Pack& x, const Pack& y) noexcept {
    return x.numbers <= y.numbers;
  }

  SOFTFINGER_ALWAYS_INLINE friend Pack exp(const Pack& x) noexcept {
    return Pack(plain::detail::exp_of(x.numbers));
  }
  SOFTFINGER_ALWAYS_INLINE friend Pack log(const Pack& x) noexcept {
    return Pack(plain::detail::log_of(x.numbers));
  }
  SOFTFINGER_ALWAYS_INLINE friend Pack sqrt(const Pack& x) noexcept {
    Pack root;
    for (int i = 0; i < kSize; ++i) root.numbers[i] = __builtin_sqrt(x.numbers[i]);
    return root;
  }
  SOFTFINGER_ALWAYS_INLINE friend Pack larger(const Pack& x, double least) noexcept {
    return Pack(x.numbers > least ? x.numbers : Numbers{} + least);
  }
  SOFTFINGER_ALWAYS_INLINE friend Pack smaller(const Pack& x, double most) noexcept {
    return Pack(x.numbers < most ? x.numbers : Numbers{} + most);
  }
};

}  // namespace softfinger
