#include <fmt/format.h>

#include "comparisons/exporting/mujoco_friction.h"
#include "comparisons/exporting/simulator.h"

/// MuJoCo's manual, "Computation", on friction cones: an elliptic cone with coefficients mu_i
/// sticks while sum f_i²/mu_i² <= N². With condim 4 the f_i are two forces and the torque about the
/// normal. The coefficient of the torque is a length, max torque / P = mu e_n, and the cone is the
/// friction ellipsoid (1) of Ciocarlie et al. 2007. "Modelling", on contact parameters: the larger
/// condim of the two geoms counts, and for each element the larger friction, unless one geom has
/// the higher priority.
namespace softfinger::exporting {
namespace {

Lines lines(const SoftContact& contact) {
  const double spin_m = contact.torque_per_load_m();
  return {
      fmt::format(
          "<!-- {origin}. friction: sliding mu {mu:.6g}; spinning {spin:.6g} m = largest torque "
          "/ load = mu e_n; rolling, unused with condim 4 -->\n"
          "<option cone=\"elliptic\" impratio=\"10\" noslip_iterations=\"5\"/>\n"
          "<default>\n"
          "  <default class=\"soft_finger\">\n"
          "    <geom condim=\"4\" priority=\"1\" {friction}/>\n"
          "  </default>\n"
          "</default>\n"
          "<!-- then, on the fingertip's geom: class=\"soft_finger\" -->\n",
          fmt::arg("friction", mujoco_friction(contact.friction_coefficient, spin_m)),
          fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
          fmt::arg("spin", spin_m)),
      {{"sliding_friction", contact.friction_coefficient}, {"spinning_friction_m", spin_m}}};
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = contact.face->corner_box_m();
  return {
      fmt::format(
          "<!-- {origin}. A box of half lengths {x:.6g} x {y:.6g} m in place of the pad's face: "
          "its corners lie at e_n = {e:.6g} m from the middle, and slip together at mu e_n P -->\n"
          "<option cone=\"elliptic\" impratio=\"10\" noslip_iterations=\"5\"/>\n"
          "<default>\n"
          "  <default class=\"soft_pad\">\n"
          "    <geom type=\"box\" size=\"{x:.6g} {y:.6g} {z:.6g}\" condim=\"3\" priority=\"1\" "
          "{friction}/>\n"
          "  </default>\n"
          "</default>\n"
          "<!-- then, on the pad's geom, its z axis along the normal: class=\"soft_pad\" -->\n",
          fmt::arg("friction", mujoco_friction(contact.friction_coefficient, 0)),
          fmt::arg("origin", contact.origin), fmt::arg("e", contact.face->eccentricity_m),
          fmt::arg("x", x_m), fmt::arg("y", y_m), fmt::arg("z", contact.face->thickness_m / 2)),
      {{"sliding_friction", contact.friction_coefficient},
       {"box_half_length_x_m", x_m},
       {"box_half_length_y_m", y_m}}};
}

}  // namespace

Simulator mujoco_simulator() {
  return {
      "mujoco",
      "MuJoCo",
      "|f|²/mu² + torque²/(mu e_n)² <= P², the friction ellipsoid with a constant e_n",
      0,
      1e-5,  // mjMINMU: smaller coefficients are raised to it
      lines,
      box_lines,
      {"friction[1] is a length, the largest torque per newton of load (mu e_n, not e_n); below "
       "1e-5 m it is raised to 1e-5 m",
       "without priority the larger friction of the two geoms counts, for each of the three "
       "numbers, "
       "and a geom's default \"1 0.005 0.0001\" is often the larger one",
       "the default cone is pyramidal, which allows less combined force and torque; condim 3 "
       "has no torque about the normal",
       "without noslip_iterations a sticking contact creeps: with the default solref and solimp it "
       "turns at about (mu P/mass)(0.5 ms/impratio)/e_n, radians per second for masses of grams "
       "and loads of newtons",
       "noslip_iterations does nothing where bodies can only move along the contact's normal and "
       "turn about it (a slide and a hinge): give one of them a joint across the normal, however "
       "stiff",
       "the default solref and solimp are soft: a capsule of 45 g that two pads pinch with 36 N "
       "sinks "
       "in by 6 mm and is lost, with noslip_iterations too; where no stiffness is wanted, "
       "solref=\"0.004 1\" (two time steps) and solimp=\"0.99 0.999 0.001\" hold it "
       "(docs/measurements/creep.md)",
       "the torques of several contact points of one pair add up",
       "solref and solimp are divided by masses: softfinger apply --effective-mass-g finds those "
       "that "
       "give dP/dd; softfinger apply --plugin lets the torque follow the load"},
      "MuJoCo 3.12.0 (src/engine/engine_core_constraint.c, engine_collision_driver.c), and "
      "measured in 2.2.2 and 3.14.0",
      "It is divided by masses: the attributes solref and solimp of both geoms hold it for one "
      "effective mass. MuJoCo has no stiffness about the normal: stuck friction creeps.",
      kXmlComment};
}

}  // namespace softfinger::exporting
