#include "fem/levels/stated_result.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "fem/base/formatted.h"
#include "fem/layer/element_limits.h"
#include "meshes/generation/object_surface.h"

namespace softfinger::fem {
namespace {

/// Pressure along x or y, from the nodes on that axis of the block.
Profile profile_of(const std::vector<PressurePoint>& nodes, const ElasticLayer& layer,
                   bool along_x) {
  constexpr double on_axis = 1e-9;
  std::vector<std::pair<double, double>> points;
  for (const PressurePoint& node : nodes)
    if (std::abs(along_x ? node.block_y : node.block_x) <= on_axis)
      points.emplace_back(layer.thickness_m * (along_x ? node.x : node.y),
                          layer.youngs_modulus_Pa * node.pressure);
  std::sort(points.begin(), points.end());
  Profile profile;
  for (const auto& [position_m, pressure_Pa] : points) {
    profile.position_m.push_back(position_m);
    profile.pressure_Pa.push_back(pressure_Pa);
  }
  return profile;
}

ErrorSetting error_setting(const SolvedLevels& levels, const ContactTask& task) {
  const Pressing& pressing = task.pressing;
  ErrorSetting setting;
  setting.thickness_m = pressing.thickness_m;
  setting.layered = !pressing.interfaces.empty();
  setting.is_scan = pressing.bent.is_scan;
  setting.fitted = levels.fine().fitted;
  setting.approach_given = task.problem.approach_m > 0;
  setting.wall = levels.wall;
  setting.in_time = task.problem.in_time.has_value();
  setting.rubbed = task.problem.pressing != PressingFriction::none;
  setting.coupling = pressing.coupling();
  setting.rounded_edges =
      task.problem.finite_strain && pressing.fingertip && pressing.fingertip.object->faceted();
  return setting;
}

/// The difference between the layer's Poisson's ratio and that of its elements, the largest of its
/// sublayers'.
double compressed_by_elements(const ContactTask& task) {
  if (!task.problem.finite_strain || !task.problem.has_friction()) return 0;
  double result = 0;
  for (const ElasticConstants& of : task.pressing.materials())
    result = std::max(result, of.poisson_ratio - largest_rubbed_poisson_ratio);
  return result;
}

void state_errors(const SolvedLevels& levels, const ScanErrors& scan, const ErrorTable& table,
                  const ContactTask& task, Result& result) {
  result.error =
      error_of_contact(table, levels.coarse(), levels.fine(), error_setting(levels, task));
  const RelativeError compressing =
      error_of_compressing(levels.fine(), task.pressing.thickness_m, compressed_by_elements(task));
  for (const auto quantity : relative_errors)
    result.error.*quantity += scan.core.*quantity + compressing.*quantity;
  if (levels.friction.size() < 2) return;
  state_friction(levels.friction.front(), levels.friction.back(),
                 refinement_of(levels.coarse(), levels.fine()), task.problem, result);
  if (result.torsion)
    result.torsion->stiffness_error +=
        stuck_edge_error(table, levels.fine().elements_per_semi_axis, task.pressing.planes().both(),
                         task.problem.mesh == nullptr, levels.misfit);
}

NodalForces forces_of(const std::vector<PressurePoint>& nodes, const Result& result,
                      const ContactTask& task) {
  const double h = task.pressing.thickness_m;
  const double unit_of_force_N = task.problem.contact.layer.youngs_modulus_Pa * h * h;
  const Eigen::Matrix2d to_axes = Eigen::Rotation2Dd(-result.finest.turn_rad).toRotationMatrix();
  // The pressure's centre lies on the mirror planes.
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double sum = 0;
  for (const PressurePoint& node : nodes) {
    centre += node.force * node.place;
    sum += node.force;
  }
  centre = result.planes.middle(centre / sum);
  NodalForces forces;
  for (const PressurePoint& node : nodes) {
    if (!(node.force > 0)) continue;
    const Eigen::Vector2d from_centre = node.place - centre;
    for (const double x_sign : {1., -1.})
      for (const double y_sign : {1., -1.}) {
        if ((x_sign < 0 && !result.planes.x) || (y_sign < 0 && !result.planes.y)) continue;
        const Eigen::Vector2d at =
            to_axes * Eigen::Vector2d(x_sign * from_centre.x(), y_sign * from_centre.y());
        forces.x_m.push_back(h * at.x());
        forces.y_m.push_back(h * at.y());
        forces.force_N.push_back(unit_of_force_N * node.force);
        const Eigen::Vector2d friction =
            unit_of_force_N *
            (to_axes * Eigen::Vector2d(x_sign * node.friction.x(), y_sign * node.friction.y()));
        forces.friction_x_N.push_back(friction.x());
        forces.friction_y_N.push_back(friction.y());
        forces.area_m2.push_back(h * h * node.area);
      }
  }
  return forces;
}

void describe(ContactPhysics& physics, const ContactTask& task, Result& result) {
  result.planes = task.pressing.planes();
  for (std::size_t c = 0; c < 3; ++c)
    result.first_touch_m[c] =
        task.pressing.thickness_m * task.pressing.bent.first_touch[static_cast<Eigen::Index>(c)];
  const Eigen::Vector2d centre_m = task.pressing.thickness_m * task.pressing.bent.centre;
  result.friction_centre_m = {centre_m.x(), centre_m.y()};
  for (Eigen::Matrix2Xd& outline : result.finest.outlines_m) outline.colwise() += centre_m;
  const LevelResult& finest = result.finest;
  result.pressure_exponent = finest.area_projected_m2 * finest.peak_pressure_Pa / finest.load_N - 1;
  const std::vector<PressurePoint> pressures = physics.pressures();
  result.along_x = profile_of(pressures, task.problem.contact.layer, true);
  result.along_y = profile_of(pressures, task.problem.contact.layer, false);
  if (task.problem.lists_forces) result.forces = forces_of(pressures, result, task);
  const OutputFiles files = physics.write_files();
  result.vtu_file = files.vtu;
  result.pvd_file = files.pvd;
}

}  // namespace

bool meshes_serve(const SolvedLevels& levels, const ErrorTable& table, const ContactTask& task) {
  // Over time a mesh is as large as the largest contact was, which the stated error knows.
  if (crossed_cells(levels.fine()) == 0 || task.problem.in_time) return true;
  LayerDiscretisation own;
  own.a = levels.fine().a_m / task.pressing.thickness_m;
  own.b = levels.fine().b_m / task.pressing.thickness_m;
  choose_elements(own, levels.fine().level);
  const RelativeError error =
      error_of_levels(table, levels.coarse(), levels.fine(), error_setting(levels, task));
  const bool useful = is_useful(error, own.elements_per_semi_axis);
  if (!useful) task.progress(formatted("a to %.2g %% only: meshes of its own", 100 * error.a));
  return useful;
}

Result stated_result(SolvedLevels levels, const ScanErrors& scan, ContactPhysics& physics,
                     const ContactTask& task) {
  Result result;
  result.finest = levels.fine();
  result.wall = levels.wall;
  result.geometry_error = scan.geometry;
  result.interrupted = levels.interrupted;
  state_errors(levels, scan, physics.error_table(), task, result);
  result.frictionless = levels.frictionless;
  result.levels = std::move(levels.results);
  describe(physics, task, result);
  return result;
}

}  // namespace softfinger::fem
