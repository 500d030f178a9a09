#pragma once

#include "softfinger/layer/elliptic_contact.h"
#include "softfinger/layer/layer_kernel.h"

namespace softfinger {

/// Stiffness of the stuck contact of a bonded layer in the layer's own units, thickness h and shear
/// modulus G.
struct StuckLayerStiffness {
  double torsional = 0;     ///< k_t/(G h³)
  double tangential_x = 0;  ///< k_x/(G h)
  double tangential_y = 0;  ///< k_y/(G h)
};

/// Resolution at which the stiffnesses have converged to 1e-5 or better, for a/h to 500.
SpectralResolution sufficient_stuck_resolution(double a, double b) noexcept;

/// Torque per rotation and force per shift of a rigid ellipse with semi-axes a, b > 0 (in units of
/// h, x along a) that is stuck to a bonded layer, its normal pressure unchanged, by a Galerkin
/// method.
///
/// A tangential traction t^ of wave vector k moves the surface by
///   u^ = 2 w_t(kh)/(E* k) (n n^T) t^ + tanh(kh)/(G k) (1 - n n^T) t^,  n = k/|k|
/// (layer_kernel.h). Each component of the traction is (1 - r²)^(-1/2) times polynomials in the
/// scaled coordinates x/a, y/b, whose Fourier transforms are j_n(q) cos(m psi) or sin(m psi),
/// q = (a kx, b ky), n - m even: n even for a shift, odd for a rotation. The half-space part of the
/// matrix is known in closed form, the layer's part is a smooth integral that decays exponentially.
/// The stiffness is a variational bound: it grows with the resolution, and its error is of second
/// order.
///
/// Cost: milliseconds for a/h ~ 1 to several seconds for a/h ~ 400 with a/b = 20. Allocates.
StuckLayerStiffness stuck_layer_stiffness(double a, double b, const LayerKernel& kernel,
                                          SpectralResolution resolution);

}  // namespace softfinger
