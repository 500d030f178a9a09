#include "comparisons/reference/fem_process.h"

#include <fmt/format.h>

#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>

#include "comparisons/input/layer_json.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::reference {

namespace {

/// A body in the frame of the relative radii: `turn_rad` from that frame's x to the body's own.
nlohmann::json placed_body(const input::CaseBody& body, const std::optional<QuadricFit>& fit,
                           double turn_rad) {
  if (const auto* quadric = std::get_if<input::QuadricBody>(&body)) {
    double radius_x_m = quadric->radius_x_m, radius_y_m = quadric->radius_y_m;
    // Quarter turns without rounding: they keep the symmetry that saves three quarters of the work.
    const double quarters = turn_rad / (M_PI / 2);
    if (quadric->shape != input::FingerShape::tapered &&
        std::abs(quarters - std::round(quarters)) < 1e-9) {
      if (std::lround(quarters) % 2 != 0) std::swap(radius_x_m, radius_y_m);
      turn_rad = 0;
    }
    const char* shape[] = {"paraboloid", "ellipsoid", "tapered"};
    return {{"shape", shape[static_cast<int>(quadric->shape)]},
            {"radii_m", {text::finite_or_null(radius_x_m), text::finite_or_null(radius_y_m)}},
            {"taper_per_m", quadric->taper_per_m},
            {"turn_rad", turn_rad}};
  }
  if (const auto* sphere = std::get_if<input::SphereBody>(&body))
    return {{"shape", "sphere"}, {"radii_m", {sphere->radius_m, sphere->radius_m}}};
  const auto& mesh = std::get<input::MeshBody>(body);
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

nlohmann::json fingertip(const input::Case& contact_case, const prediction::LocalGeometry& geometry,
                         double axis_rad) {
  const auto& pair = std::get<input::BodyPair>(contact_case.geometry);
  const std::optional<QuadricFit> none;
  const auto& patch = geometry.patch;
  return {{"pad", placed_body(pair.finger, patch ? patch->finger_fit : none, -axis_rad)},
          {"object",
           placed_body(pair.object, patch ? patch->object_fit : none, pair.angle_rad - axis_rad)}};
}

void add_material(const input::FiniteStrain& material, nlohmann::json& layer) {
  layer["material"] = material.material;
  layer["volumetric"] = material.volumetric;
  layer["mooney_rivlin_share"] = material.mooney_rivlin_share;
  if (!material.yeoh_ratios.empty()) layer["yeoh_ratios"] = material.yeoh_ratios;
}

}  // namespace

nlohmann::json fem_problem(const input::Case& contact_case,
                           const prediction::LocalGeometry& geometry, double load_N, int level) {
  if (contact_case.object_layer.thickness_m > 0)
    throw InputError(contact_case.file.string(), "[object_layer]", "",
                     "one layer, [layer] or [object_layer], for finite elements; the models take "
                     "both (softfinger predict)");
  nlohmann::json problem = {{"name", contact_case.id},
                            {"radii_m", {geometry.radii.major_m, geometry.radii.minor_m}},
                            {"axis_rad", geometry.radii.axis_rad},
                            {"sphere_radius_m", text::finite_or_null(geometry.sphere_radius_m)},
                            {"layer", input::layer_json(contact_case.layer)},
                            {"load_N", load_N},
                            {"friction_coefficient", contact_case.friction_coefficient},
                            {"level", level}};
  if (const auto& finite = contact_case.fem_finite) {
    problem["kinematics"] = "finite";
    add_material(*finite, problem["layer"]);
  }
  for (const input::Sublayer& sublayer : contact_case.sublayers) {
    nlohmann::json entry = input::layer_json(sublayer.layer);
    entry["name"] = sublayer.name;
    if (contact_case.fem_finite) add_material(sublayer.material, entry);
    problem["layer"]["sublayers"].push_back(entry);
  }
  if (!contact_case.fem_mesh.empty()) {
    // A mesh that was written anew is another problem.
    std::error_code ignored;
    const auto written = std::filesystem::last_write_time(contact_case.fem_mesh, ignored);
    problem["layer_mesh"] = {{"mesh", std::filesystem::absolute(contact_case.fem_mesh).string()},
                             {"metres_per_unit", contact_case.fem_mesh_metres_per_unit},
                             {"written", written.time_since_epoch().count()}};
  }
  if (contact_case.fem_curved) {
    // A tapered finger tapers along its own x, wherever the contact's long axis lies.
    const auto* finger =
        std::get_if<input::QuadricBody>(&std::get<input::BodyPair>(contact_case.geometry).finger);
    const bool tapered = finger && finger->shape == input::FingerShape::tapered;
    const double axis_rad = tapered ? 0 : geometry.radii.axis_rad;
    problem["axis_rad"] = axis_rad;
    problem["fingertip"] = fingertip(contact_case, geometry, axis_rad);
  }
  return problem;
}

namespace {

/// The line that a process writes for each of its problems.
FemAnswer answer_of(const std::string& line) {
  const nlohmann::json written = text::parse_json(line);
  const bool failed = written.is_object() && written.contains("failure");
  if (!failed) {
    ReadReferenceResult read = read_reference_result(written);
    if (read.result) return {std::move(read.result), "", 0};
    return {std::nullopt, "softfinger-fem gave no result to believe: " + read.flaw, 3};
  }
  FemAnswer answer;
  answer.failure = written.value("failure", "");
  if (answer.failure.rfind("error: ", 0) == 0) answer.failure.erase(0, std::strlen("error: "));
  answer.exit_status = written.value("exit_status", 3);
  return answer;
}

/// For the problem that a process was at when it ended before its time.
FemAnswer failure_of(const system::ProcessOutcome& outcome, const FemLimits& limits) {
  FemAnswer answer;
  // Whatever else a crashed program returns, for the user the numerics failed.
  answer.exit_status = outcome.exit_status == 2 ? 2 : 3;
  if (outcome.exceeded == system::ProcessLimit::time) {
    answer.failure = fmt::format("softfinger-fem was ended after {:g} s, its limit (--fem-time-s)",
                                 limits.time_s);
  } else if (outcome.exceeded == system::ProcessLimit::memory) {
    answer.failure = fmt::format(
        "softfinger-fem was ended as it took more than {:g} MB, its limit "
        "(--fem-memory-MB)",
        limits.memory_MB);
  } else if (outcome.signal != 0) {
    answer.failure = fmt::format(
        "softfinger-fem was killed by signal {} ({}){}", outcome.signal, strsignal(outcome.signal),
        outcome.signal == 9 ? "; often this means that memory ran out" : "");
  } else if (outcome.exit_status == 0) {
    answer.failure = "softfinger-fem ended without a complete result";
  } else {
    answer.failure = outcome.last_line.empty() ? "it did not say why" : outcome.last_line;
    for (const char* prefix : {"softfinger-fem: ", "error: "})
      if (answer.failure.rfind(prefix, 0) == 0) answer.failure.erase(0, std::strlen(prefix));
  }
  return answer;
}

/// "fem: 2/3: text" is about the second of three problems. @returns its text
std::string text_of(const std::string& line, std::size_t& problem) {
  std::size_t number = 0;
  int length = 0;
  if (std::sscanf(line.c_str(), "fem: %zu/%*u: %n", &number, &length) != 1 || length == 0)
    return line;
  problem += number - 1;
  return line.substr(static_cast<std::size_t>(length));
}

}  // namespace

int run_fem(const std::string& program, const std::vector<FemBatch>& batches, int parallel,
            const FemCallbacks& callbacks, system::OnInterrupt on_interrupt) {
  std::vector<std::size_t> answered(batches.size(), 0);
  // A crash ends its process: the problems behind it go to a new one.
  while (true) {
    std::vector<system::ProcessJob> jobs;
    std::vector<std::size_t> batch_of, first;
    for (std::size_t batch = 0; batch < batches.size(); ++batch) {
      const auto& problems = batches[batch].problems;
      if (answered[batch] == problems.size()) continue;
      nlohmann::json left = nlohmann::json::array();
      for (std::size_t i = answered[batch]; i < problems.size(); ++i) left.push_back(problems[i]);
      system::ProcessJob job;
      job.command = {program, "-"};
      job.input = left.dump() + "\n";
      if (batches[batch].single_thread)
        job.environment = {"OPENBLAS_NUM_THREADS=1", "OMP_NUM_THREADS=1", "DEAL_II_NUM_THREADS=1"};
      // Under mpirun this program is a rank; the finite elements are not.
      job.hidden = {"OMPI_", "PMIX_", "PMI_"};
      job.time_limit_s = batches[batch].limits.time_s;
      job.memory_limit_MB = batches[batch].limits.memory_MB;
      jobs.push_back(std::move(job));
      batch_of.push_back(batch);
      first.push_back(answered[batch]);
    }
    if (jobs.empty()) return 0;
    const auto answer = [&](std::size_t job, FemAnswer given) {
      const std::size_t batch = batch_of[job];
      if (answered[batch] == batches[batch].problems.size()) return;  // nobody asked
      callbacks.on_answer({batch, answered[batch]++}, std::move(given));
    };
    bool stopping = false;
    system::ProcessCallbacks processes;
    processes.on_line = [&](std::size_t job, const std::string& line) {
      FemIndex index{batch_of[job], first[job]};
      const std::string text = text_of(line, index.problem);
      if (index.problem < batches[index.batch].problems.size()) callbacks.on_line(index, text);
    };
    processes.on_output = [&](std::size_t job, const std::string& line) {
      answer(job, answer_of(line));
    };
    processes.on_finish = [&](std::size_t job, const system::ProcessOutcome& outcome) {
      // Interrupted, it leaves out what it has not begun.
      if (outcome.exit_status == 128 + SIGINT) stopping = true;
      const std::size_t batch = batch_of[job];
      if (!stopping && answered[batch] < batches[batch].problems.size())
        answer(job, failure_of(outcome, batches[batch].limits));
    };
    if (const int signal = system::run_processes(jobs, parallel, processes, on_interrupt))
      return signal;
    if (stopping) return SIGINT;
  }
}

std::string load_folder(const std::string& case_id, double load_N) {
  return fmt::format("{}_{}N", case_id, load_N);
}

}  // namespace softfinger::reference
