// softfinger-fem: one contact in, one JSON object out. The format is in README.md beside this file.

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "fem/reference_solver.h"
#include "softfinger/input/errors.h"

namespace {

using nlohmann::json;
namespace fem = softfinger::fem;

json read(const std::string& path) {
  std::ifstream file;
  if (path != "-") file.open(path);
  std::istream& input = path == "-" ? std::cin : file;
  const std::string content(std::istreambuf_iterator<char>(input), {});
  if (path != "-" && !file.is_open())
    throw softfinger::InputError(path, "problem", "", "a file that can be read");
  try {
    return json::parse(content);
  } catch (const json::parse_error& error) {
    throw softfinger::InputError(path, "problem", "", std::string("JSON (") + error.what() + ")");
  }
}

fem::Problem parse(const json& input) {
  const auto optional = [](const json& object, const char* key) {
    return object.contains(key) && !object.at(key).is_null();
  };
  try {
    fem::Problem problem;
    problem.name = input.value("name", problem.name);
    problem.contact.radii = {input.at("radii_m").at(0).get<double>(),
                             input.at("radii_m").at(1).get<double>(), input.value("axis_rad", 0.0)};
    if (optional(input, "sphere_radius_m"))
      problem.sphere_radius_m = input.at("sphere_radius_m").get<double>();
    const json& layer = input.at("layer");
    problem.contact.layer = {layer.at("thickness_m").get<double>(),
                             layer.at("youngs_modulus_Pa").get<double>(),
                             layer.at("poisson_ratio").get<double>()};
    problem.contact.load = {input.at("load_N").get<double>(),
                            input.at("friction_coefficient").get<double>()};
    problem.level = input.value("level", problem.level);
    if (optional(input, "output_directory"))
      problem.output_directory = input.at("output_directory").get<std::string>();
    return problem;
  } catch (const json::exception& error) {
    throw softfinger::InputError("problem", "key", "",
                                 std::string("the keys in fem/README.md (") + error.what() + ")");
  }
}

json profile(const fem::Profile& values) {
  return {{"position_m", values.position_m}, {"pressure_Pa", values.pressure_Pa}};
}

json to_json(const fem::Problem& problem, const fem::Result& result) {
  const auto& finest = result.finest;
  const auto& load = problem.contact.load;
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
                      {"wall_s", level.wall_s}});
  return {
      {"model", "fem"},
      {"load_N", load.normal_force_N},
      {"a_m", finest.a_m},
      {"b_m", finest.b_m},
      {"axis_rad", problem.contact.radii.axis_rad},
      {"indentation_m", finest.indentation_m},
      {"peak_pressure_Pa", finest.peak_pressure_Pa},
      {"area_m2", M_PI * finest.a_m * finest.b_m},
      {"max_torque_Nm", finest.max_torque_Nm},
      {"eccentricity_m", finest.max_torque_Nm / (load.friction_coefficient * load.normal_force_N)},
      {"error",
       {{"a", result.error.a},
        {"b", result.error.b},
        {"area", result.error.area},
        {"indentation", result.error.indentation},
        {"peak_pressure", result.error.peak_pressure},
        {"max_torque", result.error.max_torque}}},
      {"level", problem.level},
      {"levels", levels},
      {"unknowns", finest.unknowns},
      {"active_nodes", finest.active_nodes},
      {"iterations", finest.iterations},
      {"pressure_exponent", result.pressure_exponent},
      {"profile_x", profile(result.along_x)},
      {"profile_y", profile(result.along_y)},
      {"vtu", result.vtu_file.empty() ? json(nullptr) : json(result.vtu_file)},
      {"wall_s", result.wall_s},
      {"peak_memory_MB", result.peak_memory_MB}};
}

}  // namespace

int main(int argument_count, char** arguments) {
  constexpr int bad_input = 2, not_converged = 3;
  if (argument_count != 2) {
    std::cerr << "usage: softfinger-fem PROBLEM.json (or - for standard input)\n";
    return bad_input;
  }
  try {
    const fem::Problem problem = parse(read(arguments[1]));
    const fem::Result result = fem::solve(
        problem, [](const std::string& line) { std::cerr << "fem: " << line << std::endl; });
    std::cout << to_json(problem, result).dump() << std::endl;
    return std::cout ? 0 : bad_input;
  } catch (const softfinger::InputError& error) {
    std::cerr << "softfinger-fem: error: " << error.what() << std::endl;
    return bad_input;
  } catch (const softfinger::ConvergenceError& error) {
    std::cerr << "softfinger-fem: error: " << error.what() << std::endl;
    return not_converged;
  } catch (const std::exception& error) {
    // A library's message may run over many lines; the contract is one.
    std::string message = error.what();
    std::replace(message.begin(), message.end(), '\n', ' ');
    std::cerr << "softfinger-fem: error: " << message << std::endl;
    return not_converged;
  }
}
