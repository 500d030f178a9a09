#include "fem/program/pad_json.h"

namespace softfinger::fem {
namespace {

using nlohmann::json;

/// A limit of 0 says that there is tension without any tilt: there is none then.
json limit(const std::array<double, 2>& limit) {
  if (!(limit[0] > 0 && limit[1] > 0)) return nullptr;
  return limit;
}

json quantities(const PadProblem& problem, const PadLevel& level) {
  json result = {{"indentation_m", level.indentation_m},
                 {"normal_stiffness_N_per_m", level.normal_stiffness_N_per_m},
                 {"peak_pressure_inside_Pa", level.peak_pressure_Pa},
                 {"pressure_arm_m", level.pressure_arm_m},
                 {"eccentricity_m", level.eccentricity_m},
                 {"max_torque_Nm", level.max_torque_Nm},
                 {"tilt_stiffness_Nm_per_rad", level.tilt_stiffness_Nm_per_rad},
                 {"tilt_limit_Nm", limit(level.tilt_limit_Nm)},
                 {"torsional_stiffness_Nm_per_rad", level.torsional_stiffness_Nm_per_rad},
                 {"shear_stiffness_N_per_m", level.shear_stiffness_N_per_m},
                 {"shear_moment_Nm_per_m", level.shear_moment_Nm_per_m}};
  if (problem.pressing == PadPressing::stuck) {
    result["tilt_stiffness_free_to_slide_Nm_per_rad"] = level.free_tilt_stiffness_Nm_per_rad;
    result["tilt_limit_free_to_slide_Nm"] = limit(level.free_tilt_limit_Nm);
  }
  return result;
}

json error_of(const PadProblem& problem, const PadLevel& level, const PadError& error) {
  json result = {{"indentation", error.indentation},
                 {"normal_stiffness", error.normal_stiffness},
                 {"peak_pressure_inside", error.peak_pressure},
                 {"pressure_arm", error.pressure_arm},
                 {"eccentricity", error.eccentricity},
                 {"max_torque", error.max_torque},
                 {"tilt_stiffness", error.tilt_stiffness},
                 {"torsional_stiffness", error.torsional_stiffness},
                 {"shear_stiffness", error.shear_stiffness}};
  result["tilt_limit"] =
      limit(level.tilt_limit_Nm).is_null() ? json(nullptr) : json(error.tilt_limit);
  if (problem.pressing == PadPressing::stuck) {
    result["tilt_stiffness_free_to_slide"] = error.free_tilt_stiffness;
    result["tilt_limit_free_to_slide"] =
        limit(level.free_tilt_limit_Nm).is_null() ? json(nullptr) : json(error.free_tilt_limit);
  }
  return result;
}

}  // namespace

json to_json(const PadProblem& problem, const PadResult& result) {
  json output = quantities(problem, result.finest);
  output["model"] = "fem";
  output["geometry"] = "pad";
  output["name"] = problem.name;
  output["kinematics"] = "linear";
  output["pressing"] = problem.pressing == PadPressing::stuck ? "stuck" : "frictionless";
  output["load_N"] = problem.load_N;
  output["load_point_m"] = result.load_point_m;
  output["stiffness_centre_m"] = result.stiffness_centre_m;
  output["centre_of_pressure_m"] = result.centre_of_pressure_m;
  output["tilt_rad"] = result.tilt_rad;
  output["area_m2"] = result.finest.area_m2;
  if (problem.object) output["contact_half_lengths_m"] = result.finest.contact_half_lengths_m;
  output["uniform_arm_m"] = result.uniform_arm_m;
  output["lifted_share"] = result.lifted_share;
  output["pressure"] = {{"x_m", result.pressure.x_m},
                        {"y_m", result.pressure.y_m},
                        {"pressure_Pa", result.pressure.pressure_Pa},
                        {"weight_m2", result.pressure.weight_m2}};
  if (problem.limit_surface > 0) {
    json points = json::array();
    for (const Wrench& wrench : result.limit_surface)
      points.push_back({{"fx_N", wrench.force_x_N},
                        {"fy_N", wrench.force_y_N},
                        {"torque_Nm", wrench.torque_Nm}});
    output["limit_surface"] = std::move(points);
  }
  output["error"] = error_of(problem, result.finest, result.error);
  output["level"] = result.finest.level;
  json levels = json::array();
  for (const PadLevel& level : result.levels) {
    json of_level = quantities(problem, level);
    of_level["level"] = level.level;
    of_level["cells_across"] = level.cells_across;
    of_level["cells_deep"] = level.cells_deep;
    of_level["unknowns"] = level.unknowns;
    of_level["cpu_s"] = level.cpu_s;
    levels.push_back(std::move(of_level));
  }
  output["levels"] = std::move(levels);
  json planes = json::array();
  if (result.planes.x) planes.push_back("x");
  if (result.planes.y) planes.push_back("y");
  output["mirror_planes"] = std::move(planes);
  output["unknowns"] = result.finest.unknowns;
  output["face_nodes"] = result.finest.face_nodes;
  output["wall_s"] = result.wall_s;
  output["cpu_s"] = result.cpu_s;
  output["peak_memory_MB"] = result.peak_memory_MB;
  return output;
}

}  // namespace softfinger::fem
