#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"
#include "comparisons/exporting/simulators/patch_friction.h"

/// Isaac Lab, whose physics is PhysX or Newton. Fragments of a physics material and of collision
/// properties write USD attributes, each in the namespace of one engine: PhysxMaterialCfg writes
/// physxMaterial:compliantContactStiffness (N/m) and compliantContactDamping (N s/m),
/// PhysxCollisionCfg physxCollision:minTorsionalPatchRadius (m), NewtonMaterialCfg
/// newton:torsionalFriction. The last is documented as a ratio and is a length all the same: Newton
/// hands it to MuJoCo as the largest torque per load. Both engines then have the same mu e_n.
///
/// PhysX takes the compliant material's stiffness where the other one is rigid. The contact is a
/// linear spring of dP/dd, so that its penetration is P/(dP/dd), and not the model's indentation.
namespace softfinger::exporting {
namespace {

Lines lines(const SoftContact& contact) {
  const PatchRadii radii = patch_radii(contact);
  return {
      fmt::format(
          "# {origin}. min_torsional_patch_radius: m, e_n = largest torque / (mu load); "
          "compliant_contact_stiffness: N/m, dP/dd there\n"
          "mass_kg = 0.1  # of the lighter body: 2 sqrt(stiffness mass) is critical damping\n"
          "friction = UsdPhysicsRigidBodyMaterialCfg(static_friction={mu:.6g}, "
          "dynamic_friction={mu:.6g}, restitution=0.0)\n"
          "physics_material = [friction, PhysxMaterialCfg(friction_combine_mode=\"min\", "
          "compliant_contact_stiffness={k:.6g}, compliant_contact_damping=2 * ({k:.6g} * mass_kg) "
          "** 0.5)]\n"
          "collision_props = [UsdPhysicsCollisionCfg(), "
          "PhysxCollisionCfg(torsional_patch_radius={radius:.6g}, "
          "min_torsional_patch_radius={least:.6g})]\n"
          "physics = PhysxCfg(friction_correlation_distance={correlation:.6g})  # of "
          "SimulationCfg: "
          "m, without it a compliant contact has no torque\n"
          "# Isaac Lab 2: RigidBodyMaterialCfg, CollisionPropertiesCfg and SimulationCfg's physx "
          "have "
          "these fields\n"
          "# With Newton in place of PhysX, torsional_friction: m, largest torque / load = mu e_n\n"
          "# physics_material = [friction, NewtonMaterialCfg(torsional_friction={spin:.6g}, "
          "rolling_friction=0.0, contact_stiffness={k:.6g}, contact_damping=2 * ({k:.6g} * "
          "mass_kg) "
          "** 0.5)]\n"
          "# collision_props = [UsdPhysicsCollisionCfg(), MujocoCollisionCfg(condim=4)]\n",
          fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
          fmt::arg("k", contact.normal_stiffness_N_per_m), fmt::arg("radius", radii.radius_m),
          fmt::arg("least", radii.min_radius_m), fmt::arg("spin", contact.torque_per_load_m()),
          fmt::arg("correlation", kCorrelationDistance_m)),
      {{"sliding_friction", contact.friction_coefficient},
       {"compliant_contact_stiffness_N_per_m", contact.normal_stiffness_N_per_m},
       {"min_torsional_patch_radius_m", radii.min_radius_m},
       {"torsional_patch_radius_m", radii.radius_m},
       {"friction_correlation_distance_m", kCorrelationDistance_m},
       {"newton_torsional_friction_m", contact.torque_per_load_m()}}};
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = contact.face->corner_box_m();
  const double stiffness_N_per_m = contact.normal_stiffness_N_per_m / 4;
  return {
      fmt::format(
          "# {origin}. A box in place of the pad's face, its corners at e_n = {e:.6g} m from the "
          "middle: they slip together at mu e_n P, each with a quarter of the stiffness\n"
          "mass_kg = 0.1  # of the lighter body: 2 sqrt(stiffness mass) is critical damping\n"
          "friction = UsdPhysicsRigidBodyMaterialCfg(static_friction={mu:.6g}, "
          "dynamic_friction={mu:.6g}, restitution=0.0)\n"
          "pad = CuboidCfg(size=({x:.6g}, {y:.6g}, {z:.6g}), physics_material=[friction, "
          "PhysxMaterialCfg(friction_combine_mode=\"min\", compliant_contact_stiffness={k:.6g}, "
          "compliant_contact_damping=({k:.6g} * mass_kg) ** 0.5)],\n"
          "                collision_props=[UsdPhysicsCollisionCfg()])\n",
          fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
          fmt::arg("e", contact.face->eccentricity_m), fmt::arg("x", 2 * x_m),
          fmt::arg("y", 2 * y_m), fmt::arg("z", contact.face->thickness_m),
          fmt::arg("k", stiffness_N_per_m)),
      {{"sliding_friction", contact.friction_coefficient},
       {"compliant_contact_stiffness_N_per_m", stiffness_N_per_m},
       {"box_half_length_x_m", x_m},
       {"box_half_length_y_m", y_m}}};
}

}  // namespace

Simulator isaac_lab_simulator() {
  return {
      "isaac",
      "Isaac Lab",
      "with PhysX |f| <= mu P and, apart from it, |torque| <= mu e_n P; with Newton's MuJoCo "
      "solver |f|²/mu² + torque²/(mu e_n)² <= P²; in both e_n is constant",
      0,
      0,
      lines,
      box_lines,
      {kTorsionNeedsTgs, kRadiusIsEccentricity, kSecondAnchor, kSeparateLimits,
       "with a compliant contact torsional_patch_radius would let e_n grow as P^(1/2), faster "
       "than a layer's: it is 0 here",
       "NewtonMaterialCfg calls torsional_friction dimensionless, but its MuJoCo solver reads a "
       "length; without MujocoCollisionCfg(condim=4) it has no effect",
       "physxMaterial attributes and torsional radii count in PhysX only; of the two shapes' "
       "radii the larger counts, of compliant materials the pair's combine mode decides"},
      "Isaac Lab 3.0 (isaaclab_physx and isaaclab_newton: sim/schemas/schemas_cfg.py, "
      "sim/spawners/materials/physics_materials_cfg.py) with PhysX 5.8.0 "
      "(DyTGSContactPrep.cpp, DyFrictionCorrelation.cpp) and Newton 1.5.0 (solver_mujoco.py); "
      "PhysX's part was measured in 5.6.1",
      "PhysX takes it as compliant_contact_stiffness, {k} N/m for each contact point; neither "
      "engine has a stiffness about the normal.",
      kPythonComment,
      "isaac-lab"};
}

}  // namespace softfinger::exporting
