#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"

/// PhysX 5 (reference of PxShape, and how the TGS solver prepares contacts). The torque about the
/// normal is at most r mu N, whatever the sliding force, with r = max(minTorsionalPatchRadius,
/// sqrt(torsionalPatchRadius penetration)). The larger radii of the two shapes count. There is no
/// factor for a pressure distribution, so r is e_n itself. The penetration is that of the solver,
/// near zero, and not an elastic indentation: only the first radius can describe the contact.
namespace softfinger::exporting {
namespace {

Lines lines(const SoftContact& contact) {
  // '#' prints a decimal point even for whole numbers, because 1f is not a number in C++.
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
      "|f| <= mu P and, apart from it, |torque| <= mu r P with r constant, or growing with the "
      "penetration",
      0,
      0,
      lines,
      box_lines,
      {"torsional friction exists only with the TGS solver (the default is PGS), and only where "
       "the "
       "patch has a single contact point (sphere, ellipsoid; not box on box)",
       "r is e_n itself, not the contact's radius (3 pi/16 of it for a round Hertz contact)",
       "torsionalPatchRadius would add sqrt(radius penetration) with the solver's penetration, and "
       "is "
       "0 here to leave that out; of each radius the larger of the two shapes counts",
       "friction is averaged over the two materials unless a combine mode says otherwise (here "
       "the smaller one); force and torque have separate limits: at 0.6 mu P the torque is 25 % "
       "above the ellipsoid"}};
}

}  // namespace softfinger::exporting
