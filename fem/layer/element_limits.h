#pragma once

#include <algorithm>

namespace softfinger::fem {

/// The largest Poisson's ratio that the elements take. Both of them (element_stiffness.h,
/// finite/element.h) eliminate the pressure per element, which needs a finite bulk modulus. Solving
/// nu = 1/2 at this value changes the approach by a share of the order of 1e-8 ab/h² (measured:
/// 2e-5 at a/h = 20).
constexpr double largest_poisson_ratio = 0.5 - 1e-8;

inline double compressible(double poisson_ratio) {
  return std::min(poisson_ratio, largest_poisson_ratio);
}

/// The largest one where friction is solved at finite strain: with 0.49999 Newton's
/// method failed from d/h = 0.1 on, with this value it serves to d/h = 0.34 and beyond. What that
/// changes is stated (`error_of_compressing`).
constexpr double largest_rubbed_poisson_ratio = 0.4999;

}  // namespace softfinger::fem
