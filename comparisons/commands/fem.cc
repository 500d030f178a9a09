#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>

#include "comparisons/commands/case_input.h"
#include "comparisons/commands/commands.h"
#include "comparisons/experiments/experiments_report.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/reference/fem_process.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/progress.h"
#include "comparisons/text/json_text.h"
#include "comparisons/text/percent.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

struct FemOptions {
  CaseInput typed_case;
  std::string output;
  std::string compliance;
  std::vector<double> twist_axis_mm;
  double approach_mm = 0;
  int level = 0, increments = 20, limit_surface = 0, increments_to_slip = 0;
  bool torsion = false, json = false;
  reference::FemLimits limits;
};

reference::FrictionRequest friction_request(const FemOptions& options) {
  reference::FrictionRequest request;
  request.torsion = options.torsion;
  request.increments = options.increments;
  request.limit_surface = options.limit_surface;
  request.increments_to_slip = options.increments_to_slip;
  if (!options.twist_axis_mm.empty())
    request.twist_axis_m =
        1e-3 * Eigen::Vector2d(options.twist_axis_mm[0], options.twist_axis_mm[1]);
  return request;
}

/// "nan %" when the error is not known.
std::string in_percent(const std::optional<double>& error) {
  return text::percent(error.value_or(std::numeric_limits<double>::quiet_NaN()));
}

std::string twist_table(const reference::ReferenceResult& result) {
  const reference::TwistedContact& twist = *result.twist;
  std::string text = fmt::format(
      "  torsional stiffness, stuck {:>10.5g} N·m/rad  ± {}\n"
      "  torque at full slip        {:>10.5g} mN·m     ± {}, {:+.2g} % against int tau r "
      "dA\n"
      "  twist: angle (deg), torque (mN·m, ± {} of full slip), slipping share of the "
      "area\n",
      twist.stiffness_Nm_per_rad, in_percent(result.error.torsional_stiffness),
      1e3 * twist.full_slip_torque_Nm, in_percent(result.error.full_slip_torque),
      100 * (twist.full_slip_torque_Nm / result.max_torque_Nm - 1),
      in_percent(result.error.torsion_curve));
  for (const reference::TwistState& state : twist.states)
    text += fmt::format("    {:>10.4g} {:>10.5g} {:>6.0f} %\n", state.angle_rad * 180 / M_PI,
                        1e3 * state.torque_Nm, 100 * state.slip_fraction);
  return text;
}

std::string limit_surface_table(const reference::ReferenceResult& result) {
  std::string text = fmt::format(
      "  limit surface, ± {} of the largest force and torque: fx, fy (N), torque (mN·m)\n",
      in_percent(result.error.limit_surface));
  for (const reference::FrictionWrench& point : result.limit_surface)
    text += fmt::format("    {:>10.5g} {:>10.5g} {:>10.5g}\n", point.force_x_N, point.force_y_N,
                        1e3 * point.torque_Nm);
  return text;
}

std::string friction_table(const reference::ReferenceResult& result) {
  return (result.twist ? twist_table(result) : "") +
         (result.limit_surface.empty() ? "" : limit_surface_table(result));
}

/// A scan has this error, and it is null where one of the scan's readings could not be pressed.
bool is_geometry_unknown(const reference::ReferenceResult& result) {
  const auto error = result.document.find("geometry_error");
  return error != result.document.end() && error->is_null();
}

std::string table_row(const reference::ReferenceResult& result) {
  using reference::ReferenceErrors;
  const auto within = [&](std::optional<double> ReferenceErrors::*quantity) {
    const std::optional<double>& elements = result.error.*quantity;
    std::string text = elements ? "± " + text::percent(*elements) : "";
    if (const auto& facets = result.geometry_error; facets && (*facets).*quantity)
      text += fmt::format("{}± {} by the scan's facets", text.empty() ? "" : ", ",
                          text::percent(*((*facets).*quantity)));
    return text;
  };
  return fmt::format(
             "  a           {:>10.5g} mm    {}\n"
             "  b           {:>10.5g} mm    {}\n"
             "  indentation {:>10.5g} mm    {}\n"
             "  peak        {:>10.5g} kPa   {}\n"
             "  area        {:>10.5g} mm²   {} (seen along the load; {:.5g} mm² on the surface)\n"
             "  torque      {:>10.5g} mN·m  {}\n",
             result.a_m * 1e3, within(&ReferenceErrors::a), result.b_m * 1e3,
             within(&ReferenceErrors::b), result.indentation_m * 1e3,
             within(&ReferenceErrors::indentation), result.peak_pressure_Pa * 1e-3,
             within(&ReferenceErrors::peak_pressure), result.area_projected_m2 * 1e6,
             within(&ReferenceErrors::area), result.area_m2 * 1e6, result.max_torque_Nm * 1e3,
             within(&ReferenceErrors::max_torque)) +
         (result.projected_torque_Nm
              ? fmt::format("  projected   {:>10.5g} mN·m  int tau n_z r dA, without the slope\n",
                            *result.projected_torque_Nm * 1e3)
              : "") +
         (is_geometry_unknown(result)
              ? "  What the scan's facets leave open is not known: another reading of them could "
                "not be pressed.\n"
              : "") +
         fmt::format("  {} unknowns, {:.3g} s\n",
                     result.unknowns ? fmt::format("{:.0f}", *result.unknowns) : "?",
                     std::isfinite(result.wall_s) ? result.wall_s : 0);
}

/// With the keys that `predict` has, so that one reader serves both.
nlohmann::json to_json(const reference::ReferenceResult& result) {
  nlohmann::json object = result.document;
  object["load_N"] = result.load_N;
  object["model"] = "fem";
  object["torque_rule"] = "exact";
  object["valid"] = true;
  object["validity"] = nlohmann::json::array();
  object["error_estimate"] = object["error"];
  object["cost_ns"] = text::finite_or_null(1e9 * result.wall_s);
  return object;
}

/// The loads of a case as the program is to solve them.
struct Plan {
  input::Case contact_case;
  /// With a given approach the load is a result. The first load then only chooses the size of the
  /// patch on which the radii of a mesh are fitted.
  double approach_mm = 0;
  std::vector<double> loads_N;
  std::vector<prediction::LocalGeometry> geometries;  ///< of each load
  std::vector<std::size_t> order;                     ///< of solving: places in loads_N
  int level = 0;

  bool by_approach() const { return approach_mm != 0; }
  bool finite_strain() const { return contact_case.fem_finite.has_value(); }
  std::string title(std::size_t load) const {
    return by_approach() ? fmt::format("{} {} mm: ", contact_case.id, approach_mm)
                         : fmt::format("{} {} N: ", contact_case.id, loads_N[load]);
  }
};

void check(const FemOptions& options, const Plan& plan) {
  if (!std::isfinite(options.approach_mm))
    throw InputError("--approach-mm", "approach", options.approach_mm, "a finite number > 0 (mm)");
  if (!options.compliance.empty() && plan.loads_N.size() > 1)
    throw InputError(
        "--export-compliance", "load_N", fmt::format("{} loads", plan.loads_N.size()),
        "a case with one load: the mesh, and with it the compliance, fits its contact");
  // The finite elements' program writes it, whose standard output is not this one's.
  std::error_code error;
  const auto there = std::filesystem::status(options.compliance, error);
  if (!options.compliance.empty() && std::filesystem::exists(there) &&
      !std::filesystem::is_regular_file(there))
    throw InputError("--export-compliance", "file", options.compliance, "a regular file");
}

Plan plan_loads(const FemOptions& options) {
  Plan plan;
  plan.contact_case = read_case(options.typed_case);
  const prediction::GeometryResolver resolver(plan.contact_case);
  for (const std::string& line : resolver.remarks()) remark(line);
  plan.level = options.level > 0 ? options.level : plan.contact_case.fem_level;
  plan.approach_mm = options.approach_mm;
  plan.loads_N = plan.contact_case.loads_N;
  if (plan.by_approach()) plan.loads_N.resize(1);
  check(options, plan);
  for (const double load_N : plan.loads_N) plan.geometries.push_back(resolver.place(load_N));
  // One process solves all loads. The largest contact comes first, because smaller ones can use its
  // mesh. At finite strain the smallest comes first: each load has its own meshes there, and the
  // largest load may be one for which there is no solution.
  plan.order.resize(plan.loads_N.size());
  std::iota(plan.order.begin(), plan.order.end(), 0);
  std::stable_sort(plan.order.begin(), plan.order.end(), [&](std::size_t left, std::size_t right) {
    return plan.finite_strain() ? plan.loads_N[left] < plan.loads_N[right]
                                : plan.loads_N[left] > plan.loads_N[right];
  });
  return plan;
}

/// Makes the load's folder where one is asked for.
reference::FemProblem problem_of(const FemOptions& options, const Plan& plan, std::size_t load) {
  const input::Case& contact_case = plan.contact_case;
  const double load_N = plan.loads_N[load];
  reference::FemProblem problem =
      reference::fem_problem(contact_case, plan.geometries[load], load_N, plan.level);
  if (plan.by_approach()) problem.approach_m = 1e-3 * plan.approach_mm;
  problem.friction = friction_request(options);
  if (!options.compliance.empty())
    problem.compliance_file = std::filesystem::absolute(options.compliance);
  if (!options.output.empty()) {
    const auto folder =
        std::filesystem::path(options.output) /
        (plan.by_approach() ? fmt::format("{}_{:g}mm", contact_case.id, plan.approach_mm)
                            : reference::load_folder(contact_case.id, load_N));
    system::make_writable_folder(folder);
    problem.output_directory = folder;
  }
  return problem;
}

/// What the program answered until it ended, failed or was interrupted.
struct SolvedLoads {
  std::vector<std::optional<reference::ReferenceResult>> of_load;
  int interrupted = 0;    ///< by this signal
  int failed_status = 0;  ///< exit status of the load that failed

  bool is_empty() const {
    return std::none_of(of_load.begin(), of_load.end(),
                        [](const auto& result) { return result.has_value(); });
  }
};

SolvedLoads solve(const FemOptions& options, const Plan& plan, system::Progress& progress) {
  reference::FemBatch batch;
  batch.limits = options.limits;
  batch.single_thread = false;
  for (const std::size_t load : plan.order)
    batch.problems.push_back(problem_of(options, plan, load));
  SolvedLoads solved;
  solved.of_load.resize(plan.loads_N.size());
  struct Failed {
    int exit_status;
    std::string message;
  };
  reference::FemCallbacks callbacks;
  callbacks.on_line = [&](reference::FemIndex index, const std::string& line) {
    progress.say(plan.title(plan.order[index.problem]) + line);
  };
  callbacks.on_answer = [&](reference::FemIndex index, reference::FemAnswer answer) {
    const std::size_t load = plan.order[index.problem];
    // A failure ends the remaining loads; an exception is how the process is stopped.
    if (!answer.result) throw Failed{answer.exit_status, plan.title(load) + answer.failure};
    // As asked for: the program's own load has gone through units and back.
    if (!plan.by_approach()) answer.result->load_N = plan.loads_N[load];
    solved.of_load[load] = std::move(answer.result);
  };
  try {
    // An interrupted finite-element program returns its last finished level as the result.
    solved.interrupted = reference::run_fem(system::fem_program().string(), {batch}, 1, callbacks,
                                            system::OnInterrupt::finish);
  } catch (const Failed& failed) {
    progress.fail("softfinger: error: " + failed.message);
    solved.failed_status = failed.exit_status;
  }
  return solved;
}

void print(const FemOptions& options, const Plan& plan, const SolvedLoads& solved) {
  nlohmann::json results = nlohmann::json::array();
  std::string text = prediction::describe(plan.contact_case) + "\n";
  for (std::size_t load = 0; load < plan.loads_N.size(); ++load) {
    if (!solved.of_load[load]) continue;  // interrupted, or failed, before this load
    const reference::ReferenceResult& result = *solved.of_load[load];
    text +=
        fmt::format("\n{:g} N: {}\n", result.load_N, prediction::describe(plan.geometries[load])) +
        table_row(result) + friction_table(result);
    if (result.coarse) text += "  (interrupted: the result of a coarser level than requested)\n";
    results.push_back(to_json(result));
  }
  if (options.json)
    system::write_to_stdout(
        nlohmann::json({{"case", plan.contact_case.id}, {"results", results}}).dump(2) + "\n");
  else
    system::write_text_to_stdout(text + experiments::noise_remark());
}

int run_fem(const FemOptions& options) {
  const Plan plan = plan_loads(options);
  system::fem_program();  // refuses before anything is written
  std::optional<system::OutputFolder> output;
  if (!options.output.empty()) output.emplace(options.output);
  system::Progress progress;
  const SolvedLoads solved = solve(options, plan, progress);
  if (solved.interrupted != 0) progress.say("softfinger: interrupted");
  // At finite strain the results before a failure are worth having.
  const bool failed = solved.failed_status != 0;
  if (failed ? !plan.finite_strain() || solved.is_empty()
             : solved.interrupted != 0 && solved.is_empty())
    return failed ? solved.failed_status : 128 + solved.interrupted;
  print(options, plan, solved);
  return solved.interrupted != 0 ? 128 + solved.interrupted : solved.failed_status;
}

}  // namespace

void add_fem(CLI::App& app, Action& action) {
  auto options = std::make_shared<FemOptions>();
  CLI::App* command = app.add_subcommand(
      "fem",
      "The finite-element reference with its own error estimate, per load; seconds to minutes");
  add_case(*command, options->typed_case);
  command
      ->add_option("--level", options->level,
                   "refinement, 1 (coarse) to 3 (fine); default: the case's own, else 2")
      ->check(CLI::Range(1, 3));
  command
      ->add_option("--approach-mm", options->approach_mm,
                   "press by this approach in place of the case's loads; the load is then a result")
      ->check(CLI::PositiveNumber);
  command->add_option("-o,--output", options->output,
                      "folder for VTU files (ParaView), one sub-folder per load; default: none");
  command->add_flag(
      "--torsion", options->torsion,
      "twist from stick to full slip under the case's shear law: torque against angle, "
      "stiffness at the start, torque at full slip");
  command->add_option("--increments", options->increments, "of the twist, 1 to 1000; default: 20")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--twist-axis-mm", options->twist_axis_mm,
                   "X,Y of the twist's axis from the contact's centre, along its long and short "
                   "axis (mm), inside the contact; default: the centre")
      ->delimiter(',')
      ->expected(2);
  command
      ->add_option(
          "--limit-surface", options->limit_surface,
          "points of full slip under tangential force and torque, 1 to 10000; default: none")
      ->check(CLI::Range(1, 10000));
  command
      ->add_option("--increments-to-slip", options->increments_to_slip,
                   "states of partial slip on the way to each of these points (JSON), 1 to 1000; "
                   "default: none")
      ->check(CLI::Range(1, 1000));
  command->add_option(
      "--export-compliance", options->compliance,
      "file for the compliance of the contact surface (m/N; the first line says what "
      "follows); default: none");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  add_fem_limits(*command, options->limits);
  command->footer(
      "[fem] mesh = \"layer.msh\" in the case takes a volume mesh of the layer in place of the "
      "flat\n"
      "one: 8-node hexahedra in mm (mesh_unit = \"m\" for metres), physical groups \"layer\" "
      "(volume),\n"
      "\"contact\" and \"core\" (surfaces; core is bonded), +z out of the finger, load along the z "
      "axis.\n"
      "The program softfinger-fem is looked for beside this one, or in SOFTFINGER_FEM_PROGRAM.\n"
      "Samples:\n"
      "  softfinger fem hertz_circle --level 1\n"
      "  softfinger fem pad_on_sphere --level 1 --torsion --limit-surface 8\n"
      "  softfinger fem hertz_circle --level 1 --output hertz_vtu --json");
  command->callback([options, &action] { action = [options] { return run_fem(*options); }; });
}

}  // namespace softfinger::commands
