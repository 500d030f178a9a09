#include "comparisons/fem_process.h"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <optional>

#include "comparisons/predict.h"
#include "softfinger/input/errors.h"

namespace softfinger {

namespace {

/// A body in the frame of the relative radii: `turn_rad` from that frame's x to the body's own.
nlohmann::json placed_body(const CaseBody& body, const std::optional<QuadricFit>& fit,
                           double turn_rad) {
  if (const auto* quadric = std::get_if<QuadricBody>(&body)) {
    double radius_x_m = quadric->radius_x_m, radius_y_m = quadric->radius_y_m;
    // Quarter turns without rounding: they keep the symmetry that saves three quarters of the work.
    const double quarters = turn_rad / (M_PI / 2);
    if (quadric->shape != FingerShape::tapered &&
        std::abs(quarters - std::round(quarters)) < 1e-9) {
      if (std::lround(quarters) % 2 != 0) std::swap(radius_x_m, radius_y_m);
      turn_rad = 0;
    }
    const char* shape[] = {"paraboloid", "ellipsoid", "tapered"};
    return {{"shape", shape[static_cast<int>(quadric->shape)]},
            {"radii_m", {finite_or_null(radius_x_m), finite_or_null(radius_y_m)}},
            {"taper_per_m", quadric->taper_per_m},
            {"turn_rad", turn_rad}};
  }
  if (const auto* sphere = std::get_if<SphereBody>(&body))
    return {{"shape", "sphere"}, {"radii_m", {sphere->radius_m, sphere->radius_m}}};
  const auto& mesh = std::get<MeshBody>(body);
  const auto list = [](const Eigen::Vector3d& v) { return nlohmann::json{v.x(), v.y(), v.z()}; };
  // Radii of the surface's sections along the frame's axes: the layer's map starts from a torus.
  const double c = std::cos(turn_rad), s = std::sin(turn_rad);
  const auto section = [&](double x, double y) {
    const double curvature = 2 * (fit->quadric.A_per_m * x * x + fit->quadric.B_per_m * y * y +
                                  fit->quadric.C_per_m * x * y);
    return curvature > 0 ? nlohmann::json(1 / curvature) : nlohmann::json();
  };
  return {{"shape", "mesh"},
          {"mesh", std::filesystem::absolute(mesh.path).string()},
          {"metres_per_unit", mesh.metres_per_unit},
          {"point_m", list(mesh.point_m)},
          {"outward_normal", list(fit->normal)},
          {"x_axis", list(fit->x_axis)},
          {"radii_m", {section(c, -s), section(s, c)}},
          {"turn_rad", turn_rad}};
}

nlohmann::json fingertip(const Case& contact_case, const LocalGeometry& geometry, double axis_rad) {
  const auto& pair = std::get<BodyPair>(contact_case.geometry);
  const std::optional<QuadricFit> none;
  const auto& patch = geometry.patch;
  return {{"pad", placed_body(pair.finger, patch ? patch->finger_fit : none, -axis_rad)},
          {"object",
           placed_body(pair.object, patch ? patch->object_fit : none, pair.angle_rad - axis_rad)}};
}

}  // namespace

nlohmann::json fem_problem(const Case& contact_case, const LocalGeometry& geometry, double load_N,
                           int level) {
  if (contact_case.object_layer.thickness_m > 0)
    throw InputError(contact_case.file.string(), "[object_layer]", "",
                     "one layer, [layer] or [object_layer], for finite elements; the models take "
                     "both (softfinger predict)");
  nlohmann::json problem = {{"name", contact_case.id},
                            {"radii_m", {geometry.radii.major_m, geometry.radii.minor_m}},
                            {"axis_rad", geometry.radii.axis_rad},
                            {"sphere_radius_m", finite_or_null(geometry.sphere_radius_m)},
                            {"layer",
                             {{"thickness_m", contact_case.layer.thickness_m},
                              {"youngs_modulus_Pa", contact_case.layer.youngs_modulus_Pa},
                              {"poisson_ratio", contact_case.layer.poisson_ratio}}},
                            {"load_N", load_N},
                            {"friction_coefficient", contact_case.friction_coefficient},
                            {"level", level}};
  if (contact_case.fem_curved) {
    // A tapered finger tapers along its own x, wherever the contact's long axis lies.
    const auto* finger =
        std::get_if<QuadricBody>(&std::get<BodyPair>(contact_case.geometry).finger);
    const bool tapered = finger && finger->shape == FingerShape::tapered;
    const double axis_rad = tapered ? 0 : geometry.radii.axis_rad;
    problem["axis_rad"] = axis_rad;
    problem["fingertip"] = fingertip(contact_case, geometry, axis_rad);
  }
  return problem;
}

ProcessJob fem_job(const std::string& program, nlohmann::json problem,
                   const std::string& output_directory, bool single_thread) {
  problem["output_directory"] =
      output_directory.empty() ? nlohmann::json() : nlohmann::json(output_directory);
  ProcessJob job;
  job.command = {program, "-"};
  job.input = problem.dump() + "\n";
  if (single_thread)
    job.environment = {"OPENBLAS_NUM_THREADS=1", "OMP_NUM_THREADS=1", "DEAL_II_NUM_THREADS=1"};
  return job;
}

FemAnswer interpret_fem(const ProcessOutcome& outcome) {
  FemAnswer answer;
  const std::string said = outcome.last_line.empty() ? "it did not say why" : outcome.last_line;
  if (outcome.signal != 0) {
    answer.exit_status = 3;
    answer.failure = fmt::format(
        "softfinger-fem was killed by signal {} ({}){}", outcome.signal, strsignal(outcome.signal),
        outcome.signal == 9 ? "; often this means that memory ran out" : "");
  } else if (outcome.exit_status != 0) {
    // Whatever else a crashed program returns, for the user the numerics failed.
    answer.exit_status = outcome.exit_status == 2 ? 2 : 3;
    answer.failure = said;
    for (const char* prefix : {"softfinger-fem: ", "error: "})
      if (answer.failure.rfind(prefix, 0) == 0) answer.failure.erase(0, std::strlen(prefix));
  } else {
    answer.result = nlohmann::json::parse(outcome.output, nullptr, false);
    const auto complete = [&] {
      if (!answer.result.is_object()) return false;
      for (const char* key :
           {"a_m", "b_m", "indentation_m", "peak_pressure_Pa", "area_m2", "max_torque_Nm"})
        if (!answer.result.contains(key) || !answer.result[key].is_number()) return false;
      return answer.result.contains("error") && answer.result["error"].is_object();
    };
    if (!complete()) {
      answer.result = nullptr;
      answer.exit_status = 3;
      answer.failure = "softfinger-fem ended without a complete result";
    }
  }
  return answer;
}

bool fem_is_trusted(const nlohmann::json& result) {
  const auto within = [&](const char* key, double limit) {
    const auto& error = result.at("error");
    return error.contains(key) && error[key].is_number() && error[key].get<double>() <= limit;
  };
  return within("a", 0.02) && within("b", 0.02) && within("indentation", 0.01) &&
         within("max_torque", 0.01);
}

std::string load_folder(const std::string& case_id, double load_N) {
  return fmt::format("{}_{}N", case_id, load_N);
}

}  // namespace softfinger
