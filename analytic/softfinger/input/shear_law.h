#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace softfinger {

/// Names of the shear laws, in the order of `ShearLaw::Kind`.
constexpr std::array<const char*, 4> kShearLawNames = {"coulomb", "shear_strength", "limited",
                                                       "adhesive_shear"};

/// The largest shear stress that a point of a contact carries under a pressure p >= 0. Where
/// nothing touches there is none.
struct ShearLaw {
  enum class Kind {
    coulomb,         ///< mu p
    shear_strength,  ///< tau_0: smooth silicone, where adhesion makes the real contact complete
    limited,         ///< min(mu p, tau_0): Coulomb's law up to the strength of the softer body
    adhesive_shear   ///< tau_0 + mu p
  };
  Kind kind = Kind::coulomb;
  double friction_coefficient = 0;  ///< mu >= 0; not used by shear_strength
  double shear_strength_Pa = 0;     ///< tau_0 >= 0; not used by coulomb

  const char* name() const { return kShearLawNames[std::size_t(kind)]; }
  bool has_friction_coefficient() const { return kind != Kind::shear_strength; }
  bool has_shear_strength() const { return kind != Kind::coulomb; }

  /// The largest force on an area under the same pressure everywhere.
  double largest_force_N(double normal_force_N, double area_m2) const {
    switch (kind) {
      case Kind::shear_strength:
        return shear_strength_Pa * area_m2;
      case Kind::limited:
        return std::min(friction_coefficient * normal_force_N, shear_strength_Pa * area_m2);
      case Kind::adhesive_shear:
        return shear_strength_Pa * area_m2 + friction_coefficient * normal_force_N;
      default:
        return friction_coefficient * normal_force_N;
    }
  }
  double largest_stress_Pa(double pressure_Pa) const { return largest_force_N(pressure_Pa, 1); }

  /// Coulomb's law.
  static ShearLaw coulomb(double friction_coefficient) {
    return {Kind::coulomb, friction_coefficient, 0};
  }
};

}  // namespace softfinger
