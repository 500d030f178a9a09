#pragma once

#include <array>
#include <cstddef>
#include <limits>

namespace softfinger {

/// Friction while a contact is pressed.
enum class PressingFriction {
  none,     ///< it sets in when the load is reached
  coulomb,  ///< it acts from the first touch, by the law of the contact's load
  stuck     ///< all that touches sticks
};

/// Names of these, in their order.
inline constexpr std::array<const char*, 3> kPressingFrictionNames{"frictionless", "coulomb",
                                                                   "stuck"};

inline const char* name_of(PressingFriction pressing) {
  return kPressingFrictionNames[static_cast<std::size_t>(pressing)];
}

/// The coefficient that acts while the contact is pressed: zero without friction, infinite where
/// all sticks.
/// @param friction_coefficient  that of the contact's load
inline double pressing_friction_coefficient(PressingFriction pressing,
                                            double friction_coefficient) {
  switch (pressing) {
    case PressingFriction::none:
      return 0;
    case PressingFriction::coulomb:
      return friction_coefficient;
    case PressingFriction::stuck:
      break;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace softfinger
