#pragma once

#include <array>
#include <cstddef>

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

}  // namespace softfinger
