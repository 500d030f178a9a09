// softfinger-fem: one contact in, one JSON object out; or an array of contacts in, a line of JSON
// for each out. The format is in README.md beside this file.

#include <malloc.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <iostream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "fem/model_cache.h"
#include "fem/reference_solver.h"
#include "meshes/generation/layer_mesh.h"
#include "meshes/generation/object_surface.h"
#include "meshes/generation/pad_surface.h"
#include "meshes/io/read_surface.h"
#include "meshes/io/whole_file.h"
#include "softfinger/input/errors.h"

namespace {

using nlohmann::json;
namespace fem = softfinger::fem;
namespace meshes = softfinger::meshes;

json read(const std::string& path) {
  constexpr std::size_t most_bytes = 1'000'000'000;
  const std::string content =
      path == "-" ? std::string(std::istreambuf_iterator<char>(std::cin), {})
                  : meshes::read_whole_file(path, "problem", "a file that can be read", most_bytes);
  try {
    return json::parse(content);
  } catch (const json::parse_error& error) {
    throw softfinger::InputError(path, "problem", "", std::string("JSON (") + error.what() + ")");
  }
}

double radius(const json& value) {
  return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

Eigen::Vector3d vector(const json& value) {
  return {value.at(0).get<double>(), value.at(1).get<double>(), value.at(2).get<double>()};
}

softfinger::TriangleSurface read_mesh(const json& body) {
  return meshes::read_surface(body.at("mesh").get<std::string>(), body.at("metres_per_unit"))
      .surface;
}

meshes::SurfacePlacement placement(const json& body) {
  return {vector(body.at("point_m")), vector(body.at("outward_normal")), vector(body.at("x_axis")),
          body.value("turn_rad", 0.0)};
}

/// Bodies in the contact's frame; a body is turned by `turn_rad` about z from its own.
fem::Fingertip read_fingertip(const json& input) {
  const auto shape_of = [](const json& body) { return body.at("shape").get<std::string>(); };
  fem::Fingertip fingertip;
  {
    const json& pad = input.at("pad");
    const std::string shape = shape_of(pad);
    fingertip.pad_name = pad.dump();
    const double x = radius(pad.at("radii_m").at(0)), y = radius(pad.at("radii_m").at(1));
    const double turn_rad = pad.value("turn_rad", 0.0);
    if (shape == "paraboloid")
      fingertip.pad = meshes::paraboloid_pad(x, y, turn_rad);
    else if (shape == "ellipsoid")
      fingertip.pad = meshes::ellipsoid_pad(x, y, std::nullopt, turn_rad);
    else if (shape == "sphere")
      fingertip.pad = meshes::sphere_pad(x);
    else if (shape == "tapered" && std::abs(turn_rad) < 1e-9)
      fingertip.pad = meshes::tapered_pad(x, y, pad.value("taper_per_m", 0.0));
    else if (shape == "mesh")
      fingertip.pad = meshes::triangulated_pad(read_mesh(pad), placement(pad), x, y);
    else
      throw softfinger::InputError("fingertip.pad", "shape", shape,
                                   "paraboloid, ellipsoid, sphere, mesh, or tapered along the "
                                   "contact's long axis");
  }
  const json& object = input.at("object");
  const std::string shape = shape_of(object);
  const double x = radius(object.at("radii_m").at(0)), y = radius(object.at("radii_m").at(1));
  const double turn_rad = object.value("turn_rad", 0.0);
  fingertip.symmetric_object = shape != "mesh" && (turn_rad == 0 || x == y);
  if (shape == "paraboloid")
    fingertip.object = meshes::quadric_object(x, y, turn_rad);
  else if (shape == "sphere")
    fingertip.object = meshes::sphere_object(x);
  else if (shape == "cylinder")
    fingertip.object = meshes::cylinder_object(x, turn_rad);
  else if (shape == "mesh")
    fingertip.object = meshes::triangulated_object(read_mesh(object), placement(object));
  else
    throw softfinger::InputError("fingertip.object", "shape", shape,
                                 "paraboloid, sphere, cylinder or mesh");
  return fingertip;
}

fem::finite::MaterialChoice read_material(const json& layer) {
  namespace finite = fem::finite;
  finite::MaterialChoice choice;
  const auto refuse = [](const char* key, const std::string& value, const char* allowed) {
    throw softfinger::InputError("layer", key, value, allowed);
  };
  const std::string material = layer.value("material", "neo_hookean");
  if (material == finite::name_of(finite::MaterialName::mooney_rivlin))
    choice.name = finite::MaterialName::mooney_rivlin;
  else if (material == finite::name_of(finite::MaterialName::yeoh))
    choice.name = finite::MaterialName::yeoh;
  else if (material != finite::name_of(choice.name))
    refuse("material", material, "neo_hookean, mooney_rivlin or yeoh");
  const std::string volumetric = layer.value("volumetric", "quadratic");
  if (volumetric == finite::name_of(finite::VolumetricLaw::logarithmic))
    choice.volumetric = finite::VolumetricLaw::logarithmic;
  else if (volumetric != finite::name_of(choice.volumetric))
    refuse("volumetric", volumetric, "quadratic or logarithmic");
  choice.mooney_rivlin_share = layer.value("mooney_rivlin_share", choice.mooney_rivlin_share);
  if (layer.contains("yeoh_ratios")) {
    choice.yeoh_second = layer.at("yeoh_ratios").at(0).get<double>();
    choice.yeoh_third = layer.at("yeoh_ratios").at(1).get<double>();
  }
  return choice;
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
    if (input.value("kinematics", "linear") == "finite")
      problem.finite_strain = read_material(layer);
    std::vector<std::string> regions;
    for (const json& sublayer : layer.value("sublayers", json::array())) {
      problem.sublayers.push_back({{sublayer.at("thickness_m").get<double>(),
                                    sublayer.at("youngs_modulus_Pa").get<double>(),
                                    sublayer.at("poisson_ratio").get<double>()},
                                   read_material(sublayer)});
      regions.push_back(sublayer.value("name", ""));
    }
    if (regions.empty()) regions = {"layer"};
    if (optional(input, "approach_m")) problem.approach_m = input.at("approach_m").get<double>();
    problem.contact.load = {problem.approach_m != 0 ? 0.0 : input.at("load_N").get<double>(),
                            input.at("friction_coefficient").get<double>()};
    problem.level = input.value("level", problem.level);
    if (optional(input, "fingertip")) problem.fingertip = read_fingertip(input.at("fingertip"));
    if (optional(input, "layer_mesh")) {
      const json& mesh = input.at("layer_mesh");
      problem.mesh_name = mesh.dump();
      problem.mesh = std::make_shared<const meshes::LayerMesh>(meshes::read_layer_mesh(
          mesh.at("mesh").get<std::string>(), mesh.at("metres_per_unit").get<double>(), regions));
    }
    if (optional(input, "friction")) {
      const json& friction = input.at("friction");
      auto& request = problem.friction;
      request.torsion = friction.value("torsion", request.torsion);
      request.increments = friction.value("increments", request.increments);
      request.limit_surface = friction.value("limit_surface", request.limit_surface);
      request.increments_to_slip = friction.value("increments_to_slip", request.increments_to_slip);
      if (optional(friction, "twist_axis_m")) {
        request.twist_axis_x_m = friction.at("twist_axis_m").at(0).get<double>();
        request.twist_axis_y_m = friction.at("twist_axis_m").at(1).get<double>();
      }
    }
    if (optional(input, "compliance_file"))
      problem.compliance_file = input.at("compliance_file").get<std::string>();
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

json increments(const std::vector<fem::FrictionIncrement>& path) {
  json result = json::array();
  for (const auto& state : path)
    result.push_back({{"shift_m", {state.shift_x_m, state.shift_y_m}},
                      {"angle_rad", state.angle_rad},
                      {"fx_N", state.wrench.force_x_N},
                      {"fy_N", state.wrench.force_y_N},
                      {"torque_Nm", state.wrench.torque_Nm},
                      {"slip_fraction", state.slip_fraction}});
  return result;
}

/// Adds the keys of what was asked for.
void add_friction(const fem::Problem& problem, const fem::Result& result, json& output) {
  if (result.torsion) {
    output["torsion"] = increments(result.torsion->increments);
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
    if (!point.path.empty()) points.back()["path"] = increments(point.path);
  }
  output["limit_surface"] = std::move(points);
  output["error"]["limit_surface"] = result.limit_surface_error;
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
                      {"oversize", level.oversize},
                      {"wall_s", level.wall_s},
                      {"cpu_s", level.cpu_s}});
  json output = {
      {"model", "fem"},
      {"load_N", finest.load_N},
      {"a_m", finest.a_m},
      {"b_m", finest.b_m},
      {"axis_rad", problem.contact.radii.axis_rad + finest.turn_rad},
      {"indentation_m", finest.indentation_m},
      {"peak_pressure_Pa", finest.peak_pressure_Pa},
      {"area_m2", finest.area_m2},
      {"max_torque_Nm", finest.max_torque_Nm},
      {"eccentricity_m", finest.max_torque_Nm / (load.friction_coefficient * finest.load_N)},
      {"error",
       {{"a", result.error.a},
        {"b", result.error.b},
        {"area", result.error.area},
        {"indentation", result.error.indentation},
        {"peak_pressure", result.error.peak_pressure},
        {"max_torque", result.error.max_torque},
        {"load", result.error.load}}},
      {"level", problem.level},
      {"levels", levels},
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
  if (problem.finite_strain) {
    output["kinematics"] = "finite";
    output["max_torque_projected_Nm"] = finest.max_torque_projected_Nm;
    output["strain_energy_J"] = finest.strain_energy_J;
  }
  add_friction(problem, result, output);
  return output;
}

// A signal handler can reach nothing but a global.
volatile std::sig_atomic_t g_stop = 0;

/// The first Ctrl-C ends the work after its present stage, with what there is; the second one at
/// once.
void stop_when_convenient() {
  struct sigaction action {};
  action.sa_handler = [](int) { g_stop = 1; };
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
}

constexpr int bad_input = 2, not_converged = 3, interrupted = 128 + SIGINT;

struct Failure {
  int exit_status;
  std::string message;
};

/// Runs `work`; what it throws, as an exit status and one line.
template <class Work>
std::optional<Failure> failure_of(const Work& work) {
  const auto failure = [](int exit_status, std::string message) {
    // A library's message may run over many lines; the contract is one.
    std::replace(message.begin(), message.end(), '\n', ' ');
    return Failure{exit_status, std::move(message)};
  };
  try {
    work();
    return std::nullopt;
  } catch (const softfinger::InputError& error) {
    return failure(bad_input, std::string("error: ") + error.what());
  } catch (const softfinger::ConvergenceError& error) {
    return failure(not_converged, std::string("error: ") + error.what());
  } catch (const fem::Interrupted& error) {
    return failure(interrupted, error.what());
  } catch (const std::exception& error) {
    return failure(not_converged, std::string("error: ") + error.what());
  }
}

void answer(const json& input, const std::string& prefix, fem::ModelCache& models) {
  const fem::Problem problem = parse(input);
  const fem::Result result = fem::solve(
      problem, [&](const std::string& line) { std::cerr << prefix << line << std::endl; },
      [] { return g_stop != 0; }, &models);
  std::cout << to_json(problem, result).dump() << std::endl;
  if (!std::cout) throw softfinger::InputError("standard output", "result", "", "a place to write");
}

/// One line per problem, as it is done. A problem that fails does not end the run.
int answer_all(const json& inputs) {
  // A single problem has no use for what it would leave behind.
  fem::ModelCache models(inputs.size() > 1 ? 2 : 0);
  int exit_status = 0;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const json& input = inputs[i];
    const bool is_named =
        input.is_object() && input.contains("name") && input.at("name").is_string();
    const std::string name = is_named ? input.at("name").get<std::string>() : "problem";
    const std::string prefix =
        "fem: " + std::to_string(i + 1) + "/" + std::to_string(inputs.size()) + ": ";
    const auto failure = failure_of([&] { answer(input, prefix, models); });
    if (!failure) continue;
    exit_status = std::max(exit_status, failure->exit_status);
    if (failure->exit_status == interrupted) break;
    std::cout << json({{"name", name},
                       {"failure", failure->message},
                       {"exit_status", failure->exit_status}})
                     .dump()
              << std::endl;
  }
  return exit_status;
}

}  // namespace

int main(int argument_count, char** arguments) {
  // Dense matrices of tens of megabytes come and go: kept by the process, their pages are not
  // zeroed by the system each time.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  if (argument_count != 2) {
    std::cerr << "usage: softfinger-fem PROBLEM.json (or - for standard input)\n";
    return bad_input;
  }
  int exit_status = 0;
  const auto failure = failure_of([&] {
    const json input = read(arguments[1]);
    stop_when_convenient();
    if (input.is_array()) {
      exit_status = answer_all(input);
    } else {
      fem::ModelCache nothing_to_share(0);
      answer(input, "fem: ", nothing_to_share);
    }
  });
  if (!failure) return exit_status;
  std::cerr << "softfinger-fem: " << failure->message << std::endl;
  return failure->exit_status;
}
