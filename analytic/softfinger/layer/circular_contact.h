#pragma once

#include <Eigen/Core>
#include <vector>

#include "softfinger/layer/stack_kernel.h"

namespace softfinger {

/// Contact of a rigid paraboloid, gap r²/(2R), with one bonded layer or two facing ones.
struct CircularLayerContact {
  double a_m = 0;
  double load_over_modulus_m2 = 0;  ///< P/E*
  double indentation_m = 0;
  double torque_arm_m = 0;  ///< (int p r dA)/P

  /// p/E* at the distance r from the centre, zero outside.
  double pressure_over_modulus(double r_m) const noexcept;

  /// Chebyshev coefficients in r²/a² of the pressure over its scale times sqrt(1 - r²/a²).
  Eigen::VectorXd pressure_coefficients;
  double pressure_scale = 0;
};

/// One of the layers, or stacks of sublayers, that share the deformation.
struct CompliantLayer {
  StackKernel kernel;
  double share;  ///< of the half-spaces' compliance: (1/E*_i) / (1/E*); they add up to one

  CompliantLayer(const StackKernel& of_layer, double of_compliance)
      : kernel(of_layer), share(of_compliance) {}
  CompliantLayer(const LayerKernel& layer, double thickness_m, double of_compliance)
      : kernel(layer, thickness_m), share(of_compliance) {}
};

/// Exact axisymmetric solution for a given contact radius: the Fredholm equation
///   phi(t) - (2/pi) int_0^a phi(s) int_0^inf (1 - w(k h)) cos kt cos ks dk ds
///     = (E*/pi) (d - t²/R),  phi(a) = 0,
///   P = 2 pi int phi dt,  int p r dA = pi² int t phi dt,
///   p(r) = -int_r^a phi'(t) / sqrt(t² - r²) dt
/// (Lebedev & Ufliand 1958 and later authors; the moment by exchanging the integrals), by Nystrom's
/// method with Gauss-Legendre nodes, which converges exponentially. The kernel's integral is taken
/// by a Gauss-Legendre rule that resolves every oscillation. Relative error below 1e-10 to
/// a/h = 20, 1e-6 to 50 and 1e-4 to 120 (at nu = 1/2, where it is largest). Cost: 0.3 ms (a/h = 1)
/// to 0.5 s (a/h = 120). Allocates.
///
/// `a_m` > 0 and at most 120 times any thickness, of a stack that of the surface's sublayer.
CircularLayerContact circular_layer_contact(double a_m, double radius_m,
                                            const std::vector<CompliantLayer>& layers);

/// Solves for the contact radius at a given P/E*, met to a relative 1e-13; a_m = 0 when a/h would
/// exceed 120. Cost: about seven times `circular_layer_contact`.
CircularLayerContact circular_layer_contact_at_load(double load_over_modulus_m2, double radius_m,
                                                    const std::vector<CompliantLayer>& layers);

/// Largest a/h that the two functions above solve for.
constexpr double kLargestCircularContact = 120;

}  // namespace softfinger
