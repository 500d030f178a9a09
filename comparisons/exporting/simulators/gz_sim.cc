#include <fmt/format.h>

#include <cmath>

#include "comparisons/exporting/friction_pyramid.h"
#include "comparisons/exporting/simulator.h"

/// Gazebo Sim (gz-sim) with the plugins of gz-physics, whose SDFFeatures read of
/// <surface><friction>:
/// - dartsim, the default: <ode> mu, mu2, slip and fdir1. DART has no torsional friction; its
///   sliding friction is a pyramid.
/// - bullet-featherstone: <bullet> friction, friction2 and rolling_friction; <torsional>
///   <coefficient> becomes Bullet's spinning friction, a length. A collision that states none has
///   1 m, hundreds of times a fingertip's. Bullet's rule for pairs is that of bullet.cc. The plugin
///   sets the numbers twice, as the body's friction and as the scale of Bullet's friction
///   directions x and y: against an object of friction 1 a body of friction f slides at f² P. So f
///   = sqrt(mu).
/// - bullet (for tests): <ode> mu and mu2.
/// - mujoco, from gz-physics 10 on: nothing. All geoms have MuJoCo's defaults, mu = 1 and condim 3,
///   which has no torque.
namespace softfinger::exporting {
namespace {

/// @param torque_per_load_m  of each contact point, in Bullet alone
std::string surface(const SoftContact& contact, double torque_per_load_m) {
  return fmt::format(
      "<surface>\n"
      "  <friction>\n"
      "    <ode><mu>{mu:.6g}</mu><mu2>{mu:.6g}</mu2></ode>\n"
      "    <bullet><friction>{root:.6g}</friction><friction2>{root:.6g}</friction2></bullet>\n"
      "    <torsional><coefficient>{spin:.6g}</coefficient></torsional>\n"
      "  </friction>\n"
      "</surface>\n"
      "<!-- the object: <ode> mu and mu2 {mu:.6g} or more, <bullet> friction and friction2 1, "
      "<torsional><coefficient>0</coefficient></torsional> -->\n",
      fmt::arg("mu", contact.friction_coefficient),
      fmt::arg("root", std::sqrt(contact.friction_coefficient)),
      fmt::arg("spin", torque_per_load_m));
}

Lines lines(const SoftContact& contact) {
  const PyramidTorque torque = three_points_in_pyramids();
  const double radius_m = contact.eccentricity_m / torque.middle();
  return {
      fmt::format(
          "<!-- {origin}. torsional coefficient: m, largest torque / load = mu e_n, in "
          "bullet-featherstone alone. With dartsim, the default, and with mujoco a point has no "
          "torque; what can be done there: three small spheres in place of one, at the distance "
          "{radius:.6g} m from the contact's centre: sharing the load their friction has the "
          "torque mu e_n P, e_n = {e:.6g} m, within {worst:.3g} % whatever the directions of "
          "DART's friction pyramid -->\n"
          "{surface}",
          fmt::arg("origin", contact.origin), fmt::arg("e", contact.eccentricity_m),
          fmt::arg("radius", radius_m), fmt::arg("worst", 100 * torque.worst_error()),
          fmt::arg("surface", surface(contact, contact.torque_per_load_m()))),
      {{"sliding_friction", contact.friction_coefficient},
       {"bullet_sliding_friction", std::sqrt(contact.friction_coefficient)},
       {"bullet_spinning_friction_m", contact.torque_per_load_m()},
       {"bullet_object_sliding_friction", 1.0},
       {"bullet_object_spinning_friction_m", 0.0},
       {"three_points_radius_m", radius_m}}};
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = face_in_pyramids(*contact.face).corner_box_m();
  const auto [cone_x_m, cone_y_m] = contact.face->corner_box_m();
  return {
      fmt::format("<!-- {origin}. A box in place of the pad's face: friction at its corners has "
                  "the torque mu e_n P, e_n = {e:.6g} m, within {worst:.3g} % whatever the "
                  "directions of DART's friction pyramid. Bullet's friction is a cone: with "
                  "bullet-featherstone the size is {cone_x:.6g} {cone_y:.6g} {z:.6g} -->\n"
                  "<geometry><box><size>{x:.6g} {y:.6g} {z:.6g}</size></box></geometry>\n{surface}",
                  fmt::arg("origin", contact.origin), fmt::arg("e", contact.face->eccentricity_m),
                  fmt::arg("worst", 100 * corners_in_pyramids(*contact.face).worst_error()),
                  fmt::arg("cone_x", 2 * cone_x_m), fmt::arg("cone_y", 2 * cone_y_m),
                  fmt::arg("surface", surface(contact, 0)), fmt::arg("x", 2 * x_m),
                  fmt::arg("y", 2 * y_m), fmt::arg("z", contact.face->thickness_m)),
      {{"sliding_friction", contact.friction_coefficient},
       {"box_half_length_x_m", x_m},
       {"box_half_length_y_m", y_m},
       {"bullet_box_half_length_x_m", cone_x_m},
       {"bullet_box_half_length_y_m", cone_y_m}}};
}

}  // namespace

Simulator gz_sim_simulator() {
  Simulator simulator = {
      "gz-sim",
      "Gazebo Sim",
      "dartsim (the default): |f_x|, |f_y| <= mu P, no torque about the normal; mujoco: |f| <= P, "
      "none either; "
      "bullet-featherstone: apart from |f|, |torque| <= mu e_n P",
      0,
      0,
      lines,
      box_lines,
      {"dartsim (the default) reads <ode> mu, mu2, slip and fdir1 and ignores <torsional>, "
       "<bullet>, kp and kd",
       "dartsim's friction is a pyramid along two directions that DART chooses: up to 1.41 mu P "
       "between them, and three points at a distance r slip at 1.08 to 1.12 mu r P",
       "bullet-featherstone takes <torsional><coefficient> as a length, 1 m where none is stated: "
       "an object that states none holds any torque; it ignores <ode> and patch_radius, and has "
       "one "
       "friction for all collisions of a link",
       "bullet-featherstone multiplies <bullet> friction by itself (a body of friction 0.5 slides "
       "at "
       "0.25 P), so the lines have the root of mu; this is so along the link's x and y axes, and "
       "the contact's normal has to be its z axis",
       "mujoco reads no friction from SDF: mu is 1 and a point has no torque",
       "three contact points resist tilting, too, which a soft fingertip does far less; on a "
       "curved object they do not touch together, and with bullet-featherstone their torques would "
       "need a coefficient of 0",
       "Gazebo Classic is --to gazebo"},
      "gz-physics 10.0.0-pre1 (dartsim/src/SDFFeatures.cc, SimulationFeatures.cc; "
      "bullet-featherstone/src/SDFFeatures.cc, since 7.1.0; mujoco/src/SDFFeatures.cc); "
      "bullet-featherstone's numbers were measured in Bullet 3.24, dartsim's in DART 6.12",
      "The plugins read none from SDF: dartsim ignores kp and kd, bullet-featherstone sets its own "
      "for meshes, mujoco keeps MuJoCo's defaults.",
      kXmlComment};
  simulator.friction_is_pyramid = true;
  simulator.has_torque = false;
  return simulator;
}

}  // namespace softfinger::exporting
