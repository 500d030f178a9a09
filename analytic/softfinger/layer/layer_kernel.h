#pragma once

#include "softfinger/input/contact_problem.h"

namespace softfinger {

/// Compliance of an elastic layer bonded to a rigid base, under frictionless normal pressure,
/// against that of the half-space: a pressure wave p^ of wave number k lowers the surface by
///   u^ = 2 w(k h) / (E* k) p^,
///   w(x) = [2 kappa sinh 2x - 4x] / [2 kappa cosh 2x + 4x² + 1 + kappa²],  kappa = 3 - 4 nu
/// (K. L. Johnson, Contact Mechanics, section 5.8). w grows from 0 (like x (1 - 2 nu)/(2 (1 -
/// nu)²), at nu = 1/2 like 2x³/3) to 1, the half-space.
class LayerKernel {
 public:
  /// `poisson_ratio` in [0, 1/2].
  explicit LayerKernel(double poisson_ratio) noexcept
      : LayerKernel(Compressibility{1 - 2 * poisson_ratio}) {}

  /// 1 - 2 nu in [0, 1] given directly: nu itself cannot express how close to 1/2 it is.
  struct Compressibility {
    double value;
  };
  explicit LayerKernel(Compressibility compressibility) noexcept
      : compressibility_(compressibility.value) {}

  double compressibility() const noexcept { return compressibility_; }

  /// w(x), x >= 0. Relative error a few epsilon for all x and nu; one exponential.
  double compliance(double x) const noexcept;

  /// 1 - w(x), which decays like 4 x² exp(-2x): relative error a few epsilon where it is small.
  double stiffening(double x) const noexcept;

  /// 1 - w_t(x) of the tangential compliance: a wave of tangential traction t^ along the wave
  /// vector (normal pressure unchanged) moves the surface along it by
  ///   u^ = 2 w_t(k h) / (E* k) t^,
  ///   w_t(x) = [2 kappa sinh 2x + 4x] / [2 kappa cosh 2x + 4x² + 1 + kappa²]
  /// (the same plane strain problem; compared with a numerical solution through the thickness).
  /// Limits: half-space; h/G for a thin layer, at nu = 1/2 too.
  double tangential_stiffening(double x) const noexcept;

  /// 1 - tanh(x): a traction perpendicular to the wave vector moves the surface by tanh(kh)/(G k),
  /// whatever nu is.
  static double antiplane_stiffening(double x) noexcept;

 private:
  double compressibility_;
};

/// Beyond this x the layer is a half-space: 1 - w is below 1e-15.
constexpr double kLargestLayerWaveNumber = 21;

}  // namespace softfinger
