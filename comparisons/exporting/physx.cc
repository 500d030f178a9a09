#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"

/// PhysX 5, PxShape's reference and the TGS solver's preparation of contacts: the torque about the
/// normal is at most r mu N with r = max(minTorsionalPatchRadius, sqrt(torsionalPatchRadius
/// penetration)), whatever the sliding force; the larger radii of the two shapes count. No factor
/// of a pressure distribution: r is e_n. The penetration is the solver's, near zero and no elastic
/// one, so that only the first radius is a property of the contact.
namespace softfinger::exporting {
namespace {

Lines lines(const SoftContact& contact) {
  // With a point even in whole numbers: 1f is no number in C++.
  return {
      fmt::format(
          "// {origin}. createMaterial: mu, static and dynamic; radius: m, e_n = largest "
          "torque / (mu load)\n"
          "sceneDesc.solverType = physx::PxSolverType::eTGS;\n"
          "physx::PxMaterial* material = physics.createMaterial({mu:#.6g}f, {mu:#.6g}f, 0.0f);\n"
          "material->setFrictionCombineMode(physx::PxCombineMode::eMIN);\n"
          "fingertip->setMinTorsionalPatchRadius({e:#.6g}f);\n"
          "fingertip->setTorsionalPatchRadius(0.0f);\n",
          fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
          fmt::arg("e", contact.eccentricity_m)),
      {{"sliding_friction", contact.friction_coefficient},
       {"min_torsional_patch_radius_m", contact.eccentricity_m},
       {"torsional_patch_radius_m", 0.0}}};
}

}  // namespace

Simulator physx() {
  return {
      "physx",
      "PhysX",
      "|f| <= mu P and, apart from it, |torque| <= mu r P with r constant, or growing with the "
      "penetration",
      0,
      0,
      lines,
      {"torsional friction exists with the TGS solver only, the default solver is PGS, and only "
       "where the patch has a single contact point (sphere, ellipsoid; not box on box)",
       "r is e_n itself, not the contact's radius (3 pi/16 of it for a round Hertz contact)",
       "torsionalPatchRadius would add sqrt(radius penetration), P^(1/2) at best, from the "
       "solver's penetration: 0 leaves it out; of each radius the larger of two shapes counts",
       "friction is averaged over the two materials unless a combine mode says otherwise (here "
       "the smaller one); force and torque do not share one limit: 25 % above the ellipsoid at "
       "0.6 mu P"}};
}

}  // namespace softfinger::exporting
