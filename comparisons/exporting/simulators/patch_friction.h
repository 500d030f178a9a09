#pragma once

#include <algorithm>
#include <cmath>
#include <string_view>

#include "comparisons/exporting/simulator.h"

/// PhysX's torsional friction (reference of PxShape; DyTGSContactPrep.cpp prepares the contacts). A
/// patch with one anchor has a third friction constraint about the normal. The radius r scales its
/// limit as it scales that of a force: |torque| <= mu r N, whatever the sliding force. There is no
/// factor for a pressure distribution, so r is e_n itself. Simulators that are built on PhysX share
/// this law.
namespace softfinger::exporting {

/// r = max(min_radius, sqrt(radius penetration)); of each radius the larger of the two shapes
/// counts.
inline double torsional_radius_m(double min_radius_m, double radius_m, double penetration_m) {
  return std::max(min_radius_m, std::sqrt(radius_m * std::max(penetration_m, 0.0)));
}

/// The radii that give a contact its e_n at any penetration: only the first one can describe it. A
/// rigid contact's penetration is near zero, and no elastic indentation.
struct PatchRadii {
  double min_radius_m = 0, radius_m = 0;
};
inline PatchRadii patch_radii(const SoftContact& contact) { return {contact.eccentricity_m, 0}; }

constexpr std::string_view kPatchFrictionLaw =
    "|f| <= mu P and, apart from it, |torque| <= mu r P with r constant, or growing with the "
    "penetration";

/// A patch keeps its torque only while it has one anchor. It gets a second one where the contact
/// point has moved by more than 0.1 mm while it sticks, as it does while a compliant contact sinks
/// in (DyFrictionCorrelation.cpp). With this correlation distance the patch is made anew before
/// that.
constexpr double kCorrelationDistance_m = 1e-5;

/// Peculiarities of this law, for the simulators' traps.
constexpr std::string_view
    kTorsionNeedsTgs =
        "torsional friction exists only with the TGS solver, and only where the patch has a single "
        "contact point (sphere, ellipsoid; not box on box)",
    kRadiusIsEccentricity =
        "r is e_n itself, not the contact's radius (3 pi/16 of it for a round Hertz contact)",
    kSecondAnchor =
        "a patch whose contact point has moved by more than 0.1 mm while it sticks, as it does "
        "while a "
        "compliant contact sinks in, has no torque at all, unless the scene's friction correlation "
        "distance is smaller than that",
    kSeparateLimits =
        "force and torque have separate limits: at 0.6 mu P the torque is 25 % above the ellipsoid";

}  // namespace softfinger::exporting
