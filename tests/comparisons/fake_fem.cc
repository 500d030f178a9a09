// Stands in for softfinger-fem in tests. Answers with half-space Hertz numbers at once; the
// environment asks for other behaviour: FAKE_FEM_LOG=file appends a line "name load pid" per load;
// FAKE_FEM_LINGER_N=load sleeps a minute at that load; FAKE_FEM_EXIT=status fails; FAKE_FEM_CRASH_N
// =load dies by a signal at that load; FAKE_FEM_CRASH_FINER=1 on each level beyond 2;
// FAKE_FEM_HOARD_N=load takes 200 MB and sleeps a minute at that load; FAKE_FEM_ERROR=rel states
// that error on level 2, and half of it on the next finer one; FAKE_FEM_SLOW_S=s sleeps so long at
// each load; FAKE_FEM_UNREAD_SCAN=1 leaves open what a scan's facets do.

#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace {

std::string option(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// Uniform pressure on a disc of the pad's shorter side or diameter.
nlohmann::json answer_of_pad(const nlohmann::json& problem) {
  const nlohmann::json &pad = problem["pad"], &outline = pad["outline"];
  const double load_N = problem["load_N"], mu = problem["friction_coefficient"];
  const double radius_m = outline["shape"] == "disc"
                              ? outline["radius_m"].get<double>()
                              : outline.value("lengths_m", std::vector<double>{0.01})[0] / 2;
  const double pi = 3.14159265358979323846, area_m2 = pi * radius_m * radius_m;
  const double per_m = pad["youngs_modulus_Pa"].get<double>() / pad["thickness_m"].get<double>();
  const double error =
      std::stod(option("FAKE_FEM_ERROR").empty() ? "1e-3" : option("FAKE_FEM_ERROR"));
  const double tilt = per_m * pi * std::pow(radius_m, 4) / 4, arm_m = 2 * radius_m / 3;
  nlohmann::json stated, level = {{"level", problem["level"]}, {"unknowns", 1000}};
  for (const char* name :
       {"indentation", "normal_stiffness", "peak_pressure_inside", "pressure_arm", "max_torque"})
    stated[name] = error;
  for (const char* name : {"tilt_stiffness", "tilt_stiffness_free_to_slide"})
    stated[name] = {error, error};
  return {{"model", "fem"},
          {"geometry", "pad"},
          {"pressing", problem["pressing"]},
          {"load_N", load_N},
          {"indentation_m", load_N / (per_m * area_m2)},
          {"normal_stiffness_N_per_m", per_m * area_m2},
          {"area_m2", area_m2},
          {"peak_pressure_inside_Pa", load_N / area_m2},
          {"pressure_arm_m", arm_m},
          {"eccentricity_m", arm_m},
          {"max_torque_Nm", mu * load_N * arm_m},
          {"torsional_stiffness_Nm_per_rad", tilt},
          {"tilt_stiffness_Nm_per_rad", {tilt, tilt}},
          {"tilt_stiffness_free_to_slide_Nm_per_rad", {tilt, tilt}},
          {"tilt_limit_Nm", nullptr},
          {"tilt_limit_free_to_slide_Nm", nullptr},
          {"shear_stiffness_N_per_m", {per_m * area_m2, per_m * area_m2}},
          {"lifted_share", 0},
          {"unknowns", 1000},
          {"wall_s", 0.01},
          {"peak_memory_MB", 20},
          {"pressure",
           {{"x_m", {-radius_m, 0.0, radius_m, 0.0, 0.0}},
            {"y_m", {0.0, 0.0, 0.0, radius_m, -radius_m}},
            {"pressure_Pa", std::vector<double>(5, load_N / area_m2)}}},
          {"error", stated},
          {"levels", nlohmann::json::array({level})}};
}

nlohmann::json answer(const nlohmann::json& problem) {
  const double load_N = problem["load_N"];
  if (!option("FAKE_FEM_LOG").empty())
    std::ofstream(option("FAKE_FEM_LOG"), std::ios::app)
        << problem["name"].get<std::string>() << " " << load_N << " " << getpid() << std::endl;
  std::fprintf(stderr, "level 1: 1000 unknowns, residual 1e-9\n");
  const auto is_load_of = [&](const char* name) {
    return !option(name).empty() && std::stod(option(name)) == load_N;
  };
  if (is_load_of("FAKE_FEM_LINGER_N")) sleep(60);
  if (!option("FAKE_FEM_SLOW_S").empty())
    usleep(static_cast<useconds_t>(1e6 * std::stod(option("FAKE_FEM_SLOW_S"))));
  if (is_load_of("FAKE_FEM_HOARD_N")) {
    // Read where the compiler cannot know, which would leave out a vector that nothing needs.
    const std::vector<char> hoard(200 << 20, 1);
    const volatile char* const read = hoard.data();
    sleep(59 + unsigned(read[std::rand() % int(hoard.size())]));
  }
  if (is_load_of("FAKE_FEM_CRASH_N")) std::raise(SIGKILL);
  if (!option("FAKE_FEM_CRASH_FINER").empty() && problem["level"].get<int>() > 2)
    std::raise(SIGKILL);
  if (!option("FAKE_FEM_EXIT").empty()) {
    std::fprintf(stderr, "softfinger-fem: error: the fake fails as it was told\n");
    std::exit(std::stoi(option("FAKE_FEM_EXIT")));
  }

  if (problem.contains("pad")) return answer_of_pad(problem);
  const double nu = problem["layer"]["poisson_ratio"];
  const double modulus_Pa = problem["layer"]["youngs_modulus_Pa"].get<double>() / (1 - nu * nu);
  const double radius_m =
      std::sqrt(problem["radii_m"][0].get<double>() * problem["radii_m"][1].get<double>());
  const double a_m = std::cbrt(0.75 * load_N * radius_m / modulus_Pa);
  const double pi = 3.14159265358979323846, mu = problem["friction_coefficient"];
  const double error =
      std::stod(option("FAKE_FEM_ERROR").empty() ? "1e-3" : option("FAKE_FEM_ERROR")) *
      std::pow(0.5, problem["level"].get<int>() - 2);
  nlohmann::json vtu;
  if (problem.contains("output_directory")) {
    vtu = problem["output_directory"].get<std::string>() + "/solution.vtu";
    std::ofstream(vtu.get<std::string>()) << "<VTKFile/>\n";
  }
  const nlohmann::json profile = {{"position_m", {0.0, a_m}}, {"pressure_Pa", {1.0, 0.0}}};
  const nlohmann::json level = {{"level", 1},
                                {"unknowns", 1000},
                                {"a_m", a_m},
                                {"b_m", a_m},
                                {"indentation_m", a_m * a_m / radius_m},
                                {"max_torque_Nm", mu * load_N * a_m * 3 * pi / 16}};
  nlohmann::json result = level;
  result.update({{"model", "fem"},
                 {"load_N", load_N},
                 {"axis_rad", problem["axis_rad"]},
                 {"peak_pressure_Pa", 1.5 * load_N / (pi * a_m * a_m)},
                 {"area_m2", 1.01 * pi * a_m * a_m},
                 {"area_projected_m2", pi * a_m * a_m},
                 {"eccentricity_m", a_m * 3 * pi / 16},
                 {"error",
                  {{"a", error},
                   {"b", error},
                   {"area", error},
                   {"indentation", error},
                   {"peak_pressure", error},
                   {"max_torque", error}}},
                 {"active_nodes", 100},
                 {"iterations", 10},
                 {"wall_s", 0.01},
                 {"peak_memory_MB", 20},
                 {"pressure_exponent", 0.5},
                 {"levels", nlohmann::json::array({level})},
                 {"profile_x", profile},
                 {"profile_y", profile},
                 {"vtu", vtu}});
  if (problem.value("lists_forces", false))
    result["nodal_forces"] = {{"x_m", {a_m / 2, -a_m / 2, a_m / 2, -a_m / 2}},
                              {"y_m", {a_m / 2, a_m / 2, -a_m / 2, -a_m / 2}},
                              {"force_N", std::vector<double>(4, load_N / 4)},
                              {"friction_x_N", std::vector<double>(4, 0)},
                              {"friction_y_N", std::vector<double>(4, 0)},
                              {"area_m2", std::vector<double>(4, a_m * a_m)}};
  if (problem.value("pressing", "frictionless") != "frictionless")
    result["frictionless"] = {{"a_m", 1.01 * a_m},
                              {"b_m", 1.01 * a_m},
                              {"indentation_m", 1.02 * a_m * a_m / radius_m},
                              {"area_projected_m2", 1.01 * 1.01 * pi * a_m * a_m},
                              {"max_torque_Nm", level["max_torque_Nm"]}};
  if (!option("FAKE_FEM_UNREAD_SCAN").empty()) result["geometry_error"] = nullptr;
  return result;
}

}  // namespace

int main() {
  for (const nlohmann::json& problem : nlohmann::json::parse(std::cin))
    std::cout << answer(problem).dump() << std::endl;
}
