#pragma once

#include <cstdint>
#include <cstring>

#include "softfinger/math/always_inline.h"

/// exp, log and sqrt in plain arithmetic, for one double or (pack.h) four: a contact gets the same
/// bits alone and among others, on every machine. Both functions are within 2 ulp.
///
/// Functions that take or return four doubles as a vector are always inlined: in which registers
/// such a vector is passed depends on the instructions that caller and function are each compiled
/// for (wide.h).
namespace softfinger::plain {
namespace detail {

template <class Real>
struct BitsOf;
template <>
struct BitsOf<double> {
  using type = std::uint64_t;  // unsigned: what is no number may be shifted, too
};
template <class Real>
using Bits = typename BitsOf<Real>::type;

template <class To, class From>
SOFTFINGER_ALWAYS_INLINE inline To reinterpret(From from) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  To to;
  std::memcpy(&to, &from, sizeof(to));
  return to;
}

/// 2^k of a whole number k that was rounded by adding `kRounder`.
constexpr double kRounder = 0x1.8p52;
template <class Real>
SOFTFINGER_ALWAYS_INLINE inline Real power_of_two(Real k_plus_rounder) noexcept {
  constexpr std::uint64_t kBias = 1023;
  const Bits<Real> k =
      reinterpret<Bits<Real>>(k_plus_rounder) - reinterpret<Bits<Real>>(Real{} + kRounder);
  return reinterpret<Real>((k + kBias) << 52);
}

/// exp(k ln 2 + r), |r| <= ln(2)/2, by Taylor's series.
template <class Real>
SOFTFINGER_ALWAYS_INLINE inline Real exp_of(Real x) noexcept {
  constexpr double kLog2High = 0x1.62e42feep-1, kLog2Low = 0x1.a39ef35793c76p-33;
  // Beyond, the answer is infinite or zero anyway.
  x = x < -800. ? Real{} - 800. : x;
  x = x > 800. ? Real{} + 800. : x;
  const Real k = (x * 1.4426950408889634 + kRounder) - kRounder;
  const Real r = (x - k * kLog2High) - k * kLog2Low;
  // Terms in pairs and pairs of pairs, which a processor adds side by side.
  const Real r2 = r * r, r4 = r2 * r2;
  const Real second = (1. / 2 + r * (1. / 6)) + r2 * (1. / 24 + r * (1. / 120));
  const Real sixth = (1. / 720 + r * (1. / 5040)) + r2 * (1. / 40320 + r * (1. / 362880));
  const Real tenth =
      (1. / 3628800 + r * (1. / 39916800)) + r2 * (1. / 479001600 + r * (1. / 6227020800));
  const Real sum = 1 + (r + r2 * (second + r4 * (sixth + r4 * tenth)));
  // In two steps, because 2^k alone may not be a double where the result is.
  const Real half = k * 0.5 + kRounder;
  return sum * power_of_two(half) * power_of_two((k - (half - kRounder)) + kRounder);
}

/// ln(2^k m) = k ln 2 + 2 artanh((m - 1)/(m + 1)), m about 1.
template <class Real>
SOFTFINGER_ALWAYS_INLINE inline Real log_of(Real x) noexcept {
  constexpr double kLog2High = 0x1.62e42feep-1, kLog2Low = 0x1.a39ef35793c76p-33;
  constexpr std::uint64_t kOne = 0x3ff0000000000000, kRootOfHalf = 0x3fe6a09e667f3bcd;
  constexpr std::uint64_t kTwoTo52 = 0x4330000000000000;
  const Real scaled = x < 0x1p-1022 ? x * 0x1p54 : x;
  const Real offset = x < 0x1p-1022 ? Real{} + 54. : Real{};
  const Bits<Real> bits = reinterpret<Bits<Real>>(scaled);
  const Bits<Real> biased = (bits + (kOne - kRootOfHalf)) >> 52;
  const Real k = (reinterpret<Real>(biased + kTwoTo52) - (0x1p52 + 1023)) - offset;
  const Real m = reinterpret<Real>(bits - (biased << 52) + kOne);
  const Real f = m - 1, t = f / (m + 1), z = t * t;
  const Real z2 = z * z, z4 = z2 * z2;
  const Real sum = ((1. / 3 + z * (1. / 5)) + z2 * (1. / 7 + z * (1. / 9))) +
                   z4 * (((1. / 11 + z * (1. / 13)) + z2 * (1. / 15 + z * (1. / 17))) +
                         z4 * (1. / 19 + z * (1. / 21)));
  // f - f² / (m + 1) = 2 t without the rounding of t
  const Real small = f - t * (f - 2 * z * sum);
  const Real log = k * kLog2High + (k * kLog2Low + small);
  constexpr double kInfinity = __builtin_inf();
  return x > 0. ? (x < kInfinity ? log : x) : Real{} - kInfinity;
}

}  // namespace detail

inline double exp(double x) noexcept { return detail::exp_of(x); }

/// @param x  positive, zero or infinite
inline double log(double x) noexcept { return detail::log_of(x); }

inline double sqrt(double x) noexcept { return __builtin_sqrt(x); }

inline double larger(double x, double least) noexcept { return x > least ? x : least; }
inline double smaller(double x, double most) noexcept { return x < most ? x : most; }

}  // namespace softfinger::plain
