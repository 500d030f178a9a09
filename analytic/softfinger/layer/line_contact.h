#pragma once

#include <Eigen/Core>

#include "softfinger/layer/layer_kernel.h"

namespace softfinger {

/// Contact of a rigid parabolic cylinder, gap x²/(2R), with a bonded layer in plane strain. Loads
/// are per length of the line.
struct LineContact {
  double half_width_m = 0;             ///< b
  double load_over_modulus_m = 0;      ///< P'/E*
  double indentation_m = 0;            ///< against the rigid base
  double peak_over_modulus = 0;        ///< p(0)/E*
  double mean_square_over_square = 0;  ///< int x² p dx/(P' b²): 1/4 (Hertz), 1/5, 1/7

  /// p/E* at the distance x from the middle, zero outside.
  double pressure_over_modulus(double x_m) const noexcept;

  /// p/E* = sqrt(1 - x²/b²) sum c_n U_2n(x/b).
  Eigen::VectorXd pressure_coefficients;
};

/// Exact solution for a given half-width, by Galerkin's method. A term of the pressure,
/// sqrt(1 - x²/b²) U_2n(x/b), has the transform (-1)^n pi (2n+1) J_(2n+1)(kb)/k and presses a
/// half-space into the slope T_(2n+1). With the layer's kernel w(kh) (layer_kernel.h) the slope
/// x/R of the cylinder gives
///   c_m - 2 sum_n (-1)^(m+n) (2n+1) c_n int_0^inf (1 - w(t)) J_(2n+1)(bt/h) J_(2m+1)(bt/h)/t dt
///     = (b/2R) [m = 0],
///   P' = (pi/2) b c_0 E*.
/// A thick layer gives Hertz's line, b² = 4 P' R/(pi E*) (K. L. Johnson, Contact Mechanics, section
/// 4.2). Relative error below 1e-8 for b/h to 50 (tested by doubling the terms). Cost: 0.2 ms
/// (b/h = 1) to 0.1 s (b/h = 50). Allocates.
///
/// @param half_width_m  > 0, at most 80 thicknesses
/// @param terms         of the pressure; 0: as many as the layer needs
LineContact line_contact(double half_width_m, double radius_m, double thickness_m,
                         const LayerKernel& kernel, int terms = 0);

/// Solves for the half-width at a given P'/E*, met to a relative 1e-12; half_width_m = 0 where it
/// would exceed 80 thicknesses.
LineContact line_contact_at_load(double load_over_modulus_m, double radius_m, double thickness_m,
                                 const LayerKernel& kernel);

/// Largest b/h that the two functions above solve for.
constexpr double kWidestLineContact = 80;

}  // namespace softfinger
