#include "comparisons/exporting/simulators/drake.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "comparisons/exporting/simulator.h"
#include "softfinger/friction/max_torque.h"
#include "softfinger/input/constants.h"

/// Drake's hydroelastic contact (its user guide, and Elandt et al., A pressure field model, IROS
/// 2019). The pressure in a compliant body is p = E e, where the extent e grows from 0 at the
/// surface to 1 at the innermost point. For an ellipsoid e = 1 - |S^-1 x| with the semi-axes in the
/// diagonal of S, so that p = (E/c) depth near the end of the semi-axis c. Against a rigid body
/// this is an elastic foundation of stiffness E/c. Friction is Coulomb's at every point of the
/// contact: torque and limit surface follow from the pressure.
namespace softfinger::exporting {

Foundation foundation_with_eccentricity(const RelativeRadii& radii, double load_N,
                                        double eccentricity_m) {
  // e_n is proportional to sqrt(d).
  const double arm_at_unit_indentation =
      torque_arm_exact_m(std::sqrt(2 * radii.major_m), std::sqrt(2 * radii.minor_m), 1);
  return foundation_with_indentation(radii, load_N,
                                     std::pow(eccentricity_m / arm_at_unit_indentation, 2));
}

Foundation foundation_with_indentation(const RelativeRadii& radii, double load_N,
                                       double indentation_m) {
  const double d_m = indentation_m;
  Foundation foundation;
  foundation.indentation_m = d_m;
  foundation.a_m = std::sqrt(2 * d_m * radii.major_m);
  foundation.b_m = std::sqrt(2 * d_m * radii.minor_m);
  foundation.stiffness_Pa_per_m =
      load_N / (kPi * std::sqrt(radii.major_m) * std::sqrt(radii.minor_m) * d_m * d_m);
  return foundation;
}

double Foundation::eccentricity_m() const { return torque_arm_exact_m(a_m, b_m, 1); }

double Foundation::normal_stiffness_N_per_m() const {
  // P = pi stiffness sqrt(R'R'') d², and a b = 2 d sqrt(R'R'').
  return kPi * stiffness_Pa_per_m * a_m * b_m;
}

namespace {

Lines pressed_lines(const SoftContact& contact) {
  const PressedBox box = pressed_box(contact);
  const auto [x_m, y_m] = box.half_lengths_m;
  const double depth_m = std::min({contact.face->thickness_m / 2, x_m, y_m});
  const double modulus_Pa = box.stiffness_Pa_per_m * depth_m;
  return {
      fmt::format(
          "<!-- {origin}. The pressure under a flat face is uniform here, and a pad's is higher "
          "in its middle: on the pad's own face the torque would be off by {error:+.1f} %. So "
          "the box is smaller, and has the pad's e_n {e:.6g} m. Modulus: Pa, the pad's dP/dd "
          "over the box's area, {stiffness:.6g} Pa/m, times the box's depth {depth:.6g} m -->\n"
          "<geometry><box><size>{x:.6g} {y:.6g} {z:.6g}</size></box></geometry>\n"
          "<drake:proximity_properties>\n"
          "  <drake:compliant_hydroelastic/>\n"
          "  <drake:hydroelastic_modulus>{modulus:.6g}</drake:hydroelastic_modulus>\n"
          "  <drake:mu_static>{mu:.6g}</drake:mu_static>\n"
          "  <drake:mu_dynamic>{mu:.6g}</drake:mu_dynamic>\n"
          "</drake:proximity_properties>\n"
          "<!-- the object: <drake:rigid_hydroelastic/> and the same mu_static, mu_dynamic -->\n",
          fmt::arg("origin", contact.origin),
          fmt::arg("error", 100 * contact.face->error_of_pressure()),
          fmt::arg("e", contact.face->eccentricity_m),
          fmt::arg("stiffness", box.stiffness_Pa_per_m), fmt::arg("depth", depth_m),
          fmt::arg("x", 2 * x_m), fmt::arg("y", 2 * y_m), fmt::arg("z", contact.face->thickness_m),
          fmt::arg("modulus", modulus_Pa), fmt::arg("mu", contact.friction_coefficient)),
      {{"hydroelastic_modulus_Pa", modulus_Pa},
       {"foundation_stiffness_Pa_per_m", box.stiffness_Pa_per_m},
       {"depth_m", depth_m},
       {"pressed_box_half_length_x_m", x_m},
       {"pressed_box_half_length_y_m", y_m},
       {"own_face_torque_error", contact.face->error_of_pressure()},
       {"sliding_friction", contact.friction_coefficient}}};
}

/// Point contact makes one point for each pair of shapes.
Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = contact.face->corner_box_m();
  return {fmt::format(
              "<!-- {origin}. For contact_model point, which makes one point for each pair of "
              "shapes and no torque there: four small spheres that touch at (+-{x:.6g}, +-{y:.6g}) "
              "m from the pad's middle, e_n = {e:.6g} m away, in place of its face, each with -->\n"
              "<drake:proximity_properties>\n"
              "  <drake:point_contact_stiffness>{stiffness:.4g}</drake:point_contact_stiffness>\n"
              "  <drake:mu_static>{mu:.6g}</drake:mu_static>\n"
              "  <drake:mu_dynamic>{mu:.6g}</drake:mu_dynamic>\n"
              "</drake:proximity_properties>\n",
              fmt::arg("origin", contact.origin), fmt::arg("e", contact.face->eccentricity_m),
              fmt::arg("x", x_m), fmt::arg("y", y_m), fmt::arg("mu", contact.friction_coefficient),
              fmt::arg("stiffness", contact.normal_stiffness_N_per_m / 4)),
          {{"sliding_friction", contact.friction_coefficient},
           {"point_contact_stiffness_N_per_m", contact.normal_stiffness_N_per_m / 4},
           {"box_half_length_x_m", x_m},
           {"box_half_length_y_m", y_m}}};
}

Lines lines(const SoftContact& contact) {
  if (contact.face) return pressed_lines(contact);
  const Foundation foundation =
      foundation_with_eccentricity(contact.radii, contact.load_N, contact.eccentricity_m);
  // The ellipsoid has the gap's radii of curvature at the end of its z axis: its semi-axis A along
  // x follows from x²/(2R') = c x²/(2 A²).
  const double depth_m = contact.radii.minor_m;
  const double long_semi_axis_m = std::sqrt(contact.radii.major_m * depth_m);
  const double modulus_Pa = foundation.stiffness_Pa_per_m * depth_m;
  // Some eight triangles across the contact.
  const double resolution_m = foundation.b_m / 4;
  return {
      fmt::format(
          "<!-- {origin}. The ellipsoid has the gap's radii R' {major:.6g} m, R'' {minor:.6g} m "
          "at the end of its z axis. For another shape: modulus = {stiffness:.6g} Pa/m times its "
          "depth in m "
          "(sphere: radius, half space: slab thickness). Modulus: Pa, chosen for e_n {e:.6g} m, "
          "not "
          "the material's: the approach is {d:.3g} m, the model's {model_d:.3g} m, the stiffness "
          "dP/dd {k:.4g} N/m, "
          "the model's {model_k:.4g} N/m. Resolution: m, "
          "a "
          "quarter of the contact's short semi-axis -->\n"
          "<geometry><ellipsoid><radii>{a:.6g} {c:.6g} {c:.6g}</radii></ellipsoid></geometry>\n"
          "<drake:proximity_properties>\n"
          "  <drake:compliant_hydroelastic/>\n"
          "  <drake:hydroelastic_modulus>{modulus:.6g}</drake:hydroelastic_modulus>\n"
          "  <drake:mesh_resolution_hint>{resolution:.3g}</drake:mesh_resolution_hint>\n"
          "  <drake:mu_static>{mu:.6g}</drake:mu_static>\n"
          "  <drake:mu_dynamic>{mu:.6g}</drake:mu_dynamic>\n"
          "</drake:proximity_properties>\n"
          "<!-- the object: <drake:rigid_hydroelastic/> and the same mu_static, mu_dynamic -->\n",
          fmt::arg("k", foundation.normal_stiffness_N_per_m()),
          fmt::arg("model_k", contact.normal_stiffness_N_per_m),
          fmt::arg("d", foundation.indentation_m), fmt::arg("model_d", contact.indentation_m),
          fmt::arg("origin", contact.origin), fmt::arg("major", contact.radii.major_m),
          fmt::arg("minor", contact.radii.minor_m),
          fmt::arg("stiffness", foundation.stiffness_Pa_per_m),
          fmt::arg("e", contact.eccentricity_m), fmt::arg("a", long_semi_axis_m),
          fmt::arg("c", depth_m), fmt::arg("modulus", modulus_Pa),
          fmt::arg("resolution", resolution_m), fmt::arg("mu", contact.friction_coefficient)),
      {{"hydroelastic_modulus_Pa", modulus_Pa},
       {"foundation_stiffness_Pa_per_m", foundation.stiffness_Pa_per_m},
       {"depth_m", depth_m},
       {"indentation_m", foundation.indentation_m},
       {"a_m", foundation.a_m},
       {"b_m", foundation.b_m},
       {"foundation_normal_stiffness_N_per_m", foundation.normal_stiffness_N_per_m()},
       {"mesh_resolution_hint_m", resolution_m},
       {"sliding_friction", contact.friction_coefficient}}};
}

}  // namespace

Simulator drake_simulator() {
  return {"drake",
          "Drake",
          "Coulomb's law at every point of an elastic foundation: e_n grows as P^(1/4), the limit "
          "surface follows from the foundation's pressure; under a flat face the pressure is "
          "uniform and "
          "e_n constant",
          0.25,
          0,
          lines,
          box_lines,
          {"there is no torsional parameter: the modulus is chosen so that the contact has the "
           "torque; its "
           "size and approach follow from that and can differ from the layer's",
           "the pair's friction is 2 mu_0 mu_1/(mu_0 + mu_1): both bodies need the same mu",
           "where both bodies are compliant their pressures meet halfway and the contact is larger",
           "contact_model has to be hydroelastic, not point: a point contact carries no torque"},
          "Drake 1.56.0 (geometry/proximity/make_ellipsoid_field.h, "
          "multibody/plant/coulomb_friction.h)",
          "The foundation has its own, which follows from the modulus (a point contact takes "
          "point_contact_stiffness); damping is hunt_crossley_dissipation in s/m. There is no "
          "stiffness about the normal.",
          kXmlComment};
}

}  // namespace softfinger::exporting
