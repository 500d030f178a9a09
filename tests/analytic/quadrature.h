#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>

/// Brute-force integrals that share nothing with the formulas under test: the trapezoidal rule on
/// the whole real line, which converges exponentially for analytic integrands that decay
/// exponentially on both sides. In long double, so that 1e-16 is not lost to summation.
namespace softfinger::testing {

/// int f(u) du over the real line, `f` negligible outside [lower, upper].
template <class Function>
long double integrate_line(long double lower, long double upper, long double step, Function f) {
  long double sum = 0;
  for (long double u = lower; u < upper; u += step) sum += f(u);
  return sum * step;
}

/// int_0^{pi/2} f(sin t, cos t) dt with tan t = exp(u), -reach < u < reach: resolves both ends of
/// the quadrant, on every scale. The step leaves an error of order exp(-pi²/step) from the poles at
/// u = +- i pi/2, times a power of 2 pi/step for factors sin^k t or cos^k t.
template <class Function>
long double integrate_quadrant(long double step, long double reach, Function f) {
  return integrate_line(-reach, reach, step, [&](long double u) {
    const long double tangent = std::exp(u), cosine = 1 / std::sqrt(1 + tangent * tangent);
    return f(tangent * cosine, cosine) * tangent * cosine * cosine;
  });
}

/// int f(x, y) dA over the ellipse x²/a² + y²/b² <= 1 for f even in x and y.
template <class Function>
long double integrate_ellipse(long double a, long double b, Function f) {
  constexpr long double kStep = 0.2L;    // exp(-pi²/step) = 4e-22
  constexpr long double kReach = 42.0L;  // exp(-reach) = 6e-19
  return 4 * a * b * integrate_quadrant(kStep, kReach / 2, [&](long double s, long double c) {
           return s * c *
                  integrate_quadrant(kStep, kReach, [&](long double sine, long double cosine) {
                    return f(a * s * cosine, b * s * sine);
                  });
         });
}

/// Keeps the largest relative error of a test and prints it at the end (`ctest -V` shows it).
class WorstError {
 public:
  explicit WorstError(const char* what) : what_(what) {}
  ~WorstError() { std::printf("%s: largest relative error %.1e\n", what_, worst_); }

  double of(double value, double reference) {
    const double error = std::abs(value / reference - 1);
    worst_ = std::max(worst_, error);
    return error;
  }

 private:
  const char* what_;
  double worst_ = 0;
};

}  // namespace softfinger::testing
