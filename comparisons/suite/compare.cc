#include "comparisons/suite/compare.h"

#include <fmt/format.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <tuple>

#include "comparisons/input/case.h"
#include "comparisons/judgement/atlas/error_atlas.h"
#include "comparisons/judgement/next_step.h"
#include "comparisons/prediction/answer_text.h"
#include "comparisons/reference/fem_jobs.h"
#include "comparisons/reference/pad_elements.h"
#include "comparisons/report/report_page.h"
#include "comparisons/suite/pad_report.h"
#include "comparisons/suite/suite_report.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/progress.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::suite {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr double kTolerance = 0.10;
constexpr int kFinestLevel = 3;

/// One load of one case on its way from geometry to reference.
struct LoadRun {
  std::size_t case_index = 0;
  const input::Case* contact_case = nullptr;
  double load_N = 0;
  prediction::LocalGeometry geometry;
  std::optional<prediction::FitPicture> finger_picture, object_picture;
  reference::FemProblem problem;
  fs::path folder;
  std::optional<reference::ReferenceResult> reference;
  std::string failure;

  /// Name of a case with fewer effects than its reference, solved for the ladder; else empty.
  std::string idealised;

  std::string title() const {
    return fmt::format("{} {} N{}", contact_case->id, load_N,
                       idealised.empty() ? "" : ", " + idealised);
  }
};

/// A case's reference, and what the ladder needs beside it.
struct PlannedCase {
  input::Case reference;
  std::optional<input::Case> flat_linear, flat_finite;
};

/// The cases of a run by their kind; flat pads have elements, models and verdicts of their own.
struct Cases {
  std::vector<PlannedCase> curved;
  std::vector<input::Case> pads;

  bool has(const json& id) const {
    return std::any_of(curved.begin(), curved.end(),
                       [&](const PlannedCase& one) { return one.reference.id == id; }) ||
           std::any_of(pads.begin(), pads.end(),
                       [&](const input::Case& one) { return one.id == id; });
  }
};

int level_of(const input::Case& contact_case, const CompareOptions& options) {
  return std::min(kFinestLevel, contact_case.fem_level + (options.full ? 1 : 0));
}

constexpr const char* kFlatLinear = "flat, linear";
constexpr const char* kFlatFinite = "flat, finite strain";

PlannedCase planned(input::Case reference, bool quick) {
  PlannedCase plan{std::move(reference), {}, {}};
  if (quick || !plan.reference.fem_mesh.empty()) return plan;
  input::Case simpler = plan.reference;
  simpler.pressing = PressingFriction::none;
  if (simpler.fem_curved) {
    simpler.fem_curved = false;
    if (simpler.fem_finite) plan.flat_finite = simpler;
  }
  simpler.fem_finite.reset();
  if (plan.reference.fem_curved || plan.reference.fem_finite) plan.flat_linear = simpler;
  return plan;
}

reference::FemJobOptions job_options(const CompareOptions& options) {
  reference::FemJobOptions settings;
  settings.program = system::fem_program().string();
  settings.identity = reference::program_identity(settings.program);
  settings.parallel = options.jobs;
  settings.single_thread = options.jobs > 1;
  settings.limits = options.fem_limits;
  return settings;
}

void say_interrupted(std::size_t done, std::size_t all, const CompareOptions& options,
                     system::Progress& progress) {
  progress.say(
      fmt::format("softfinger: interrupted: {} of {} FEM results are finished in {}; the same "
                  "command continues from there",
                  done, all, (options.output / "fem").string()));
}

/// Runs what is not finished yet. @returns 0 or the signal that interrupted.
int run_pending(const std::vector<LoadRun*>& runs, const CompareOptions& options,
                system::Progress& progress) {
  if (runs.empty()) return 0;
  const reference::FemJobOptions settings = job_options(options);
  // A case's loads share their process, the largest contact first, whose mesh may serve the others.
  std::vector<std::size_t> order(runs.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](std::size_t run) {
    return std::tuple(runs[run]->case_index, runs[run]->idealised, -runs[run]->load_N);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t left, std::size_t right) { return key(left) < key(right); });
  std::vector<reference::FemJob> jobs;
  std::size_t previous = 0;
  for (const std::size_t i : order) {
    reference::FemJob job;
    const LoadRun& run = *runs[i];
    job.title = run.title();
    job.problem = run.problem;
    job.file = run.folder / "result.json";
    if (run.idealised.empty()) job.output_directory = run.folder;
    const bool next = !jobs.empty() && (run.case_index != runs[previous]->case_index ||
                                        run.idealised != runs[previous]->idealised);
    job.group = jobs.empty() ? 0 : jobs.back().group + next;
    previous = i;
    jobs.push_back(std::move(job));
  }
  const auto run_of = [&](const reference::FemJob& job) -> LoadRun& {
    return *runs[order[static_cast<std::size_t>(&job - jobs.data())]];
  };
  const std::vector<const reference::FemJob*> pending = reference::pending_fem_jobs(
      jobs, settings, progress,
      [&](const reference::FemJob& job, reference::ReferenceResult result) {
        run_of(job).reference = std::move(result);
      });
  reference::FemJobProgress shown(progress, jobs.size(), pending, options.jobs);
  std::size_t done = jobs.size() - pending.size();
  const int signal = reference::run_fem_jobs(
      pending, settings,
      [&](const reference::FemJob& job, const std::string& line) { shown.line(job, line); },
      [&](const reference::FemJob& job, const reference::FemAnswer& answer) {
        ++done;
        run_of(job).reference = answer.result;
        run_of(job).failure = answer.failure;
        shown.finished(job, describe(answer));
      });
  if (signal != 0) say_interrupted(done, runs.size(), options, progress);
  return signal;
}

/// The references first: what each idealisation costs is asked only where there is one to compare
/// with. @returns 0 or the signal that interrupted
int run_references_then_idealised(std::vector<LoadRun>& runs, const CompareOptions& options,
                                  system::Progress& progress) {
  std::vector<LoadRun*> references, idealised;
  for (LoadRun& run : runs)
    if (run.idealised.empty()) references.push_back(&run);
  if (const int signal = run_pending(references, options, progress); signal != 0) return signal;
  bool has_reference = false;  // the idealised runs of a load follow it
  for (LoadRun& run : runs) {
    if (run.idealised.empty())
      has_reference = run.reference.has_value();
    else if (has_reference)
      idealised.push_back(&run);
  }
  return run_pending(idealised, options, progress);
}

/// Solves once more, one level finer, what states a larger error than its limits. Where that fails,
/// the coarser result stays. @returns 0 or the signal that interrupted
int refine_doubted(std::vector<LoadRun>& runs, const CompareOptions& options,
                   system::Progress& progress) {
  std::vector<LoadRun> finer;
  std::vector<LoadRun*> doubted;
  for (LoadRun& run : runs) {
    if (!run.idealised.empty() || !run.reference || run.problem.level == kFinestLevel ||
        reference::are_elements_trusted(run.reference->error))
      continue;
    doubted.push_back(&run);
    finer.push_back(run);
    finer.back().reference.reset();
    finer.back().problem.level++;
    // Beside the coarser result, so that the same command finds both finished.
    finer.back().folder += "_finer";
  }
  if (finer.empty()) return 0;
  progress.say(fmt::format(
      "softfinger: {} FEM result{} less accurate than {}: solved once more, one level "
      "finer",
      finer.size(), finer.size() == 1 ? " is" : "s are", reference::trust_limits_in_words()));
  std::vector<LoadRun*> all;
  for (LoadRun& run : finer) all.push_back(&run);
  const int signal = run_pending(all, options, progress);
  for (std::size_t i = 0; i < finer.size(); ++i)
    if (finer[i].reference) *doubted[i] = std::move(finer[i]);
  return signal;
}

void say_remarks(const input::Case& pad, system::Progress& progress) {
  for (const std::string& remark : pad.remarks) progress.say("softfinger: " + remark);
  if (const auto remark = reference::elements_remark(pad)) progress.say("softfinger: " + *remark);
}

/// The elements of all loads of all pads, by case. @returns 0 or the signal that interrupted
int run_pads(const std::vector<input::Case>& pads, const CompareOptions& options,
             system::Progress& progress,
             std::vector<std::vector<reference::PadSolution>>& solutions) {
  std::vector<reference::PadJob> jobs;
  std::vector<reference::PadSolution*> solution_of;
  solutions.clear();
  for (const input::Case& pad : pads) solutions.emplace_back(pad.loads_N.size());
  for (std::size_t i = 0; i < pads.size(); ++i)
    for (std::size_t load = 0; load < pads[i].loads_N.size(); ++load) {
      const double load_N = pads[i].loads_N[load];
      jobs.push_back(
          {fmt::format("{} {} N", pads[i].id, load_N),
           reference::pad_problem(pads[i], load_N, level_of(pads[i], options), 0),
           options.output / "fem" / reference::load_folder(pads[i].id, load_N) / "result.json", i});
      solution_of.push_back(&solutions[i][load]);
    }
  if (jobs.empty()) return 0;
  std::size_t done = 0;
  const int signal =
      reference::run_pad_jobs(jobs, job_options(options), progress,
                              [&](const reference::PadJob& job, reference::PadSolution solution) {
                                ++done;
                                *solution_of[std::size_t(&job - jobs.data())] = std::move(solution);
                              });
  if (signal != 0) say_interrupted(done, jobs.size(), options, progress);
  return signal;
}

/// Cases of a report that is there already and that a new one would leave out.
std::vector<std::string> cases_left_out(const fs::path& report_file, const Cases& cases) {
  std::vector<std::string> ids;
  std::ifstream file(report_file);
  const json report =
      file ? text::parse_json(std::string(std::istreambuf_iterator<char>(file), {})) : json();
  if (!report.is_object() || !report.contains("cases") || !report["cases"].is_array()) return ids;
  for (const json& entry : report["cases"])
    if (entry.is_object() && entry.contains("id") && entry["id"].is_string() &&
        !cases.has(entry["id"]))
      ids.push_back(entry["id"]);
  return ids;
}

/// @throws InputError also where two cases share an id
Cases read_cases(const std::vector<fs::path>& files, const CompareOptions& options) {
  Cases cases;
  std::map<std::string, std::string> file_of_id;
  for (const fs::path& file : files) {
    input::Case typed =
        input::read_case(file, options.settings, input::FlatPads::taken, input::Times::taken);
    input::refuse_times(typed, "softfinger compare");
    input::require_coulomb(typed, "compare");
    // A line has a model to be judged; what else is curved has the elements alone.
    if (const auto* pad = std::get_if<input::PadPair>(&typed.geometry);
        pad && pad->curved && !pad->curved->is_cylinder())
      input::refuse_curved_pad(typed, "softfinger compare");
    if (std::holds_alternative<input::PadPair>(typed.geometry)) {
      cases.pads.push_back(typed);
    } else {
      const prediction::GeometryResolver geometry(typed);
      cases.curved.push_back(planned(
          reference::with_full_reference(typed, geometry, options.idealisations), options.quick));
    }
    const auto [entry, is_new] = file_of_id.emplace(typed.id, file.string());
    if (!is_new)
      throw InputError(file.string(), "id", typed.id,
                       "an id of its own; " + entry->second + " has the same");
  }
  return cases;
}

std::optional<prediction::FitPicture> picture_of(const prediction::GeometryResolver& resolver,
                                                 const input::Case& contact_case,
                                                 input::CaseBody input::BodyPair::*body,
                                                 const prediction::LocalGeometry& geometry,
                                                 std::optional<QuadricFit> ContactPatch::*fit) {
  const auto* pair = std::get_if<input::BodyPair>(&contact_case.geometry);
  const auto* mesh = pair ? std::get_if<input::MeshBody>(&(pair->*body)) : nullptr;
  if (!mesh || !geometry.patch || !((*geometry.patch).*fit)) return std::nullopt;
  return prediction::picture_of(resolver.surface(*mesh), *((*geometry.patch).*fit));
}

/// All loads of all cases, checked.
std::vector<LoadRun> plan_runs(const std::vector<PlannedCase>& cases, const CompareOptions& options,
                               system::Progress& progress) {
  std::vector<LoadRun> runs;
  for (const PlannedCase& plan : cases) {
    const input::Case& contact_case = plan.reference;
    const prediction::GeometryResolver geometry(contact_case);
    for (const auto& remarks : {contact_case.remarks, geometry.remarks()})
      for (const std::string& remark : remarks) progress.say("softfinger: " + remark);
    for (double load_N : contact_case.loads_N) {
      LoadRun run;
      run.case_index = std::size_t(&plan - cases.data());
      run.load_N = load_N;
      run.geometry = judgement::resolve_or_advise(contact_case, geometry, load_N);
      run.finger_picture = picture_of(geometry, contact_case, &input::BodyPair::finger,
                                      run.geometry, &ContactPatch::finger_fit);
      run.object_picture = picture_of(geometry, contact_case, &input::BodyPair::object,
                                      run.geometry, &ContactPatch::object_fit);
      const auto add = [&](const input::Case& solved, const char* idealised, const char* suffix) {
        run.contact_case = &solved;
        run.idealised = idealised;
        run.problem =
            reference::fem_problem(solved, run.geometry, load_N, level_of(solved, options));
        run.folder = options.output / "fem" / (reference::load_folder(solved.id, load_N) + suffix);
        runs.push_back(run);
      };
      add(contact_case, "", "");
      if (plan.flat_linear) add(*plan.flat_linear, kFlatLinear, "_flat_linear");
      if (plan.flat_finite) add(*plan.flat_finite, kFlatFinite, "_flat_finite");
    }
  }
  return runs;
}

void say_what_is_replaced(const Cases& cases, const fs::path& output, system::Progress& progress) {
  const auto ids = cases_left_out(output / "report.json", cases);
  if (ids.empty()) return;
  progress.say(fmt::format(
      "softfinger: the report in {} will be replaced by one without {}{}; another --output keeps "
      "it",
      output.string(), ids.front(),
      ids.size() > 1 ? fmt::format(" and {} more", ids.size() - 1) : ""));
}

SuiteComparison compare_all(const std::vector<PlannedCase>& cases, std::vector<LoadRun> runs) {
  SuiteComparison suite;
  suite.tolerance = kTolerance;
  auto run = runs.begin();
  for (std::size_t i = 0; i < cases.size(); ++i) {
    std::vector<judgement::Comparison> loads;
    while (run != runs.end() && run->case_index == i) {
      loads.push_back(judgement::compare(cases[i].reference, run->geometry, run->load_N,
                                         std::move(run->reference), run->failure));
      loads.back().folder = run->folder.filename().string();
      loads.back().finger_picture = std::move(run->finger_picture);
      loads.back().object_picture = std::move(run->object_picture);
      judgement::IdealisedReferences idealised;
      for (++run; run != runs.end() && !run->idealised.empty(); ++run)
        (run->idealised == kFlatLinear ? idealised.flat_linear : idealised.flat_finite) =
            std::move(run->reference);
      loads.back().ladder = judgement::make_ladder(loads.back(), idealised);
    }
    suite.cases.push_back(
        judgement::compare_case(cases[i].reference, std::move(loads), kTolerance));
  }
  return suite;
}

void compare_pads(const std::vector<input::Case>& pads,
                  std::vector<std::vector<reference::PadSolution>> solutions,
                  SuiteComparison& suite) {
  for (std::size_t i = 0; i < pads.size(); ++i)
    suite.pads.push_back(judgement::compare_pad(pads[i], std::move(solutions[i]), kTolerance));
}

std::vector<judgement::CaseErrors> errors_of(const SuiteComparison& suite) {
  std::vector<judgement::CaseErrors> cases;
  for (const judgement::CaseComparison& compared : suite.cases) {
    judgement::CaseErrors& errors = cases.emplace_back();
    errors.id = compared.contact_case->id;
    errors.poisson_ratio = compared.contact_case->layer.poisson_ratio;
    for (const judgement::Comparison& load : compared.loads)
      errors.loads.push_back(judgement::errors_of(load));
  }
  return cases;
}

void write_report(const SuiteComparison& suite, const fs::path& output) {
  json report = report_json(suite);
  const std::string text = text::printed(report);
  report.update(page_json(suite));
  system::write_files_together(
      {{output / "results.csv", results_csv(suite)},
       {output / "report.json", text},
       {output / "report.html", report::render_report(report, errors_of(suite))}});
}

json answer_as_json(const SuiteComparison& suite, const fs::path& output) {
  json cases = json::array(), results = json::array();
  for (const judgement::CaseComparison& compared : suite.cases) {
    cases.push_back({{"id", compared.contact_case->id}, {"verdict", compared.verdict.sentence}});
    for (const judgement::Comparison& load : compared.loads)
      for (const json& one : results_json(load, suite.tolerance)) results.push_back(one);
  }
  for (const judgement::PadCaseComparison& compared : suite.pads) {
    cases.push_back({{"id", compared.contact_case->id}, {"verdict", compared.verdict.sentence}});
    for (const json& one : pad_results_json(compared)) results.push_back(one);
  }
  return {{"cases", cases},
          {"results", results},
          {"tolerance", suite.tolerance},
          {"trusted", is_trusted_everywhere(suite)},
          {"report", fs::absolute(output / "report.html").string()},
          {"numbers", fs::absolute(output / "report.json").string()}};
}

std::string answer_in_words(const SuiteComparison& suite, const fs::path& output) {
  std::string answer;
  for (const judgement::CaseComparison& compared : suite.cases)
    answer += fmt::format("{}: {}\n", compared.contact_case->id, compared.verdict.sentence);
  for (const judgement::PadCaseComparison& compared : suite.pads)
    answer += fmt::format("{}: {}\n", compared.contact_case->id, compared.verdict.sentence);
  if (!is_trusted_everywhere(suite))
    answer += fmt::format(
        "At least one FEM result failed, is less accurate than its stated limits ({}), or its mesh "
        "leaves more than {:g} % open.\n",
        reference::trust_limits_in_words(), 100 * reference::kTrustLimits.geometry);
  return answer + fmt::format("Report: {}\n", fs::absolute(output / "report.html").string());
}

}  // namespace

int default_job_count() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  const int count = sched_getaffinity(0, sizeof cores, &cores) == 0 ? CPU_COUNT(&cores) : 1;
  // Each process takes up to 2 GB for a long contact: more of them would need more memory than a
  // usual machine has.
  return std::clamp(count, 1, 8);
}

int compare(const CompareOptions& options) {
  const auto start = Clock::now();
  const Cases cases = read_cases(options.case_files, options);
  system::Progress progress;
  std::vector<LoadRun> runs = plan_runs(cases.curved, options, progress);
  for (const input::Case& pad : cases.pads) say_remarks(pad, progress);
  // These refuse before anything is written.
  system::fem_program();
  judgement::error_atlas();
  judgement::finite_strain_atlas();
  const system::OutputFolder output(options.output);
  // After all that may be refused in a single line.
  say_what_is_replaced(cases, options.output, progress);
  for (const PlannedCase& plan : cases.curved)
    for (const std::string& remark : prediction::power_law_remarks(plan.reference))
      progress.say("softfinger: " + plan.reference.id + ": " + remark);
  int signal = run_references_then_idealised(runs, options, progress);
  if (signal == 0) signal = refine_doubted(runs, options, progress);
  std::vector<std::vector<reference::PadSolution>> pad_solutions;
  if (signal == 0) signal = run_pads(cases.pads, options, progress, pad_solutions);
  if (signal != 0) return 128 + signal;

  SuiteComparison suite = compare_all(cases.curved, std::move(runs));
  compare_pads(cases.pads, std::move(pad_solutions), suite);
  suite.command = options.command;
  suite.cores = default_job_count();
  suite.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  write_report(suite, options.output);
  if (options.json)
    system::write_to_stdout(text::printed(answer_as_json(suite, options.output)));
  else
    system::write_text_to_stdout(answer_in_words(suite, options.output));
  return is_trusted_everywhere(suite) ? 0 : 1;
}

}  // namespace softfinger::suite
