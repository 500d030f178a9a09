#pragma once

#include "softfinger/friction/friction_ellipsoid.h"
#include "softfinger/friction/limit_surface.h"
#include "softfinger/friction/shear_surface.h"

namespace softfinger {

/// Deviation of a friction ellipsoid from the exact limit surface in the direction of a wrench: the
/// ellipsoid's utilisation at the exact surface's point in that direction, less 1. Negative: the
/// ellipsoid lies outside there and claims more friction than there is. Positive: it lies inside
/// and is conservative. Zero in every direction of pure force and, with the exact e_n, of pure
/// torque. Both must have the same mu P > 0. Zero for no wrench. Cost: one utilisation.
double ellipsoid_deviation(const LimitSurface& surface, const FrictionEllipsoid& ellipsoid,
                           const LimitWrench& direction) noexcept;
double ellipsoid_deviation(const ShearSurface& surface, const FrictionEllipsoid& ellipsoid,
                           const LimitWrench& direction) noexcept;

/// Extremes of `ellipsoid_deviation` over all directions, and where.
struct EllipsoidDeviation {
  double lowest = 0;                  ///< <= 0: by how much the ellipsoid exceeds the exact surface
  double highest = 0;                 ///< >= 0: by how much it falls short
  Twist lowest_twist, highest_twist;  ///< slip at those points: speed and e_n omega in metres per
                                      ///< second, root sum 1
  LimitWrench lowest_wrench, highest_wrench;  ///< on the exact surface
};

/// Search over the slip directions of one octant (the others follow by symmetry), refined to 1e-8
/// in the deviation. For Hertz and the exact e_n, lowest and highest are -6.00 and 0 % for a
/// circle, -9.17 and 0 % at a/b = 2, -10.85 and 3.2 % at 5, -11.19 and 4.7 % at 10. The lowest is
/// for a force along the short axis; long ellipses carry *more* than the ellipsoid says when the
/// force is along the long axis. At pure torque the e_n of Ciocarlie et al. (2007) is too small:
/// exact over theirs, less 1, is 9 % at a/b = 2 and 105 % at 10. Cost: 700 wrenches, one or two
/// milliseconds; under the law `limited` 0.1 s.
EllipsoidDeviation worst_ellipsoid_deviation(const LimitSurface& surface,
                                             const FrictionEllipsoid& ellipsoid) noexcept;
EllipsoidDeviation worst_ellipsoid_deviation(const ShearSurface& surface,
                                             const FrictionEllipsoid& ellipsoid) noexcept;

}  // namespace softfinger
