#pragma once

#include "softfinger/layer/layer_kernel.h"

namespace softfinger {

/// Contact of a rigid quadric with a bonded elastic layer in the layer's own units: lengths along
/// the surface in h, R = sqrt(R' R'') = 1 and E* = 1, so that load = P R/(E* h³),
/// indentation = d R/h², pressure = p R/(E* h).
struct EllipticLayerContact {
  double a = 0, b = 0;        ///< semi-axes of the best-fitting ellipse over h
  double radii_ratio = 1;     ///< R'/R''
  double load = 0;            ///< P R/(E* h³)
  double indentation = 0;     ///< d R/h²
  double torque_arm = 0;      ///< (int p r dA)/P over h
  double peak_pressure = 0;   ///< at the centre, p0 R/(E* h)
  double edge_deviation = 0;  ///< e4: in scaled coordinates the true edge is 1 + e4 cos 4t + ...
};

/// Number of terms in the expansion of the pressure.
struct SpectralResolution {
  int radial = 12;  ///< largest l of (1 - r²)^(-1/2) Q_lm(r) cos(m t): degree 2 l in r
  int angular = 6;  ///< largest m/2 <= radial
};

/// Resolution at which load, torque and axes have converged to about 3e-5 or better for a/h to 100.
SpectralResolution sufficient_resolution(double a, double b) noexcept;

/// The quadric that touches a layer in the ellipse with semi-axes a >= b > 0 (in units of h), by a
/// Galerkin method.
///
/// The pressure is (1 - r²)^(-1/2) times polynomials in the scaled coordinates x/a, y/b, orthogonal
/// on the disc, whose Fourier transforms are spherical Bessel functions j_2l(q) cos(m psi),
/// q = (a kx, b ky): the half-space part of the matrix is known in closed form, the layer's part
/// is a smooth integral that decays exponentially. d : 1/R' : 1/R'' follow from the condition that
/// the singular part of the pressure at the edge, which measures how far the true edge is from the
/// ellipse, has no mean and no cos 2t component. What is left of it (cos 4t and higher) is the
/// deviation of the edge from an ellipse; its effect on all integrals is of second order.
///
/// Cost: milliseconds for a/h ~ 1 to a second for a/h ~ 300. Allocates.
EllipticLayerContact elliptic_layer_contact(double a, double b, const LayerKernel& kernel,
                                            SpectralResolution resolution);

/// Solves for the ellipse at a given load and R'/R'' >= 1, by Newton's method on ln a, ln b from
/// the guess (a, b), to a relative residual of `tolerance`. Throws ConvergenceError.
EllipticLayerContact elliptic_layer_contact_at_load(double load, double radii_ratio,
                                                    const LayerKernel& kernel, double a_guess,
                                                    double b_guess, double tolerance = 1e-7);

}  // namespace softfinger
