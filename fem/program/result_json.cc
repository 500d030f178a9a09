#include "fem/program/result_json.h"

#include <optional>
#include <utility>
#include <vector>

namespace softfinger::fem {
namespace {

using nlohmann::json;

json relative(const RelativeError& error) {
  return {{"a", error.a},
          {"b", error.b},
          {"area", error.area},
          {"indentation", error.indentation},
          {"peak_pressure", error.peak_pressure},
          {"max_torque", error.max_torque},
          {"load", error.load}};
}

json profile(const Profile& values) {
  return {{"position_m", values.position_m}, {"pressure_Pa", values.pressure_Pa}};
}

json mirror_planes(MirrorPlanes planes) {
  json result = json::array();
  if (planes.x) result.push_back("x");
  if (planes.y) result.push_back("y");
  return result;
}

json points(const Eigen::Matrix2Xd& outline) {
  json result = json::array();
  for (Eigen::Index i = 0; i < outline.cols(); ++i)
    result.push_back({outline(0, i), outline(1, i)});
  return result;
}

void add_sheared(const std::optional<ShearedContact>& sheared, json& state) {
  if (!sheared) return;
  state["area_ratio"] = sheared->area_ratio;
  state["peak_pressure_ratio"] = sheared->peak_pressure_ratio;
  state["indentation_ratio"] = sheared->approach_ratio;
}

json increments(const std::vector<FrictionIncrement>& path) {
  json result = json::array();
  for (const auto& state : path) {
    result.push_back({{"shift_m", {state.shift_x_m, state.shift_y_m}},
                      {"angle_rad", state.angle_rad},
                      {"fx_N", state.wrench.force_x_N},
                      {"fy_N", state.wrench.force_y_N},
                      {"torque_Nm", state.wrench.torque_Nm},
                      {"slip_fraction", state.slip_fraction}});
    add_sheared(state.sheared, result.back());
  }
  return result;
}

/// Adds the keys of what was asked for.
void add_friction(const Problem& problem, const Result& result, json& output) {
  if (result.torsion) {
    output["torsion"] = increments(result.torsion->increments);
    output["torsion_pressing"] = name_of(result.torsion->pressing);
    output["torsional_stiffness_Nm_per_rad"] = result.torsion->stiffness_Nm_per_rad;
    output["torque_full_slip_Nm"] = result.torsion->full_slip_Nm;
    output["error"]["torsional_stiffness"] = result.torsion->stiffness_error;
    output["error"]["torque_full_slip"] = result.torsion->full_slip_error;
    output["error"]["torsion"] = result.torsion->curve_error;
  }
  if (problem.friction.limit_surface == 0) return;
  json points = json::array();
  for (const auto& point : result.limit_surface) {
    points.push_back({{"fx_N", point.wrench.force_x_N},
                      {"fy_N", point.wrench.force_y_N},
                      {"torque_Nm", point.wrench.torque_Nm}});
    add_sheared(point.sheared, points.back());
    if (!point.path.empty()) points.back()["path"] = increments(point.path);
  }
  output["limit_surface"] = std::move(points);
  output["error"]["limit_surface"] = result.limit_surface_error;
}

}  // namespace

json to_json(const Problem& problem, const Result& result) {
  const auto& finest = result.finest;
  json levels = json::array();
  for (const auto& level : result.levels)
    levels.push_back({{"level", level.level},
                      {"elements_per_semi_axis", level.elements_per_semi_axis},
                      {"unknowns", level.unknowns},
                      {"active_nodes", level.active_nodes},
                      {"iterations", level.iterations},
                      {"a_m", level.a_m},
                      {"b_m", level.b_m},
                      {"indentation_m", level.indentation_m},
                      {"peak_pressure_Pa", level.peak_pressure_Pa},
                      {"max_torque_Nm", level.max_torque_Nm},
                      {"load_residual", level.load_residual},
                      {"complementarity_residual", level.complementarity_residual},
                      {"fit_residual", level.fit_residual},
                      {"oversize", level.oversize},
                      {"wall_s", level.wall_s},
                      {"cpu_s", level.cpu_s}});
  json outlines = json::array();
  for (const Eigen::Matrix2Xd& outline : finest.outlines_m) outlines.push_back(points(outline));
  const json stick_share =
      problem.pressing == PressingFriction::none ? json() : json(finest.stick_share);
  json output = {{"model", "fem"},
                 {"load_N", finest.load_N},
                 {"a_m", finest.a_m},
                 {"b_m", finest.b_m},
                 {"axis_rad", problem.contact.radii.axis_rad + finest.turn_rad},
                 {"indentation_m", finest.indentation_m},
                 {"peak_pressure_Pa", finest.peak_pressure_Pa},
                 {"area_m2", finest.area_m2},
                 {"area_projected_m2", finest.area_projected_m2},
                 {"centre_pressure_Pa", finest.centre_pressure_Pa},
                 {"outline_m", outlines.empty() ? json::array() : outlines.front()},
                 {"ellipse_departure", finest.ellipse_departure},
                 {"kinematics", problem.finite_strain ? "finite" : "linear"},
                 {"geometry", problem.mesh        ? "mesh"
                              : problem.fingertip ? "curved"
                                                  : "flat"},
                 {"max_torque_Nm", finest.max_torque_Nm},
                 {"shear_law", problem.friction_law().name()},
                 {"max_force_N", finest.max_force_N},
                 {"eccentricity_m", finest.max_torque_Nm / finest.max_force_N},
                 {"pressing", name_of(problem.pressing)},
                 {"pressure_arm_m", finest.pressure_arm_m},
                 {"stick_share", stick_share},
                 {"error", relative(result.error)},
                 {"level", problem.level},
                 {"levels", levels},
                 {"mirror_planes", mirror_planes(result.planes)},
                 {"unknowns", finest.unknowns},
                 {"active_nodes", finest.active_nodes},
                 {"iterations", finest.iterations},
                 {"pressure_exponent", result.pressure_exponent},
                 {"profile_x", profile(result.along_x)},
                 {"profile_y", profile(result.along_y)},
                 {"vtu", result.vtu_file.empty() ? json(nullptr) : json(result.vtu_file)},
                 {"pvd", result.pvd_file.empty() ? json(nullptr) : json(result.pvd_file)},
                 {"coarse", result.interrupted},
                 {"wall_s", result.wall_s},
                 {"cpu_s", result.cpu_s},
                 {"peak_memory_MB", result.peak_memory_MB}};
  if (const auto& without = result.frictionless)
    output["frictionless"] = {{"a_m", without->a_m},
                              {"b_m", without->b_m},
                              {"indentation_m", without->indentation_m},
                              {"area_projected_m2", without->area_projected_m2},
                              {"peak_pressure_Pa", without->peak_pressure_Pa},
                              {"max_torque_Nm", without->max_torque_Nm}};
  if (problem.finite_strain) {
    output["max_torque_projected_Nm"] = finest.max_torque_projected_Nm;
    output["strain_energy_J"] = finest.strain_energy_J;
  }
  if (problem.fingertip && problem.friction.any())
    output["friction_centre_m"] = result.friction_centre_m;
  if (problem.fingertip.scan) {
    output["first_touch_m"] = result.first_touch_m;
    output["geometry_error"] =
        result.geometry_error ? relative(*result.geometry_error) : json(nullptr);
  }
  if (const auto& forces = result.forces)
    output["nodal_forces"] = {{"x_m", forces->x_m},
                              {"y_m", forces->y_m},
                              {"force_N", forces->force_N},
                              {"friction_x_N", forces->friction_x_N},
                              {"friction_y_N", forces->friction_y_N},
                              {"area_m2", forces->area_m2}};
  if (outlines.size() > 1) output["outlines_m"] = std::move(outlines);
  add_friction(problem, result, output);
  return output;
}

}  // namespace softfinger::fem
