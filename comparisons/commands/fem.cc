#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>

#include "comparisons/commands/commands.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/reference/fem_process.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/progress.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

struct Options {
  std::string case_file, output;
  std::string compliance;
  std::vector<double> twist_axis_mm;
  double approach_mm = 0;
  int level = 0, increments = 20, limit_surface = 0, increments_to_slip = 0;
  bool torsion = false, json = false;
  reference::FemLimits limits;
};

/// What the finite-element program is asked for besides the normal contact.
nlohmann::json friction_request(const Options& options) {
  nlohmann::json request = {{"torsion", options.torsion},
                            {"increments", options.increments},
                            {"limit_surface", options.limit_surface},
                            {"increments_to_slip", options.increments_to_slip}};
  if (!options.twist_axis_mm.empty())
    request["twist_axis_m"] = {1e-3 * options.twist_axis_mm[0], 1e-3 * options.twist_axis_mm[1]};
  return request;
}

/// In per cent; NaN when the error is not known.
double in_percent(const std::optional<double>& error) {
  return 100 * error.value_or(std::numeric_limits<double>::quiet_NaN());
}

std::string twist_table(const reference::ReferenceResult& result) {
  const reference::TwistedContact& twist = *result.twist;
  std::string text = fmt::format(
      "  torsional stiffness, stuck {:>10.5g} N·m/rad  ± {:.2g} %\n"
      "  torque at full slip        {:>10.5g} mN·m     ± {:.2g} %, {:+.2g} % against int mu p r "
      "dA\n"
      "  twist: angle (deg), torque (mN·m, ± {:.2g} % of full slip), slipping share of the "
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
      "  limit surface, ± {:.2g} % of mu P and of the largest torque: fx, fy (N), torque (mN·m)\n",
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

std::string table_row(const reference::ReferenceResult& result) {
  const auto within = [](const std::optional<double>& error) {
    return error ? fmt::format("± {:.2g} %", 100 * *error) : "";
  };
  const reference::ReferenceErrors& error = result.error;
  return fmt::format(
             "  a           {:>10.5g} mm    {}\n"
             "  b           {:>10.5g} mm    {}\n"
             "  indentation {:>10.5g} mm    {}\n"
             "  peak        {:>10.5g} kPa   {}\n"
             "  area        {:>10.5g} mm²   {}\n"
             "  torque      {:>10.5g} mN·m  {}\n",
             result.a_m * 1e3, within(error.a), result.b_m * 1e3, within(error.b),
             result.indentation_m * 1e3, within(error.indentation), result.peak_pressure_Pa * 1e-3,
             within(error.peak_pressure), result.area_m2 * 1e6, within(error.area),
             result.max_torque_Nm * 1e3, within(error.max_torque)) +
         (result.projected_torque_Nm
              ? fmt::format("  projected   {:>10.5g} mN·m  int mu p n_z r dA, without the slope\n",
                            *result.projected_torque_Nm * 1e3)
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

int run(const Options& options) {
  const input::Case contact_case = input::read_case(system::find_case_file(options.case_file));
  const prediction::GeometryResolver resolver(contact_case);
  for (const std::string& line : resolver.remarks()) remark(line);
  const std::string program = system::fem_program().string();
  const int level = options.level > 0 ? options.level : contact_case.fem_level;

  // With a given approach the load is a result. The first load then only chooses the size of the
  // patch on which the radii of a mesh are fitted.
  std::vector<double> loads_N = contact_case.loads_N;
  const bool by_approach = options.approach_mm != 0;
  if (!std::isfinite(options.approach_mm))
    throw InputError("--approach-mm", "approach", fmt::format("{}", options.approach_mm),
                     "a finite number > 0 (mm)");
  if (by_approach) loads_N.resize(1);
  std::vector<prediction::LocalGeometry> geometries;
  for (double load_N : loads_N) geometries.push_back(resolver.resolve(load_N));
  // One process solves all loads. The largest contact comes first, because smaller ones can use its
  // mesh. At finite strain the smallest comes first: each load has its own meshes there, and the
  // largest load may be one for which there is no solution.
  const bool finite = contact_case.fem_finite.has_value();
  std::vector<std::size_t> order(loads_N.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t left, std::size_t right) {
    return finite ? loads_N[left] < loads_N[right] : loads_N[left] > loads_N[right];
  });
  std::optional<system::OutputFolder> output;
  if (!options.output.empty()) output.emplace(options.output);
  reference::FemBatch batch;
  batch.limits = options.limits;
  // Threads speed up large factorisations only. In small ones they wait for each other longer than
  // they save.
  batch.single_thread = level <= 2;
  for (const std::size_t i : order) {
    const double load_N = loads_N[i];
    nlohmann::json problem = reference::fem_problem(contact_case, geometries[i], load_N, level);
    if (by_approach) problem["approach_m"] = 1e-3 * options.approach_mm;
    problem["friction"] = friction_request(options);
    if (!options.output.empty()) {
      const auto folder =
          std::filesystem::path(options.output) /
          (by_approach ? fmt::format("{}_{:g}mm", contact_case.id, options.approach_mm)
                       : reference::load_folder(contact_case.id, load_N));
      system::make_writable_folder(folder);
      problem["output_directory"] = folder.string();
    }
    if (!options.compliance.empty()) {
      if (loads_N.size() > 1)
        throw InputError(
            "--export-compliance", "load_N", fmt::format("{} loads", loads_N.size()),
            "a case with one load: the mesh, and with it the compliance, fits its contact");
      problem["compliance_file"] = std::filesystem::absolute(options.compliance).string();
    }
    batch.problems.push_back(std::move(problem));
  }

  system::Progress progress;
  const auto title = [&](std::size_t load) {
    return by_approach ? fmt::format("{} {} mm: ", contact_case.id, options.approach_mm)
                       : fmt::format("{} {} N: ", contact_case.id, loads_N[load]);
  };
  struct Failed {
    int exit_status;
    std::string message;
  };
  std::vector<std::optional<reference::ReferenceResult>> result_of_load(loads_N.size());
  reference::FemCallbacks callbacks;
  callbacks.on_line = [&](reference::FemIndex index, const std::string& line) {
    progress.say(title(order[index.problem]) + line);
  };
  callbacks.on_answer = [&](reference::FemIndex index, reference::FemAnswer answer) {
    const std::size_t load = order[index.problem];
    // A failure ends the remaining loads. At finite strain the results before it are kept.
    if (!answer.result) throw Failed{answer.exit_status, title(load) + answer.failure};
    // As asked for: the program's own load has gone through units and back.
    if (!by_approach) answer.result->load_N = loads_N[load];
    result_of_load[load] = std::move(answer.result);
  };
  int interrupted = 0, failed_status = 0;
  try {
    // An interrupted finite-element program returns its last finished level as the result.
    interrupted = reference::run_fem(program, {batch}, 1, callbacks, system::OnInterrupt::finish);
  } catch (const Failed& failed) {
    progress.say("softfinger: error: " + failed.message);
    failed_status = failed.exit_status;
    const bool nothing = std::all_of(result_of_load.begin(), result_of_load.end(),
                                     [](const auto& result) { return !result; });
    if (!finite || nothing) return failed_status;
  }
  nlohmann::json results = nlohmann::json::array();
  std::string text = prediction::describe(contact_case) + "\n";
  for (std::size_t load = 0; load < loads_N.size(); ++load) {
    if (!result_of_load[load]) continue;  // interrupted before this load
    const reference::ReferenceResult& result = *result_of_load[load];
    text += fmt::format("\n{:g} N: {}\n", result.load_N, prediction::describe(geometries[load])) +
            table_row(result) + friction_table(result);
    if (result.coarse) text += "  (interrupted: the result of a coarser level than requested)\n";
    results.push_back(to_json(result));
  }
  if (interrupted != 0) {
    progress.say("softfinger: interrupted");
    if (results.empty()) return 128 + interrupted;
  }
  if (options.json)
    system::write_to_stdout(
        nlohmann::json({{"case", contact_case.id}, {"results", results}}).dump(2) + "\n");
  else
    system::write_text_to_stdout(text);
  return interrupted != 0 ? 128 + interrupted : failed_status;
}

}  // namespace

void add_fem(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "fem",
      "The finite-element reference with its own error estimate, per load; seconds to minutes");
  command
      ->add_option("CASE", options->case_file, "case file (TOML), or the name of a built-in case")
      ->required();
  command
      ->add_option("--level", options->level,
                   "refinement, 1 (coarse) to 3 (fine); default: the case's own, else 2")
      ->check(CLI::Range(1, 3));
  command
      ->add_option("--approach-mm", options->approach_mm,
                   "press by this approach in place of the case's loads; the load is then a result")
      ->check(CLI::PositiveNumber);
  command->add_option("--output", options->output,
                      "folder for VTU files (ParaView), one sub-folder per load; default: none");
  command->add_flag("--torsion", options->torsion,
                    "twist from stick to full slip under Coulomb friction: torque against angle, "
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
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace softfinger::commands
