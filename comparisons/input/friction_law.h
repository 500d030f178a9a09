#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "softfinger/dynamics/contacts/contact_lcp.h"
#include "softfinger/friction/friction_shape.h"

namespace softfinger::input {

/// A law that a scene can choose for the friction of its contacts: what bounds the tangential force
/// f and the torque tau about the normal. All laws agree at pure force, f = mu P, and at pure
/// torque, tau = mu P e_n. They differ in between. A new law is one entry in friction_law.cc.
struct FrictionLaw {
  std::string_view name;         ///< as in scene files: friction = "..."
  std::string_view description;  ///< what it is and how exact, for people
  FrictionRule solver_rule;      ///< its form in the contact solver
  /// Builds the law's limit for a contact ellipse (arguments as for SurfaceShape). Null: the limit
  /// has the same shape, without units, for all ellipses.
  std::unique_ptr<const FrictionShape> (*shape)(double aspect, double exponent);
};

extern const FrictionLaw kEllipsoidLaw, kSixPatchesLaw, kLimitSurfaceLaw, kFacetsLaw;

/// The laws from the cheapest to the most exact, facets last.
const std::vector<const FrictionLaw*>& all_friction_laws();

}  // namespace softfinger::input
