#include <fmt/format.h>

#include "comparisons/exporting/friction_pyramid.h"
#include "comparisons/exporting/simulator.h"
#include "softfinger/input/constants.h"

/// Gazebo Classic with ODE (tutorial "Torsional friction", ODE's contact joint). The torque about
/// the normal is at most (3 pi/16) a mu_t N, that of a circular Hertz contact of radius a. A patch
/// radius of a = 16 e_n/(3 pi) therefore gives any e_n. ODEPhysics takes the smaller coefficients
/// and the larger patch_radius of the two surfaces, and a patch radius only if both ask for one
/// (the default). The sliding friction is ODE's pyramid.
namespace softfinger::exporting {
namespace {

Lines lines(const SoftContact& contact) {
  const double radius_m = 16 / (3 * kPi) * contact.eccentricity_m;
  return {fmt::format("<!-- {origin}. mu and coefficient: sliding friction; patch_radius: m, 16 "
                      "e_n/(3 pi), of the round Hertz "
                      "contact with e_n = {e:.6g} m -->\n"
                      "<surface>\n"
                      "  <friction>\n"
                      "    <ode><mu>{mu:.6g}</mu><mu2>{mu:.6g}</mu2></ode>\n"
                      "    <torsional>\n"
                      "      <coefficient>{mu:.6g}</coefficient>\n"
                      "      <use_patch_radius>true</use_patch_radius>\n"
                      "      <patch_radius>{radius:.6g}</patch_radius>\n"
                      "    </torsional>\n"
                      "  </friction>\n"
                      "</surface>\n",
                      fmt::arg("origin", contact.origin), fmt::arg("e", contact.eccentricity_m),
                      fmt::arg("mu", contact.friction_coefficient), fmt::arg("radius", radius_m)),
          {{"sliding_friction", contact.friction_coefficient},
           {"torsional_coefficient", contact.friction_coefficient},
           {"patch_radius_m", radius_m}}};
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = face_in_pyramids(*contact.face).corner_box_m();
  return {fmt::format(
              "<!-- {origin}. A box in place of the pad's face: friction at its corners has the "
              "torque mu e_n P, e_n = {e:.6g} m, within {worst:.3g} % whatever the directions of "
              "ODE's friction pyramid, without torsional friction -->\n"
              "<geometry><box><size>{x:.6g} {y:.6g} {z:.6g}</size></box></geometry>\n"
              "<surface>\n"
              "  <friction>\n"
              "    <ode><mu>{mu:.6g}</mu><mu2>{mu:.6g}</mu2></ode>\n"
              "    <torsional><coefficient>0</coefficient></torsional>\n"
              "  </friction>\n"
              "</surface>\n",
              fmt::arg("origin", contact.origin), fmt::arg("e", contact.face->eccentricity_m),
              fmt::arg("worst", 100 * corners_in_pyramids(*contact.face).worst_error()),
              fmt::arg("mu", contact.friction_coefficient), fmt::arg("x", 2 * x_m),
              fmt::arg("y", 2 * y_m), fmt::arg("z", contact.face->thickness_m)),
          {{"sliding_friction", contact.friction_coefficient},
           {"torsional_coefficient", 0.0},
           {"box_half_length_x_m", x_m},
           {"box_half_length_y_m", y_m}}};
}

}  // namespace

Simulator gazebo_simulator() {
  Simulator simulator = {
      "gazebo",
      "Gazebo",
      "|f_x|, |f_y| <= mu P and, apart from them, |torque| <= (3 pi/16) a mu P with a constant a",
      0,
      0,
      lines,
      box_lines,
      {"only Gazebo Classic with ODE reads patch_radius; other engines ignore it, or take the "
       "coefficient as something else",
       "the smaller mu and coefficient of the two surfaces count (default 1): where mu > 1 the "
       "object needs it too; of the two values of patch_radius the larger counts",
       "with use_patch_radius false the radius is sqrt(surface_radius depth) with the solver's "
       "penetration depth, which is not an elastic indentation",
       "the sliding friction is a pyramid along two directions that ODE chooses: up to 1.41 mu P "
       "between them",
       "force and torque have separate limits: at 0.6 mu P the torque is 25 % above the ellipsoid; "
       "each contact point adds a torque of its own"},
      "Gazebo Classic 11 (gazebo/physics/ode/ODEPhysics.cc, deps/opende/src/joints/contact.cpp)",
      "It goes into <contact><ode><kp> of the surface, {k} N/m for each contact point; its damping "
      "is "
      "the sum of both surfaces' kd. There is no stiffness about the normal.",
      kXmlComment};
  simulator.friction_is_pyramid = true;
  return simulator;
}

}  // namespace softfinger::exporting
