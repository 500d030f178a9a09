#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"

/// A physics material of Universal Scene Description: UsdPhysics' PhysicsMaterialAPI has friction
/// without torque; Newton's schema NewtonMaterialAPI adds torsionalFriction (a length, which Newton
/// hands to MuJoCo as friction[1], the largest torque per load) and contactStiffness (mass/s²).
namespace softfinger::exporting {
namespace {

Lines lines(const SoftContact& contact) {
  return {
      fmt::format(
          "# {origin}. torsionalFriction: largest torque / load = mu e_n, a length in the stage's "
          "unit, here\n"
          "# metersPerUnit = 1; contactStiffness: dP/dd in N/m\n"
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
          "the "
          "MuJoCo solver\n"
          "# int mjc:condim = 4\n",
          fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
          fmt::arg("spin", contact.torque_per_load_m()),
          fmt::arg("stiffness", contact.normal_stiffness_N_per_m)),
      {{"sliding_friction", contact.friction_coefficient},
       {"torsional_friction_m", contact.torque_per_load_m()},
       {"contact_stiffness_N_per_m", contact.normal_stiffness_N_per_m}}};
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = contact.face->corner_box_m();
  return {
      fmt::format(
          "# {origin}. A box in place of the pad's face, its corners at e_n = {e:.6g} m from the "
          "middle: they slip together at mu e_n P, each with a quarter of the stiffness\n"
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
          fmt::arg("e", contact.face->eccentricity_m), fmt::arg("x", x_m), fmt::arg("y", y_m),
          fmt::arg("z", contact.face->thickness_m / 2),
          fmt::arg("stiffness", contact.normal_stiffness_N_per_m / 4)),
      {{"sliding_friction", contact.friction_coefficient},
       {"torsional_friction_m", 0.0},
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
           "PhysX reads torsional patch radii of its own (--to physx)",
           "lengths are in the stage's unit: with metersPerUnit = 0.01 torsionalFriction is 100 "
           "times larger",
           "the schema's default of torsionalFriction is not zero: a material that does not state "
           "it still has torque",
           "without mjc:condim = 4 on one of the two colliders MuJoCo's contact has no torque"}};
}

}  // namespace softfinger::exporting
