#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"
#include "comparisons/exporting/simulators/patch_friction.h"

/// A physics material of Universal Scene Description: UsdPhysics' PhysicsMaterialAPI has friction
/// without torque; Newton's schema NewtonMaterialAPI adds torsionalFriction (a length, which Newton
/// hands to MuJoCo as friction[1], the largest torque per load), contactStiffness (mass/s²) and
/// contactDamping (mass/s). PhysX reads attributes of its own, by the law of patch_friction.h.
///
/// A length is written in the stage's unit, metersPerUnit. A stiffness in mass/s² has no length in
/// it, and is the same number on every stage.
namespace softfinger::exporting {
namespace {

double in_stage_units(double length_m, const SoftContact& contact) {
  return length_m / contact.meters_per_unit;
}

Lines lines(const SoftContact& contact) {
  const PatchRadii radii = patch_radii(contact);
  const double spin = in_stage_units(contact.torque_per_load_m(), contact),
               least_radius = in_stage_units(radii.min_radius_m, contact);
  return {
      fmt::format(
          "# {origin}. torsionalFriction: largest torque / load = mu e_n, a length in the stage's "
          "unit, here\n"
          "# metersPerUnit = {unit:.6g}; contactStiffness: dP/dd in N/m, the same in any unit\n"
          "def Material \"SoftFinger\" (\n"
          "    prepend apiSchemas = [\"PhysicsMaterialAPI\", \"NewtonMaterialAPI\"]\n"
          ")\n"
          "{{\n"
          "    float physics:staticFriction = {mu:.6g}\n"
          "    float physics:dynamicFriction = {mu:.6g}\n"
          "    float newton:torsionalFriction = {spin:.6g}\n"
          "    float newton:rollingFriction = 0\n"
          "    float newton:contactStiffness = {stiffness:.4g}\n"
          "}}\n"
          "# on the fingertip's collider: rel material:binding:physics = </SoftFinger>, and for "
          "the MuJoCo solver\n"
          "# int mjc:condim = 4; for PhysX: prepend apiSchemas = [\"PhysxCollisionAPI\"] and\n"
          "# float physxCollision:minTorsionalPatchRadius = {least:.6g}\n",
          fmt::arg("origin", contact.origin), fmt::arg("unit", contact.meters_per_unit),
          fmt::arg("mu", contact.friction_coefficient), fmt::arg("spin", spin),
          fmt::arg("stiffness", contact.normal_stiffness_N_per_m), fmt::arg("least", least_radius)),
      {{"sliding_friction", contact.friction_coefficient},
       {"torsional_friction_m", contact.torque_per_load_m()},
       {"torsional_friction_stage_units", spin},
       {"min_torsional_patch_radius_stage_units", least_radius},
       {"meters_per_unit", contact.meters_per_unit},
       {"contact_stiffness_N_per_m", contact.normal_stiffness_N_per_m}}};
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = contact.face->corner_box_m();
  return {
      fmt::format(
          "# {origin}. A box in place of the pad's face, its corners at e_n = {e:.6g} m from the "
          "middle: they slip together at mu e_n P, each with a quarter of the stiffness\n"
          "# lengths are in the stage's unit, metersPerUnit = {unit:.6g}\n"
          "def Material \"SoftPad\" (\n"
          "    prepend apiSchemas = [\"PhysicsMaterialAPI\", \"NewtonMaterialAPI\"]\n"
          ")\n"
          "{{\n"
          "    float physics:staticFriction = {mu:.6g}\n"
          "    float physics:dynamicFriction = {mu:.6g}\n"
          "    float newton:torsionalFriction = 0\n"
          "    float newton:rollingFriction = 0\n"
          "    float newton:contactStiffness = {stiffness:.4g}\n"
          "}}\n"
          "def Cube \"Pad\" (prepend apiSchemas = [\"PhysicsCollisionAPI\"])\n"
          "{{\n"
          "    double size = 2\n"
          "    double3 xformOp:scale = ({x:.6g}, {y:.6g}, {z:.6g})\n"
          "    uniform token[] xformOpOrder = [\"xformOp:scale\"]\n"
          "    rel material:binding:physics = </SoftPad>\n"
          "}}\n",
          fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
          fmt::arg("e", contact.face->eccentricity_m), fmt::arg("unit", contact.meters_per_unit),
          fmt::arg("x", in_stage_units(x_m, contact)), fmt::arg("y", in_stage_units(y_m, contact)),
          fmt::arg("z", in_stage_units(contact.face->thickness_m / 2, contact)),
          fmt::arg("stiffness", contact.normal_stiffness_N_per_m / 4)),
      {{"sliding_friction", contact.friction_coefficient},
       {"torsional_friction_m", 0.0},
       {"meters_per_unit", contact.meters_per_unit},
       {"contact_stiffness_N_per_m", contact.normal_stiffness_N_per_m / 4},
       {"box_half_length_x_m", x_m},
       {"box_half_length_y_m", y_m}}};
}

}  // namespace

Simulator usd_simulator() {
  return {"usd",
          "USD",
          "no law of its own; as Newton's MuJoCo solver reads it: |f|²/mu² + torque²/(mu e_n)² <= "
          "P² with a constant e_n",
          0,
          1e-5,  // mjMINMU, through MuJoCo
          lines,
          box_lines,
          {"UsdPhysics alone has no torsional friction; newton: attributes count in Newton only, "
           "physxCollision: attributes in PhysX only (its law: --to physx)",
           "lengths are in the stage's unit: on a stage of centimetres softfinger export needs "
           "--meters-per-unit 0.01, and torsionalFriction is 100 times larger",
           "Newton 1.5 warns of a stage whose metersPerUnit is not 1 and scales nothing: give it "
           "one of metres",
           "the schema's default of torsionalFriction is not zero: a material that does not state "
           "it still has torque",
           "without mjc:condim = 4 on one of the two colliders MuJoCo's contact has no torque"},
          "Newton 1.5.0 (newton/_src/usd/schemas.py, utils/import_usd.py) and PhysX 5.8.0 "
          "(DyTGSContactPrep.cpp)",
          "It goes into newton:contactStiffness, and damping into newton:contactDamping in N s/m "
          "(for PhysX physxMaterial:compliantContactStiffness and compliantContactDamping); there "
          "is no stiffness about the normal."};
}

}  // namespace softfinger::exporting
