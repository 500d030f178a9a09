#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"
#include "comparisons/exporting/simulators/patch_friction.h"

/// PhysX 5: the law stands in patch_friction.h.
namespace softfinger::exporting {
namespace {

Lines lines(const SoftContact& contact) {
  const PatchRadii radii = patch_radii(contact);
  // '#' prints a decimal point even for whole numbers, because 1f is not a number in C++.
  return {
      fmt::format(
          "// {origin}. createMaterial: mu, static and dynamic; radius: m, e_n = largest "
          "torque / (mu load)\n"
          "sceneDesc.solverType = physx::PxSolverType::eTGS;\n"
          "physx::PxMaterial* material = physics.createMaterial({mu:#.6g}f, {mu:#.6g}f, 0.0f);\n"
          "material->setFrictionCombineMode(physx::PxCombineMode::eMIN);\n"
          "fingertip->setMinTorsionalPatchRadius({least:#.6g}f);\n"
          "fingertip->setTorsionalPatchRadius({radius:.1f}f);\n",
          fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
          fmt::arg("least", radii.min_radius_m), fmt::arg("radius", radii.radius_m)),
      {{"sliding_friction", contact.friction_coefficient},
       {"min_torsional_patch_radius_m", radii.min_radius_m},
       {"torsional_patch_radius_m", radii.radius_m}}};
}

/// Two of the corners are a patch's anchors. Each has the whole mu P unless the material shares the
/// load among them: eIMPROVED_PATCH_FRICTION, which later versions always do.
Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = contact.face->corner_box_m();
  return {
      fmt::format(
          "// {origin}. A box in place of the pad's face, its corners at e_n = {e:.6g} m from the "
          "middle\n"
          "physx::PxBoxGeometry pad({x:#.6g}f, {y:#.6g}f, {z:#.6g}f);\n"
          "physx::PxMaterial* material = physics.createMaterial({mu:#.6g}f, {mu:#.6g}f, 0.0f);\n"
          "material->setFlag(physx::PxMaterialFlag::eIMPROVED_PATCH_FRICTION, true);\n"
          "material->setFrictionCombineMode(physx::PxCombineMode::eMIN);\n",
          fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
          fmt::arg("e", contact.face->eccentricity_m), fmt::arg("x", x_m), fmt::arg("y", y_m),
          fmt::arg("z", contact.face->thickness_m / 2)),
      {{"sliding_friction", contact.friction_coefficient},
       {"box_half_length_x_m", x_m},
       {"box_half_length_y_m", y_m}}};
}

}  // namespace

Simulator physx_simulator() {
  return {
      "physx",
      "PhysX",
      kPatchFrictionLaw,
      0,
      0,
      lines,
      box_lines,
      {kTorsionNeedsTgs, "the default solver is PGS", kRadiusIsEccentricity,
       "torsionalPatchRadius would add sqrt(radius penetration) with the solver's penetration, and "
       "is 0 here to leave that out; of each radius the larger of the two shapes counts",
       "friction is averaged over the two materials unless a combine mode says otherwise (here "
       "the smaller one)",
       kSecondAnchor, kSeparateLimits},
      "PhysX 5.8.0 (physx/source/lowleveldynamics/src/DyTGSContactPrep.cpp, "
      "DyFrictionCorrelation.cpp), and measured in 5.6.1",
      "A restitution of -{k} makes each contact point a spring of that many N/m, "
      "material->setDamping damps it (before PhysX 5.4 only with the flag eCOMPLIANT_CONTACT), and "
      "sceneDesc.frictionCorrelationDistance = 1e-5f keeps its torque; "
      "there is no stiffness about the normal.",
      kCppComment};
}

}  // namespace softfinger::exporting
