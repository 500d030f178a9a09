#include <fmt/format.h>

#include "comparisons/exporting/friction_pyramid.h"
#include "comparisons/exporting/simulator.h"

/// The Open Dynamics Engine (ode/src/joints/contact.cpp). A contact joint with dContactRolling has
/// rows of torque about the two tangents (rho, rho2) and about the normal (rhoN). With
/// dContactApprox1_N the last one's limit is rhoN times the normal force, so that rhoN is a length,
/// mu e_n. rhoN counts only with dContactAxisDep, which is also dContactMu2: mu2 has to be set.
///
/// Webots hands the third number of ContactProperties' rollingFriction to the same row.
namespace softfinger::exporting {
namespace {

Lines lines(const SoftContact& contact) {
  return {
      fmt::format("// {origin}. rhoN: m, largest torque / load = mu e_n. contact is a dContact\n"
                  "contact.surface.mode = dContactApprox1 | dContactAxisDep | dContactRolling;\n"
                  "contact.surface.mu = contact.surface.mu2 = {mu:.6g};\n"
                  "contact.surface.rho = contact.surface.rho2 = 0;\n"
                  "contact.surface.rhoN = {spin:.6g};\n",
                  fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
                  fmt::arg("spin", contact.torque_per_load_m())),
      {{"sliding_friction", contact.friction_coefficient},
       {"spinning_friction_m", contact.torque_per_load_m()},
       {"rolling_friction_m", 0.0}}};
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = face_in_pyramids(*contact.face).corner_box_m();
  return {
      fmt::format(
          "// {origin}. A box in place of the pad's face: friction at its corners has the "
          "torque mu e_n P, e_n = {e:.6g} m, within {worst:.3g} % whatever the directions of "
          "ODE's friction pyramid\n"
          "dGeomID pad = dCreateBox(space, {x:.6g}, {y:.6g}, {z:.6g});\n"
          "contact.surface.mode = dContactApprox1;  // of every contact of the pad\n"
          "contact.surface.mu = {mu:.6g};\n",
          fmt::arg("origin", contact.origin), fmt::arg("e", contact.face->eccentricity_m),
          fmt::arg("worst", 100 * corners_in_pyramids(*contact.face).worst_error()),
          fmt::arg("x", 2 * x_m), fmt::arg("y", 2 * y_m), fmt::arg("z", contact.face->thickness_m),
          fmt::arg("mu", contact.friction_coefficient)),
      {{"sliding_friction", contact.friction_coefficient},
       {"box_half_length_x_m", x_m},
       {"box_half_length_y_m", y_m}}};
}

}  // namespace

Simulator ode_simulator() {
  Simulator simulator = {
      "ode",
      "ODE",
      "|f_x|, |f_y| <= mu P and, apart from them, |torque| <= mu e_n P with a constant e_n",
      0,
      0,
      lines,
      box_lines,
      {"without dContactApprox1_N (a part of dContactApprox1) rhoN is a torque in N m, whatever "
       "the load",
       "without dContactAxisDep rhoN is not read: rho then holds rolling and spinning alike",
       "dContactAxisDep and dContactMu2 are one bit: mu2 has to be set, too",
       "the sliding friction is a pyramid along two directions that ODE chooses: up to 1.41 mu P "
       "between them",
       "force and torque have separate limits: at 0.6 mu P the torque is 25 % above the ellipsoid; "
       "each contact point adds a torque of its own",
       "Webots hands rollingFriction 0 0 mu_e_n to the same row, with dContactAxisDep, but sets "
       "mu2 only where coulombFriction has two values or more, which it takes on boxes, planes and "
       "cylinders (read in WbSimulationCluster.cpp, not run)"},
      "ODE 0.16.2 (ode/src/joints/contact.cpp), and measured there",
      "With the time step t and the damping c of each contact point: dContactSoftERP | "
      "dContactSoftCFM, soft_erp = t k/(t k + c), soft_cfm = 1/(t k + c), k = {k} N/m. There is no "
      "stiffness about the normal.",
      kCppComment};
  simulator.friction_is_pyramid = true;
  return simulator;
}

}  // namespace softfinger::exporting
