#include <fmt/format.h>

#include <cmath>

#include "comparisons/exporting/simulator.h"

/// Genesis's rigid solver, torsional friction from version 1.3 on. friction_torsional is a length,
/// the largest torque per load, and is read only with RigidOptions.enable_torsional_friction. Three
/// laws: the elliptic cone with the convex resolution is the friction ellipsoid, as MuJoCo's; with
/// the signorini resolution, the default of that cone, force and torque have separate limits; the
/// pyramid allows |f_x|/mu + |f_y|/mu + |torque|/(mu e_n) <= P. The ellipsoid is chosen here. For a
/// pair the larger of each coefficient counts, and sliding friction is at least 0.01.
///
/// A contact at rest pushes with P = k D² d/((1 - D) w): d is the penetration, D the impedance
/// (dmin = dmax here), k = 1/(timeconst² dampratio² D²), and w the sum of the two links' inverse
/// weights. It is thus a spring of 1/(timeconst² dampratio² (1 - D) w).
namespace softfinger::exporting {
namespace {

constexpr double kImpedance = 0.95;

/// The time constant that gives dP/dd where 1/w is 1 kg; it grows as the root of that mass.
double time_constant_at_one_kg_s(double stiffness_N_per_m) {
  return 1 / std::sqrt(stiffness_N_per_m * (1 - kImpedance));
}

std::string options_and_stiffness(double stiffness_N_per_m, bool torsional) {
  return fmt::format(
      "options = gs.options.RigidOptions(enable_torsional_friction={torsional}, "
      "friction_cone=gs.friction_cone.elliptic, contact_resolution=gs.contact_resolution.convex)\n"
      "mass_kg = 0.1  # 1 / (the sum of both links' inverse weights): the lighter body's\n"
      "for geom in [*fingertip.geoms, *touched.geoms]:  # a pair takes the mean of both; dP/dd is "
      "{k:.6g} N/m here\n"
      "    geom.set_sol_params([{time:.6g} * mass_kg ** 0.5, 1.0, {impedance}, {impedance}, 0.001, "
      "0.5, 2.0])\n",
      fmt::arg("torsional", torsional ? "True" : "False"), fmt::arg("k", stiffness_N_per_m),
      fmt::arg("time", time_constant_at_one_kg_s(stiffness_N_per_m)),
      fmt::arg("impedance", kImpedance));
}

Lines lines(const SoftContact& contact) {
  const double spin_m = contact.torque_per_load_m();
  return {fmt::format(
              "# {origin}. friction_torsional: m, largest torque / load = mu e_n\n"
              "soft_finger = gs.materials.Rigid(friction={mu:.6g}, friction_torsional={spin:.6g}, "
              "friction_rolling=0.0)\n"
              "touched_material = gs.materials.Rigid(friction={mu:.6g}, friction_torsional=0.0, "
              "friction_rolling=0.0)\n"
              "{options}",
              fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
              fmt::arg("spin", spin_m),
              fmt::arg("options", options_and_stiffness(contact.normal_stiffness_N_per_m, true))),
          {{"sliding_friction", contact.friction_coefficient},
           {"torsional_friction_m", spin_m},
           {"object_torsional_friction_m", 0.0},
           {"time_constant_at_1_kg_s", time_constant_at_one_kg_s(contact.normal_stiffness_N_per_m)},
           {"impedance", kImpedance}}};
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = contact.face->corner_box_m();
  const double stiffness_N_per_m = contact.normal_stiffness_N_per_m / 4;
  return {
      fmt::format(
          "# {origin}. A box in place of the pad's face, its corners at e_n = {e:.6g} m from the "
          "middle: they slip together at mu e_n P, each with a quarter of the stiffness\n"
          "pad = gs.morphs.Box(size=({x:.6g}, {y:.6g}, {z:.6g}))\n"
          "soft_pad = gs.materials.Rigid(friction={mu:.6g}, friction_torsional=0.0, "
          "friction_rolling=0.0)\n"
          "touched_material = soft_pad\n"
          "{options}",
          fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
          fmt::arg("e", contact.face->eccentricity_m), fmt::arg("x", 2 * x_m),
          fmt::arg("y", 2 * y_m), fmt::arg("z", contact.face->thickness_m),
          fmt::arg("options", options_and_stiffness(stiffness_N_per_m, false))),
      {{"sliding_friction", contact.friction_coefficient},
       {"torsional_friction_m", 0.0},
       {"time_constant_at_1_kg_s", time_constant_at_one_kg_s(stiffness_N_per_m)},
       {"impedance", kImpedance},
       {"box_half_length_x_m", x_m},
       {"box_half_length_y_m", y_m}}};
}

}  // namespace

Simulator genesis_simulator() {
  return {
      "genesis",
      "Genesis",
      "|f|²/mu² + torque²/(mu e_n)² <= P², the friction ellipsoid with a constant e_n, by the "
      "elliptic cone and the convex resolution",
      0,
      0,
      lines,
      box_lines,
      {"torsional friction exists from Genesis 1.3 on (contact_resolution from 1.3.1), and only "
       "with "
       "enable_torsional_friction; "
       "friction_torsional is the largest torque per newton of load (mu e_n, not e_n)",
       "of the two geoms the larger value counts, and a geom that states none has 0.005 m, often "
       "more than a fingertip: the touched object needs friction_torsional=0.0",
       "the default cone is a pyramid, which allows less combined force and torque; the elliptic "
       "cone's own default, contact_resolution signorini, has separate limits for force and torque",
       "the convex resolution lets fast sliding raise the normal force; the elliptic cone does not "
       "work with noslip_iterations",
       "friction has to lie within 0.01 and 5; several contact points of one pair add their "
       "torques",
       "the spring cannot be stiffer than a time constant of two substeps: some mass/(4 step² "
       "0.05)"},
      "Genesis 1.4 (genesis/engine/solvers/rigid/constraint/solver.py, collider/contact.py, "
      "genesis/engine/materials/rigid.py, genesis/options/solvers.py)",
      "It is divided by masses, so the time constant follows mass_kg; the damping ratio is 1 "
      "there. Genesis has no stiffness about the normal: stuck friction creeps."};
}

}  // namespace softfinger::exporting
