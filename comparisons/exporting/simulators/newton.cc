#include <fmt/format.h>

#include "comparisons/exporting/simulator.h"
#include "comparisons/exporting/simulators/drake.h"
#include "softfinger/input/constants.h"

/// Newton (newton-physics), ModelBuilder.ShapeConfig. mu_torsional is a length; SolverMuJoCo hands
/// it to MuJoCo as friction[1], the largest torque per load, and its condim (custom attribute
/// mujoco.condim) is 3 unless set. ke is a normal stiffness in N/m. Hydroelastic shapes have the
/// pressure kh depth, with kh in N/m³: an elastic foundation, as Drake's.
///
/// A foundation has one number, and its contact a² = 2 R d. kh can thus be chosen for the torque,
/// by foundation_with_eccentricity, or for the approach, kh = P/(pi R d²), R = sqrt(R'R''); a
/// bonded layer has another relation of a and d.
namespace softfinger::exporting {
namespace {

Lines point_lines(const SoftContact& contact) {
  return {
      fmt::format("# {origin}. mu_torsional: m, largest torque / load = mu e_n; ke: N/m, dP/dd "
                  "there\n"
                  "cfg = newton.ModelBuilder.ShapeConfig(mu={mu:.6g}, mu_torsional={spin:.6g}, "
                  "mu_rolling=0.0, ke={ke:.4g})\n"
                  "# SolverMuJoCo: mujoco.condim = 4 on the fingertip, cone=\"elliptic\"\n",
                  fmt::arg("origin", contact.origin), fmt::arg("mu", contact.friction_coefficient),
                  fmt::arg("spin", contact.torque_per_load_m()),
                  fmt::arg("ke", contact.normal_stiffness_N_per_m)),
      {{"sliding_friction", contact.friction_coefficient},
       {"torsional_friction_m", contact.torque_per_load_m()},
       {"contact_stiffness_N_per_m", contact.normal_stiffness_N_per_m}}};
}

/// Both ways to have a pad's torque, as lines.
Lines face_lines(const SoftContact& contact) {
  Lines made = point_lines(contact);
  const PressedBox box = pressed_box(contact);
  const auto [x_m, y_m] = box.half_lengths_m;
  made.text += fmt::format(
      "# Or hydroelastic, pressure = kh depth, in place of mu_torsional and ke. Under a flat face "
      "it "
      "is uniform,\n"
      "# and a pad's is higher in its middle: on the pad's own face the torque is off by "
      "{error:+.1f} %, this box has it:\n"
      "# cfg = newton.ModelBuilder.ShapeConfig(mu={mu:.6g}, is_hydroelastic=True, kh={kh:.6g})\n"
      "# builder.add_shape_box(finger, hx={x:.6g}, hy={y:.6g}, hz={z:.6g}, cfg=cfg)\n",
      fmt::arg("error", 100 * contact.face->error_of_pressure()),
      fmt::arg("mu", contact.friction_coefficient), fmt::arg("kh", box.stiffness_Pa_per_m),
      fmt::arg("x", x_m), fmt::arg("y", y_m), fmt::arg("z", contact.face->thickness_m / 2));
  made.values.insert(made.values.end(),
                     {{"kh_N_per_m3", box.stiffness_Pa_per_m},
                      {"pressed_box_half_length_x_m", x_m},
                      {"pressed_box_half_length_y_m", y_m},
                      {"own_face_torque_error", contact.face->error_of_pressure()}});
  return made;
}

Lines box_lines(const SoftContact& contact) {
  const auto [x_m, y_m] = contact.face->corner_box_m();
  return {
      fmt::format("# {origin}. A box in place of the pad's face, its corners at e_n = {e:.6g} m "
                  "from the middle: they slip together at mu e_n P, each with a quarter of ke\n"
                  "cfg = newton.ModelBuilder.ShapeConfig(mu={mu:.6g}, mu_torsional=0.0, "
                  "mu_rolling=0.0, ke={ke:.4g})\n"
                  "builder.add_shape_box(finger, hx={x:.6g}, hy={y:.6g}, hz={z:.6g}, cfg=cfg)\n",
                  fmt::arg("origin", contact.origin), fmt::arg("e", contact.face->eccentricity_m),
                  fmt::arg("mu", contact.friction_coefficient),
                  fmt::arg("ke", contact.normal_stiffness_N_per_m / 4), fmt::arg("x", x_m),
                  fmt::arg("y", y_m), fmt::arg("z", contact.face->thickness_m / 2)),
      {{"sliding_friction", contact.friction_coefficient},
       {"torsional_friction_m", 0.0},
       {"contact_stiffness_N_per_m", contact.normal_stiffness_N_per_m / 4},
       {"box_half_length_x_m", x_m},
       {"box_half_length_y_m", y_m}}};
}

Lines lines(const SoftContact& contact) {
  if (contact.face) return face_lines(contact);
  Lines made = point_lines(contact);
  const Foundation torque =
      foundation_with_eccentricity(contact.radii, contact.load_N, contact.eccentricity_m);
  const Foundation approach =
      foundation_with_indentation(contact.radii, contact.load_N, contact.indentation_m);
  made.text += fmt::format(
      "# Or hydroelastic, pressure = kh depth, in place of mu_torsional and ke. A patch with\n"
      "# a^2 = 2 R d has the torque (and the area) or the force at the approach, not both:\n"
      "#   kh={kh:.4g}: e_n {e:.4g} m, the approach is {d:.3g} m, the layer's {model_d:.3g} m\n"
      "#   kh={kh_d:.4g}: approach {model_d:.3g} m, e_n is {e_d:.4g} m, {error:+.0f} %\n"
      "# cfg = newton.ModelBuilder.ShapeConfig(mu={mu:.6g}, is_hydroelastic=True, kh={kh:.6g})\n",
      fmt::arg("mu", contact.friction_coefficient), fmt::arg("kh", torque.stiffness_Pa_per_m),
      fmt::arg("e", contact.eccentricity_m), fmt::arg("d", torque.indentation_m),
      fmt::arg("model_d", contact.indentation_m), fmt::arg("kh_d", approach.stiffness_Pa_per_m),
      fmt::arg("e_d", approach.eccentricity_m()),
      fmt::arg("error", 100 * (approach.eccentricity_m() / contact.eccentricity_m - 1)));
  made.values.insert(made.values.end(),
                     {{"kh_for_torque_N_per_m3", torque.stiffness_Pa_per_m},
                      {"kh_for_torque_indentation_m", torque.indentation_m},
                      {"kh_for_indentation_N_per_m3", approach.stiffness_Pa_per_m},
                      {"kh_for_indentation_eccentricity_m", approach.eccentricity_m()}});
  return made;
}

}  // namespace

Simulator newton_simulator() {
  return {
      "newton",
      "Newton",
      "with SolverMuJoCo MuJoCo's: |f|²/mu² + torque²/(mu e_n)² <= P² with a constant e_n; "
      "hydroelastic: Coulomb's law on an elastic foundation, e_n grows as P^(1/4), under a flat "
      "face not at all",
      0,
      1e-5,  // mjMINMU, through MuJoCo
      lines,
      box_lines,
      {"mu_torsional is a length, mu e_n; of two shapes SolverMuJoCo takes the larger one, "
       "SolverXPBD the mean, apart from the sliding limit, and SolverVBD none",
       "condim is 3 unless mujoco.condim says 4: torsional friction then has no effect",
       "hydroelastic contact needs is_hydroelastic on both shapes, whose kh act in series: the "
       "object's has to be far larger, or both twice as large",
       "SolverMuJoCo takes ke and kd per unit of mass: they are N/m and N s/m only where both "
       "shapes' mujoco.solref_mode is its force-space mode, on its GPU path with Newton's own "
       "contacts; it may scale kh likewise",
       "planes and height fields are never hydroelastic"},
      "Newton 1.5.0 (newton/_src/solvers/mujoco/kernels.py, solver_mujoco.py, "
      "solvers/xpbd/kernels.py)",
      "It goes into ke, and damping into kd in N s/m; Newton has no stiffness about the normal."};
}

}  // namespace softfinger::exporting
