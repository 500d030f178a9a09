#include "comparisons/fem_process.h"

#include <fmt/format.h>

#include <cstring>

#include "comparisons/predict.h"
#include "softfinger/input/errors.h"

namespace softfinger {

nlohmann::json fem_problem(const Case& contact_case, const LocalGeometry& geometry, double load_N,
                           int level) {
  if (contact_case.object_layer.thickness_m > 0)
    throw InputError(contact_case.file.string(), "[object_layer]", "",
                     "one layer, [layer] or [object_layer], for finite elements; the models take "
                     "both (softfinger predict)");
  return {{"name", contact_case.id},
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
}

ProcessJob fem_job(const std::string& program, nlohmann::json problem,
                   const std::string& output_directory, bool single_thread) {
  problem["output_directory"] =
      output_directory.empty() ? nlohmann::json() : nlohmann::json(output_directory);
  ProcessJob job;
  job.command = {program, "-"};
  job.input = problem.dump() + "\n";
  if (single_thread) job.environment = {"OPENBLAS_NUM_THREADS=1", "OMP_NUM_THREADS=1"};
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
