#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "softfinger/input/constants.h"

namespace softfinger {

/// Several smooth functions on [0, `kPieces` `kLength`], as polynomials through the Chebyshev
/// points of equal pieces: one contiguous block of coefficients.
template <int kFunctions, int kPieces, int kDegree>
class PiecewisePolynomial {
  static_assert(kDegree % 2 == 0 && kDegree > 0);

 public:
  using Values = std::array<double, kFunctions>;
  static constexpr double kLength = 0.25;
  static constexpr double kEnd = kPieces * kLength;

  /// @param function  of one number; returns Values
  template <class Function>
  explicit PiecewisePolynomial(const Function& function) {
    for (int piece = 0; piece < kPieces; ++piece) fit(piece, function);
  }

  /// @param x  0 to kEnd
  Values value(double x) const noexcept {
    double t;
    const Values* term = place(x, &t);
    // Even and odd powers by themselves, which a processor adds side by side.
    const double t2 = t * t;
    Values even = term[kDegree], odd = term[kDegree - 1];
    for (int k = kDegree - 2; k >= 0; k -= 2)
      for (int f = 0; f < kFunctions; ++f) {
        even[f] = even[f] * t2 + term[k][f];
        if (k > 0) odd[f] = odd[f] * t2 + term[k - 1][f];
      }
    for (int f = 0; f < kFunctions; ++f) even[f] += t * odd[f];
    return even;
  }

  /// Rows [piece][power of the place in the piece, which goes from -1 to 1].
  const Values* terms() const noexcept { return terms_.data(); }

  /// Evaluates the functions at x and, in `*slope`, their derivatives.
  Values value(double x, Values* slope) const noexcept {
    double t;
    const Values* term = place(x, &t);
    const double t2 = t * t;
    Values even = term[kDegree], odd = term[kDegree - 1];
    Values even_slope{}, odd_slope{};  // with respect to t²
    for (int k = kDegree - 2; k >= 0; k -= 2)
      for (int f = 0; f < kFunctions; ++f) {
        even_slope[f] = even_slope[f] * t2 + even[f];
        even[f] = even[f] * t2 + term[k][f];
        if (k == 0) continue;
        odd_slope[f] = odd_slope[f] * t2 + odd[f];
        odd[f] = odd[f] * t2 + term[k - 1][f];
      }
    for (int f = 0; f < kFunctions; ++f) {
      (*slope)[f] = (2 / kLength) * (2 * t * (even_slope[f] + t * odd_slope[f]) + odd[f]);
      even[f] += t * odd[f];
    }
    return even;
  }

 private:
  /// The polynomial's terms, and the place in its piece, -1 to 1.
  const Values* place(double x, double* t) const noexcept {
    const double pieces = x * (1 / kLength);
    // Written so that a value that is not a number gives the first piece.
    const int piece = pieces > 0 ? int(pieces < kPieces - 1 ? pieces : kPieces - 1) : 0;
    *t = 2 * (pieces - piece) - 1;
    return terms_.data() + piece * (kDegree + 1);
  }

  template <class Function>
  void fit(int piece, const Function& function) {
    constexpr int kTerms = kDegree + 1;
    // Chebyshev coefficients of each function, then powers by T_k = 2 t T_(k-1) - T_(k-2).
    std::array<Values, kTerms> chebyshev{};
    for (int i = 0; i < kTerms; ++i) {
      const double angle = kPi * (i + 0.5) / kTerms;
      const Values value = function(kLength * (piece + 0.5 + 0.5 * std::cos(angle)));
      for (int k = 0; k < kTerms; ++k)
        for (int f = 0; f < kFunctions; ++f)
          chebyshev[k][f] += value[f] * std::cos(k * angle) * (k == 0 ? 1. : 2.) / kTerms;
    }
    std::array<double, kTerms> before{}, polynomial = {1};
    Values* term = terms_.data() + piece * kTerms;
    for (int k = 0; k < kTerms; ++k) {
      for (int power = 0; power < kTerms; ++power)
        for (int f = 0; f < kFunctions; ++f) term[power][f] += chebyshev[k][f] * polynomial[power];
      std::array<double, kTerms> next{};
      for (int power = 0; power < kTerms; ++power) {
        if (power + 1 < kTerms) next[power + 1] += (k == 0 ? 1 : 2) * polynomial[power];
        next[power] -= before[power];
      }
      before = polynomial;
      polynomial = next;
    }
  }

  std::array<Values, std::size_t(kPieces*(kDegree + 1))> terms_{};
};

}  // namespace softfinger
