#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"
#include "comparisons/exporting/simulators/patch_friction.h"

/// SAPIEN, and ManiSkill, which is built on it. Its collision shapes hand patch_radius and
/// min_patch_radius to PhysX's torsionalPatchRadius and minTorsionalPatchRadius. The solver is TGS
/// unless enable_tgs says otherwise. Every PhysxMaterial has eIMPROVED_PATCH_FRICTION, by which the
/// two anchors of a larger patch share mu N. No combine mode is set, so PhysX averages the friction
/// of a pair, and the object needs the same material. PhysX 5.3.1 makes a contact compliant only by
/// the material flag eCOMPLIANT_CONTACT, which SAPIEN does not set.
namespace softfinger::exporting {
namespace {

Lines lines(const SoftContact& contact) {
  const PatchRadii radii = patch_radii(contact);
  return {fmt::format(
              "# {origin}. min_patch_radius: m, e_n = largest torque / (mu load)\n"
              "soft_finger = sapien.physx.PhysxMaterial(static_friction={mu:.6g}, "
              "dynamic_friction={mu:.6g}, restitution=0.0)\n"
              "for shape in fingertip.collision_shapes:  # of its PhysX component\n"
              "    shape.set_physical_material(soft_finger)\n"
              "    shape.set_patch_radius({radius:.6g})\n"
              "    shape.set_min_patch_radius({least:.6g})\n"
              "for shape in touched.collision_shapes:\n"
              "    shape.set_physical_material(soft_finger)\n"
              "# ManiSkill: urdf_config = "
              "dict(_materials=dict(soft_finger=dict(static_friction={mu:.6g}, "
              "dynamic_friction={mu:.6g}, restitution=0.0)),\n"
              "#   link=dict(fingertip=dict(material=\"soft_finger\", patch_radius={radius:.6g}, "
              "min_patch_radius={least:.6g})))\n",
              fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
              fmt::arg("radius", radii.radius_m), fmt::arg("least", radii.min_radius_m)),
          {{"sliding_friction", contact.friction_coefficient},
           {"object_sliding_friction", contact.friction_coefficient},
           {"min_torsional_patch_radius_m", radii.min_radius_m},
           {"torsional_patch_radius_m", radii.radius_m}}};
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = contact.face->corner_box_m();
  return {fmt::format(
              "# {origin}. A box in place of the pad's face, its corners at e_n = {e:.6g} m from "
              "the middle\n"
              "soft_pad = sapien.physx.PhysxMaterial(static_friction={mu:.6g}, "
              "dynamic_friction={mu:.6g}, restitution=0.0)\n"
              "builder.add_box_collision(half_size=[{x:.6g}, {y:.6g}, {z:.6g}], "
              "material=soft_pad, patch_radius=0.0, min_patch_radius=0.0)\n"
              "# on the object: the same material\n",
              fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
              fmt::arg("e", contact.face->eccentricity_m), fmt::arg("x", x_m), fmt::arg("y", y_m),
              fmt::arg("z", contact.face->thickness_m / 2)),
          {{"sliding_friction", contact.friction_coefficient},
           {"object_sliding_friction", contact.friction_coefficient},
           {"box_half_length_x_m", x_m},
           {"box_half_length_y_m", y_m}}};
}

}  // namespace

Simulator sapien_simulator() {
  return {
      "sapien",
      "SAPIEN",
      kPatchFrictionLaw,
      0,
      0,
      lines,
      box_lines,
      {kTorsionNeedsTgs, kRadiusIsEccentricity,
       "ManiSkill's own robots often have a radius of 0.1 m, which carries fifty times the torque "
       "of a fingertip's 2 mm; of each radius the larger of the two shapes counts",
       "friction is averaged over the two materials, and no combine mode can be set: an object "
       "with the default 0.3 slides earlier and turns earlier",
       kSeparateLimits},
      "SAPIEN 3.0.2 (src/physx/material.cpp, collision_shape.cpp, physx_system.cpp) with PhysX "
      "5.3.1 (physx/source/lowleveldynamics/src/DyTGSContactPrep.cpp); PhysX's part was measured "
      "in 5.6.1",
      "SAPIEN has no place for it: its materials never make PhysX's contacts compliant."};
}

}  // namespace softfinger::exporting
