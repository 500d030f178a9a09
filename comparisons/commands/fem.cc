#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>

#include "comparisons/commands/case_input.h"
#include "comparisons/commands/commands.h"
#include "comparisons/commands/fem_answer.h"
#include "comparisons/commands/fem_pad.h"
#include "comparisons/commands/number_option.h"
#include "comparisons/commands/taxel_input.h"
#include "comparisons/experiments/experiments_report.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/reference/fem_process.h"
#include "comparisons/reference/full_reference.h"
#include "comparisons/reference/taxel_reference.h"
#include "comparisons/reference/theory_limits.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/progress.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {
namespace {

struct FemOptions {
  CaseInput typed_case;
  TaxelInput taxels;
  std::string output;
  std::string compliance, at_time;
  std::vector<double> twist_axis_mm;
  double approach_mm = 0;
  int level = 0, increments = 20, limit_surface = 0, increments_to_slip = 0;
  bool torsion = false, json = false;
  reference::Idealisations idealisations;
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

/// The loads of a case as the program is to solve them.
struct Plan {
  input::Case contact_case;  ///< with the reference that is solved
  bool is_full = false;      ///< which leaves out nothing
  /// Left open by the case and the command line: its refusal may be one of the geometry's.
  bool curved_by_default = false;
  /// With a given approach the load is a result. The first load then only chooses the size of the
  /// patch on which the radii of a mesh are fitted.
  double approach_mm = 0;
  std::optional<double> time_s;  ///< of a layer that relaxes; infinite: at rest
  std::vector<double> loads_N;
  std::vector<prediction::LocalGeometry> geometries;  ///< of each load
  std::vector<std::size_t> order;                     ///< of solving: places in loads_N
  int level = 0;

  bool by_approach() const { return approach_mm != 0; }
  std::optional<double> approach_m() const {
    return by_approach() ? std::optional(1e-3 * approach_mm) : std::nullopt;
  }
  bool finite_strain() const { return contact_case.fem_finite.has_value(); }
  std::string title(std::size_t load) const {
    return by_approach() ? fmt::format("{} {} mm: ", contact_case.id, approach_mm)
                         : fmt::format("{} {} N: ", contact_case.id, loads_N[load]);
  }
};

void check(const FemOptions& options, const Plan& plan) {
  if (plan.by_approach() && !options.typed_case.load_N.empty())
    throw InputError("command line",
                     "--approach-mm and --load both say how far the finger is pressed", "",
                     "one of them");
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

/// Idealisations asked for, and always both where a compliance is exported.
/// @param typed  by the user
reference::Idealisations idealisations_of(const FemOptions& options, const input::Case& typed) {
  if (options.compliance.empty()) return options.idealisations;
  if (!(typed.fem_geometry_typed && typed.fem_kinematics_typed) &&
      !(options.idealisations.flat && options.idealisations.linear))
    remark(
        "--export-compliance: of a flat layer in linear elasticity, because a surface that bends "
        "or deforms has no one compliance");
  return {true, true};
}

/// Refuses what only curved fingers have.
void refuse_for_pads(const FemOptions& options) {
  options.taxels.refuse("for a contact of curved bodies: no array under a flat pad is computed");
  const auto refuse = [](bool is_given, const char* option, const char* allowed) {
    if (is_given) throw InputError("command line", option, "of a flat pad", allowed);
  };
  refuse(options.torsion, "--torsion",
         "without it: the largest torque and the torsional stiffness are always computed");
  refuse(options.approach_mm != 0, "--approach-mm", "a load");
  refuse(!options.output.empty(), "--output", "without it: there are no VTU files of pads");
  refuse(!options.compliance.empty(), "--export-compliance", "without it");
  refuse(options.increments_to_slip > 0, "--increments-to-slip", "without it");
}

/// Refuses what a layer that relaxes does not have.
void refuse_in_time(const FemOptions& options, const input::Case& typed) {
  options.taxels.refuse("for a case without relaxation and history");
  const auto refuse = [](bool is_given, const char* option) {
    if (is_given)
      throw InputError("command line", option, "with relaxation or history",
                       "no such option: over time the elements give the contact, its pressure and "
                       "largest torque");
  };
  refuse(options.torsion, "--torsion");
  refuse(options.limit_surface > 0, "--limit-surface");
  refuse(options.approach_mm != 0, "--approach-mm");
  refuse(!options.typed_case.load_N.empty() && !typed.times.history.empty(), "--load");
  refuse(!options.output.empty(), "--output");
  refuse(!options.compliance.empty(), "--export-compliance");
  if (typed.fem_kinematics_typed && typed.fem_finite)
    throw InputError(typed.times.where, "[fem] kinematics", "\"finite\"",
                     "\"linear\" with relaxation or history");
}

/// The moment that is asked for: without --at-time the end of the history, or held for long.
void set_time(const FemOptions& options, const input::Case& typed, Plan& plan) {
  const input::ContactTimes& times = typed.times;
  if (!times.are_given()) return;
  refuse_in_time(options, typed);
  plan.time_s =
      times.history.empty() ? std::numeric_limits<double>::infinity() : times.history.back().time_s;
  if (!options.at_time.empty())
    plan.time_s = number_of("--at-time", options.at_time, "a finite number of seconds");
  if (times.history.empty()) return;
  const double value = times.of(0).value(*plan.time_s);
  if (!(value > 0))
    throw InputError("command line", "--at-time", *plan.time_s,
                     "a time at which the history has a load or an approach above 0");
  if (times.drive == ContactHistory::Drive::approach)
    plan.approach_mm = 1e3 * value;
  else
    plan.loads_N = {value};
}

/// A history, or a load that is put on at once and held.
reference::FemProblem::InTime in_time_of(const input::Case& contact_case, double time_s,
                                         double load_N) {
  const input::ContactTimes& times = contact_case.times;
  return {times.relaxation,
          times.history.empty() ? std::vector<HistoryPoint>{{0, load_N}} : times.history, time_s};
}

Plan plan_loads(const FemOptions& options, const input::Case& typed) {
  Plan plan;
  const prediction::GeometryResolver surfaces(typed);
  for (const std::string& line : surfaces.remarks()) remark(line);
  plan.level = options.level > 0 ? options.level : typed.fem_level;
  plan.approach_mm = options.approach_mm;
  plan.loads_N = typed.loads_N;
  set_time(options, typed, plan);
  if (plan.by_approach()) plan.loads_N.resize(1);
  check(options, plan);
  reference::Idealisations idealisations = idealisations_of(options, typed);
  idealisations.linear = idealisations.linear || plan.time_s;
  plan.contact_case =
      reference::with_full_reference(typed, surfaces, idealisations, plan.approach_m());
  plan.curved_by_default = plan.contact_case.fem_curved && !typed.fem_geometry_typed;
  const prediction::GeometryResolver resolver(plan.contact_case, &surfaces);
  // Whether strain matters is only known of elastic contacts.
  plan.is_full =
      !plan.time_s && reference::is_full_reference(plan.contact_case, resolver, plan.approach_m());
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
  problem.approach_m = plan.approach_m();
  if (plan.time_s) problem.in_time = in_time_of(contact_case, *plan.time_s, load_N);
  problem.friction = friction_request(options);
  problem.lists_forces = !options.taxels.array.empty();
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

/// Answers of the program until it ended, failed or was interrupted.
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
    if (!answer.result)
      throw Failed{
          answer.exit_status,
          plan.title(load) + answer.failure +
              (plan.curved_by_default ? " (pressed on the finger itself; --flat takes a flat layer)"
                                      : "")};
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

FemAnswerText answer_of(const Plan& plan, std::size_t load,
                        const reference::ReferenceResult& result) {
  const prediction::LocalGeometry& geometry = plan.geometries[load];
  const Validity validity = reference::theory_limits(plan.contact_case, geometry, result);
  return {plan.contact_case,
          geometry,
          result,
          validity,
          judgement::bound_of({plan.contact_case, geometry, result, plan.is_full, validity.holds(),
                               plan.by_approach() || plan.time_s}),
          plan.approach_m(),
          plan.time_s};
}

/// Layers of the finger at one load, for readings at depth.
LayerStack layers_of(const Plan& plan, std::size_t load) {
  return prediction::contact_problem(plan.contact_case, plan.geometries[load], plan.loads_N[load])
      .finger_layers();
}

void print(const FemOptions& options, const Plan& plan, const SolvedLoads& solved) {
  const std::optional<prediction::TaxelRequest> taxels = options.taxels.request();
  std::vector<prediction::TaxelAnswer> read_by_taxels;
  nlohmann::json results = nlohmann::json::array();
  std::string answers, evidence;
  for (std::size_t load = 0; load < plan.loads_N.size(); ++load) {
    if (!solved.of_load[load]) continue;  // interrupted, or failed, before this load
    const FemAnswerText answer = answer_of(plan, load, *solved.of_load[load]);
    answers += answer_line(answer) + "\n";
    evidence += "\n" + evidence_text(answer);
    results.push_back(to_json(answer));
    if (!taxels) continue;
    read_by_taxels.push_back(
        reference::read_taxels(*solved.of_load[load], layers_of(plan, load), *taxels));
    results.back()["taxels"] = to_json(read_by_taxels.back());
    answers += in_words(read_by_taxels.back());
  }
  if (taxels) options.taxels.write(read_by_taxels);
  if (options.json)
    system::write_to_stdout(
        text::printed(nlohmann::json({{"case", plan.contact_case.id}, {"results", results}})));
  else
    system::write_text_to_stdout(
        answers + "\n" + prediction::describe(plan.contact_case) +
        "\nfinite elements: " + describe_reference(plan.contact_case, plan.level) + "\n" +
        evidence + experiments::noise_remark());
}

int run_fem(const FemOptions& options) {
  const input::Case typed = read_case(options.typed_case);
  if (std::holds_alternative<input::PadPair>(typed.geometry)) {
    refuse_for_pads(options);
    return fem_pad({options.level, options.limit_surface, options.json, options.limits}, typed);
  }
  const std::optional<prediction::TaxelRequest> taxels = options.taxels.request();
  if (!options.at_time.empty()) refuse_time_without_times(typed, options.at_time);
  const Plan plan = plan_loads(options, typed);
  if (taxels) check_taxels(*taxels, plan.contact_case);
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
      "Finite elements of the finger itself, as compare solves them, with their own error; seconds "
      "to minutes");
  add_case(*command, options->typed_case, false, input::FlatPads::taken);
  options->typed_case.times = input::Times::taken;
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
      ->add_option_function<std::string>(
          "--twist-axis-mm",
          [options](const std::string& typed) {
            options->twist_axis_mm =
                numbers_of("--twist-axis-mm", typed, "X,Y: two finite numbers, in mm", 2);
          },
          "X,Y of the twist's axis from the contact's centre, along its long and short "
          "axis (mm), inside the contact; default: the centre")
      ->type_name("X,Y");
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
  command->add_option("--at-time", options->at_time,
                      "of a case with relaxation or history: the time (s), also after the load has "
                      "fallen and risen again; linear and without friction; default: its end, or "
                      "held for long");
  add_taxels(*command, options->taxels, "the finite elements");
  command->add_flag("--linear", options->idealisations.linear,
                    "linear elasticity; default: finite strain where it changes a number by more "
                    "than the elements' stated error");
  command->add_flag("--flat", options->idealisations.flat,
                    "a flat layer under the relative radii; default: the finger itself, where the "
                    "case has one");
  command->add_flag("--json", options->json, "one JSON object, SI units, on standard output");
  add_fem_limits(*command, options->limits);
  command->footer(
      "A case's [fem] geometry and kinematics come before --flat and --linear. ± is the error "
      "against "
      "the\n"
      "finger: of the elements and, on a scan, of what its facets leave open.\n"
      "[fem] mesh = \"layer.msh\" in the case takes a volume mesh of the layer in place of the "
      "flat\n"
      "one: 8-node hexahedra in mm (mesh_unit = \"m\" for metres), physical groups \"layer\" "
      "(volume),\n"
      "\"contact\" and \"core\" (surfaces; core is bonded), +z out of the finger, load along the z "
      "axis.\n"
      "The program softfinger-fem is looked for beside this one, or in SOFTFINGER_FEM_PROGRAM.\n"
      "Samples:\n"
      "  softfinger fem hertz_circle --level 1\n"
      "  softfinger fem pad_on_plane --level 1 --flat --linear\n"
      "  softfinger fem pad_on_sphere --level 1 --torsion --limit-surface 8\n"
      "  softfinger fem pad_on_plane --level 1 --taxels 8,8\n"
      "  softfinger fem hertz_circle --level 1 --output hertz_vtu --json");
  command->callback([options, &action] { action = [options] { return run_fem(*options); }; });
}

}  // namespace softfinger::commands
