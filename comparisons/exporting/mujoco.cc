#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"

/// MuJoCo's manual, "Computation", on friction cones: an elliptic cone with coefficients mu_i holds
/// while sum f_i²/mu_i² <= N². With condim 4 the components are two forces and the torque about the
/// normal, whose coefficient therefore is a length: max torque / P = mu e_n. This is the friction
/// ellipsoid (1) itself. "Modelling", on contact parameters: of two geoms the larger condim and,
/// element by element, the larger friction count, unless one has the higher priority.
namespace softfinger::exporting {
namespace {

Lines lines(const SoftContact& contact) {
  const double spin_m = contact.torque_per_load_m();
  return {
      fmt::format(
          "<!-- {origin}. friction: sliding mu {mu:.6g}; spinning {spin:.6g} m = largest torque "
          "/ load = mu e_n; rolling, idle with condim 4 -->\n"
          "<option cone=\"elliptic\" impratio=\"10\" noslip_iterations=\"5\"/>\n"
          "<default>\n"
          "  <default class=\"soft_finger\">\n"
          "    <geom condim=\"4\" priority=\"1\" friction=\"{mu:.6g} {spin:.6g} 0.0001\"/>\n"
          "  </default>\n"
          "</default>\n"
          "<!-- then, on the fingertip's geom: class=\"soft_finger\" -->\n",
          fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
          fmt::arg("spin", spin_m)),
      {{"sliding_friction", contact.friction_coefficient}, {"spinning_friction_m", spin_m}}};
}

}  // namespace

Simulator mujoco() {
  return {
      "mujoco",
      "MuJoCo",
      "|f|²/mu² + torque²/(mu e_n)² <= P², the friction ellipsoid with a constant e_n",
      0,
      1e-5,  // mjMINMU: smaller coefficients are raised to it
      lines,
      {"friction[1] is a length, the largest torque per newton of load (mu e_n, not e_n); below "
       "1e-5 m it is raised to 1e-5 m",
       "without priority the larger friction of the two geoms counts, element by element, and "
       "a geom's default \"1 0.005 0.0001\" is often the larger one",
       "the default cone is pyramidal, a smaller limit for combined force and torque; condim 3 "
       "has no torque",
       "without noslip_iterations friction holds by creeping: turning at the sliding creep's "
       "rate divided by e_n, some (mu P/mass)(0.5 ms/impratio)/e_n with the default solref and "
       "solimp: radians per second for grams and newtons",
       "several contact points of one pair add up their torques"}};
}

}  // namespace softfinger::exporting
