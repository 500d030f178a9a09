#pragma once

namespace softfinger::taxels {

/// Stresses inside of an elastic layer that is bonded to a rigid base, in linear elasticity, under
/// pressure and under shear on its surface. A pressure wave p^ of wave number k on the surface
/// gives, at the depth z of a layer of thickness h, the normal stress g p^ (compression positive)
/// and, along the wave vector, the shear traction t p^, a quarter of a wave behind: on what lies
/// deeper it points away from where the surface is pressed. With H = kh, y = kz, kappa = 3 - 4 nu:
///   D = 2 kappa cosh 2H + 4H² + 1 + kappa²
///   g = [2 kappa (cosh(2H - y) + y sinh(2H - y)) + (1 + kappa² + 4H(H - y)) cosh y
///        + 2 (2H - y) sinh y] / D
///   t = [2 kappa y cosh(2H - y) + 2y cosh y - (kappa² - 1 + 4H(H - y)) sinh y] / D
/// (Papkovich and Neuber's potentials that vanish at the base; D is the denominator of the
/// compliance in layer/layer_kernel.h, K. L. Johnson, Contact Mechanics, section 5.8.) The
/// half-space has g = (1 + y) exp(-y), t = y exp(-y), whose point loads are Boussinesq's. g(k = 0)
/// = 1: the force through any plane is the load.
///
/// A shear wave q^ along its wave vector gives, likewise, a normal stress -s q^ (a quarter of a
/// wave behind: shear that points to a place presses there) and a shear l q^ along the vector; one
/// across its wave vector gives the shear c q^ across it:
///   s = [2 kappa y cosh(2H - y) + 2y cosh y + (kappa² - 1 + 4H(H - y)) sinh y] / D
///   l = [2 kappa (cosh(2H - y) - y sinh(2H - y)) + (1 + kappa² + 4H(H - y)) cosh y
///        - 2 (2H - y) sinh y] / D
///   c = cosh(H - y) / cosh H
/// The half-space has s = y exp(-y), l = (1 - y) exp(-y), c = exp(-y), whose point loads are
/// Cerruti's. On the surface shear lifts: the displacement into the layer is -w q^/(mu k), with
///   w = [kappa (kappa - 1)/2 (cosh 2H - 1) - 2H²] / D
/// and mu the shear modulus; the half-space has (kappa - 1)/4.
class LayerStress {
 public:
  /// @param poisson_ratio   nu, 0 to 1/2
  /// @param relative_depth  z/h, 0 to 1: 0 the surface, 1 the base
  LayerStress(double poisson_ratio, double relative_depth) noexcept
      : kappa_(3 - 4 * poisson_ratio), depth_(relative_depth) {}

  /// Both stresses of one wave, over its pressure.
  struct Wave {
    double normal = 0, shear = 0;
  };
  /// g and t, x = kh >= 0: absolute error a few epsilon.
  Wave stress(double x) const noexcept;

  /// g and t less those of the half-space: they decay like x² exp(-x (2 - z/h)), and have few
  /// epsilon of error themselves.
  Wave excess(double x) const noexcept;

  /// Stresses of one wave of shear, over the shear.
  struct ShearWave {
    double normal = 0;  ///< s
    double along = 0;   ///< l
    double across = 0;  ///< c
  };
  /// s, l and c less those of the half-space.
  ShearWave shear_excess(double x) const noexcept;

  /// w, of the whole layer, and its limit for short waves.
  double lift(double x) const noexcept;
  double lift_of_half_space() const noexcept { return (kappa_ - 1) / 4; }

 private:
  /// Hyperbolic functions of one wave over exp(2H), so that nothing overflows.
  struct Terms {
    double H, y, decay, up, down, cosh_y, sinh_y, from_base, all, denominator;
  };
  Terms terms(double x) const noexcept;

  double kappa_, depth_;
};

}  // namespace softfinger::taxels
