#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"

/// Gazebo Sim (gz-sim) with gz-physics. Its engines' SDFFeatures read of <surface><friction>:
/// dartsim <ode> mu, mu2, slip and fdir1; bullet-featherstone <bullet> friction, friction2 and
/// rolling_friction. Neither reads <torsional>, and bullet-featherstone sets no spinning friction.
/// So a contact point has no torque about the normal, in either engine.
namespace softfinger::exporting {
namespace {

std::string surface(const SoftContact& contact) {
  return fmt::format(
      "<surface>\n"
      "  <friction>\n"
      "    <ode><mu>{mu:.6g}</mu><mu2>{mu:.6g}</mu2></ode>\n"
      "    <bullet><friction>{mu:.6g}</friction><friction2>{mu:.6g}</friction2></bullet>\n"
      "  </friction>\n"
      "</surface>\n",
      fmt::arg("mu", contact.friction_coefficient));
}

Lines lines(const SoftContact& contact) {
  return {
      fmt::format(
          "<!-- {origin}. Sliding friction only: no engine of gz-sim has torsional friction. What "
          "can be done: three small spheres at the distance e_n = {e:.6g} m from the contact's "
          "centre, in place of one; sharing the load they slip at mu e_n P -->\n"
          "{surface}",
          fmt::arg("origin", contact.origin), fmt::arg("e", contact.eccentricity_m),
          fmt::arg("surface", surface(contact))),
      {{"sliding_friction", contact.friction_coefficient},
       {"three_points_radius_m", contact.eccentricity_m}}};
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = contact.face->corner_box_m();
  return {
      fmt::format("<!-- {origin}. A box in place of the pad's face, its corners at e_n = {e:.6g} m "
                  "from the middle: they slip together at mu e_n P -->\n"
                  "<geometry><box><size>{x:.6g} {y:.6g} {z:.6g}</size></box></geometry>\n{surface}",
                  fmt::arg("origin", contact.origin), fmt::arg("e", contact.face->eccentricity_m),
                  fmt::arg("surface", surface(contact)), fmt::arg("x", 2 * x_m),
                  fmt::arg("y", 2 * y_m), fmt::arg("z", contact.face->thickness_m)),
      {{"sliding_friction", contact.friction_coefficient},
       {"box_half_length_x_m", x_m},
       {"box_half_length_y_m", y_m}}};
}

}  // namespace

Simulator gz_sim_simulator() {
  Simulator simulator = {
      "gz-sim",
      "Gazebo Sim",
      "|f| <= mu P; no torque about the normal",
      0,
      0,
      lines,
      box_lines,
      {"dartsim (the default) reads <ode> mu, mu2, slip and fdir1 and ignores <torsional>, "
       "<bullet>, kp and kd",
       "bullet-featherstone reads <bullet> friction, friction2 and rolling_friction and ignores "
       "<ode> and <torsional>; it has one friction for all collisions of a link",
       "three contact points resist tilting, too, which a soft fingertip does far less; on a "
       "curved object they do not touch together",
       "Gazebo Classic is --to gazebo"}};
  simulator.has_torque = false;
  return simulator;
}

}  // namespace softfinger::exporting
