#pragma once

#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/input/shear_law.h"

/// Largest force and torque of a contact under a shear law, in closed form.
namespace softfinger {

/// A contact whose pressure is p = p_0 (1 - x²/a² - y²/b²)^n, p_0 = (n+1) P / (pi a b).
struct PressedEllipse {
  double a_m = 0, b_m = 0;  ///< semi-axes, a >= b > 0
  double exponent = 0.5;    ///< n > -1: 1/2 is Hertz, 1 Winkler, 0 uniform
  double load_N = 0;        ///< P >= 0
};

/// The largest force along the surface, int tau dA with tau the law's stress:
///   coulomb mu P,   shear_strength pi a b tau_0,   adhesive_shear their sum,
///   limited mu P w^(n+1) + pi a b tau_0 c²,   n > 0, where mu p = tau_0 at the relative radius c:
///   w = 1 - c² = min(1, tau_0/(mu p_0))^(1/n).
/// For -1 < n < 0, where the strength limits the rim, w^(n+1) and c² are replaced by what they lack
/// to 1. Relative error below 1e-13. Zero for a contact without size, but for mu P.
double max_force_N(const ShearLaw& law, const PressedEllipse& contact) noexcept;

/// The largest torque about the normal, int tau r dA. With the arms e(n) of torque_arm_exact_m:
///   coulomb mu P e(n),   shear_strength pi a b tau_0 e(0) = 4/3 tau_0 a² b E(1 - b²/a²), adhesive_
///   shear their sum,   limited mu P e(n) I_w(n+1, 3/2) + pi a b tau_0 e(0) c³,
/// I the regularised incomplete Beta function. Range, error and limits as above. Cost: 0.1
/// (coulomb) to 0.3 microseconds.
double max_torque_Nm(const ShearLaw& law, const PressedEllipse& contact) noexcept;

/// f² + tau²/e² <= F² with F the largest force and e the largest torque over it; no arm without F.
FrictionEllipsoid friction_ellipsoid(const ShearLaw& law, const PressedEllipse& contact) noexcept;

namespace internal {

/// Depth w = 1 - c² at which mu p = tau_0, c the relative radius; 0 to 1. For n > 0 the strength
/// limits the stress within c, for n < 0 beyond it.
double depth_of_strength(const ShearLaw& law, const PressedEllipse& contact) noexcept;

}  // namespace internal
}  // namespace softfinger
