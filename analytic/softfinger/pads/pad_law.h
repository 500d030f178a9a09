#pragma once

#include <array>
#include <cstddef>

#include "softfinger/input/contact_problem.h"
#include "softfinger/math/dual.h"
#include "softfinger/pads/pad_shape.h"

/// Internal to the pads' models: the pressure of a flat pad, written once for numbers and for
/// numbers with derivatives.
namespace softfinger::pads {

/// Young's modulus, Poisson's ratio and the thickness between two stuck faces: h, or 2 h where one
/// face is frictionless, because its mirror image is the other half of a stuck pad.
template <class T>
struct PadLayer {
  T youngs_modulus_Pa, poisson_ratio, thickness_m;
};

/// Pressure over E d/h, with d/h the strain of a column: of pressing
///   p = 1 + C + G b U + c (psi - mean of psi),   U of source 1,
/// and of tilting by d/h per metre about an axis
///   p = x (1 + C') + G' b V,                      V of source x,
/// where b = 6/((1 + nu) H²), k² = 3 (1 - 2 nu)/(nu² H²) and psi is 1 on the outline and decays
/// inwards over part of the thickness: the rim's peak. C, G and c are fitted (pad_law.cc).
template <class T>
struct PadLaw {
  T excess_uniform, excess_layer;  ///< C and G
  T tilt_uniform, tilt_layer;      ///< C' and G'
  T rim, rim_per_m2;               ///< c and the k² of psi
  /// b/(k² + l) = 6 nu²/((1 + nu) (3 (1 - 2 nu) + nu² H² l)): regular at nu = 0 and 1/2.
  T numerator, compressible, per_stiffness;

  /// int of b U against what the row stands for.
  T layer_sum(const PadShape::Sums& sums, const PadShape::Row& row) const noexcept {
    T sum = 0;
    for (std::size_t i = 0; i < row.size(); ++i)
      sum += row[i] * (numerator / (compressible + per_stiffness * sums.stiffness_per_m2[i]));
    return sum;
  }
  /// int of 1 - psi.
  T rim_sum(const PadShape::Sums& sums, const PadShape::Row& row) const noexcept {
    T sum = 0;
    for (std::size_t i = 0; i < row.size(); ++i)
      sum += row[i] * (rim_per_m2 / (rim_per_m2 + sums.stiffness_per_m2[i]));
    return sum;
  }
};

/// @param is_midplane  pressure of a frictionless face: in the middle of the mirrored pad
template <class T>
PadLaw<T> pad_law(const PadShape& shape, const PadLayer<T>& layer, bool is_midplane) noexcept;

/// Range of size over thickness that the corrections were fitted to; `size_m` is a disc's radius.
constexpr double kLeastWidth = 0.45, kLargestWidth = 16;

/// Eccentricity of the load at which the rim lifts off, over that of columns under the same tilt,
/// which leave where the tilt takes back the approach. Stuck: fitted to 18 rows of finite elements,
/// on 146 others within 10 % (95 %) and 15 %. Frictionless: fitted to 73 rows, on as many others
/// within 0.23 (95 %): rough, because the very corners lift off first, and at least 0.05, because a
/// thin rim near nu = 1/2 lifts off by pressing alone.
/// @param half_extent_m  of the outline along the tilt
double lift_off_factor(double size_m, double half_extent_m, const ElasticLayer& layer,
                       bool is_frictionless) noexcept;

/// The faces keep a twisted pad from warping over this many sizes of its width.
constexpr double kWarping = 1;

/// p = E d/h, with nothing else: `pad_uniform`.
template <class T>
PadLaw<T> uniform_law() noexcept {
  return {0, 0, 0, 0, 0, 1, 0, 1, 0};
}

using PadDual = Dual<3>;  ///< by E, nu, h
extern template PadLaw<double> pad_law(const PadShape&, const PadLayer<double>&, bool) noexcept;
extern template PadLaw<PadDual> pad_law(const PadShape&, const PadLayer<PadDual>&, bool) noexcept;

}  // namespace softfinger::pads
