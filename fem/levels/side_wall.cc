#include "fem/levels/side_wall.h"

#include <algorithm>

#include "fem/base/formatted.h"
#include "fem/levels/mesh_size.h"

namespace softfinger::fem {

bool wall_is_near(const LayerDiscretisation& mesh) {
  return mesh.is_scan || std::min(mesh.reach_x - mesh.a, mesh.reach_y - mesh.b) < mesh.extent;
}

Outcome<WallChange, Obstacle> measure_wall(const ContactTask& task, LayerDiscretisation mesh,
                                           const LevelResult& free,
                                           const ContactPhysics::PressOther& press) {
  mesh.clamped_wall = true;
  const auto pressed = press(task, mesh);
  if (!pressed) return pressed.reason();
  ContactPhysics& physics = **pressed;
  Outcome<Measurement, Unmeasured> measurement = physics.measure();
  if (!measurement && measurement.reason().outgrew_patch) {
    mesh.patch *= growth_at_rim;
    if (const auto obstacle = physics.press(mesh, 0)) return *obstacle;
    measurement = physics.measure();
    if (!measurement && measurement.reason().outgrew_patch)
      if (const auto folded = physics.end_beside()) return Obstacle(*folded);
  }
  if (!measurement) throw measurement.reason().error;
  const LevelResult& clamped = measurement->result;
  const auto half = [&](double LevelResult::*quantity) {
    return (clamped.*quantity / free.*quantity - 1) / 2;
  };
  // The arm of the pressure is a length of the contact, and one that no fit blurs.
  const double load = half(&LevelResult::load_N), length = half(&LevelResult::torque_arm_m);
  const WallChange wall{length,
                        length,
                        2 * length,
                        half(&LevelResult::indentation_m),
                        load - 2 * length,
                        half(&LevelResult::max_torque_Nm),
                        load,
                        half(&LevelResult::max_force_N)};
  task.progress(
      formatted("side wall: clamped it would change the contact's size by %.2g, d by "
                "%.2g, load by %.2g %%; half of that is taken",
                200 * length, 200 * wall.indentation, 200 * load));
  return wall;
}

void correct_wall(const WallChange& wall, LevelResult& level) {
  level.a_m *= 1 + wall.a;
  level.b_m *= 1 + wall.b;
  level.area_projected_m2 *= 1 + wall.area;
  level.area_m2 *= 1 + wall.area;
  level.indentation_m *= 1 + wall.indentation;
  level.peak_pressure_Pa *= 1 + wall.peak_pressure;
  level.centre_pressure_Pa *= 1 + wall.peak_pressure;
  level.max_torque_Nm *= 1 + wall.max_torque;
  level.max_force_N *= 1 + wall.max_force;
  level.torque_arm_m *= 1 + wall.a;
  level.pressure_arm_m *= 1 + wall.a;
  level.max_torque_projected_Nm *= 1 + wall.max_torque;
  level.load_N *= 1 + wall.load;
}

}  // namespace softfinger::fem
