#pragma once

#include <limits>

/// What every model of this project is asked: an elastic layer on a rigid core, the relative
/// curvature of the two bodies, a load. SI units; the suffix of a name is its unit.
namespace softfinger {

/// Homogeneous, isotropic, linearly elastic layer bonded to a rigid base.
struct ElasticLayer {
  double thickness_m = 0;        ///< h > 0
  double youngs_modulus_Pa = 0;  ///< E > 0
  double poisson_ratio = 0;      ///< 0 <= nu <= 1/2

  /// G = E / (2 (1 + nu))
  double shear_modulus_Pa() const { return youngs_modulus_Pa / (2 * (1 + poisson_ratio)); }

  /// E* = E / (1 - nu²), for a rigid object
  double plane_strain_modulus_Pa() const {
    return youngs_modulus_Pa / (1 - poisson_ratio * poisson_ratio);
  }

  /// Oedometric (confined) modulus M = E (1 - nu) / ((1 + nu)(1 - 2 nu)); infinite at nu = 1/2.
  double oedometric_modulus_Pa() const {
    const double compressibility = 1 - 2 * poisson_ratio;
    return compressibility > 0 ? youngs_modulus_Pa * (1 - poisson_ratio) /
                                     ((1 + poisson_ratio) * compressibility)
                               : std::numeric_limits<double>::infinity();
  }
};

/// Relative radii of curvature of an undeformed contact: the gap between the surfaces is
/// x²/(2 R') + y²/(2 R''), x along the long axis of the contact (Ciocarlie et al. 2007, eq. 8).
struct RelativeRadii {
  double major_m = 0;   ///< R' >= R'' > 0
  double minor_m = 0;   ///< R''
  double axis_rad = 0;  ///< direction of x, counter-clockwise from the first body's x axis
};

struct ContactLoad {
  double normal_force_N = 0;        ///< P > 0
  double friction_coefficient = 0;  ///< mu > 0
};

struct ContactProblem {
  RelativeRadii radii;
  ElasticLayer layer;
  ContactLoad load;
};

}  // namespace softfinger
