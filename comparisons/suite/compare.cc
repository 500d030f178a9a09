#include "comparisons/suite/compare.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/utsname.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "comparisons/input/case.h"
#include "comparisons/judgement/atlas/atlas_overview.h"
#include "comparisons/judgement/verdict.h"
#include "comparisons/prediction/local_geometry.h"
#include "comparisons/prediction/predict.h"
#include "comparisons/reference/fem_jobs.h"
#include "comparisons/reference/fem_process.h"
#include "comparisons/reference/finished_results.h"
#include "comparisons/report/report_page.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/progress.h"
#include "comparisons/text/csv.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"

namespace softfinger::suite {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;
using nlohmann::json;

constexpr double kTolerance = 0.10;
constexpr double kCostBudget_ns = 1e5;  // per model and load: milliseconds for the whole suite

std::string dump(const json& value) {
  // A command line may hold bytes that are no UTF-8: a report must not fail on them.
  return value.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

/// One load of one case on its way from geometry to result.
struct LoadRun {
  const input::Case* contact_case = nullptr;
  double load_N = 0;
  prediction::LocalGeometry geometry;
  json problem;
  fs::path folder;
  json fem;  ///< null until it is there
  std::string failure;
  bool reused = false;

  std::string title() const { return fmt::format("{} {} N", contact_case->id, load_N); }
};

/// Runs what is not finished yet. @returns 0 or the signal that interrupted.
int run_pending(std::vector<LoadRun>& runs, const CompareOptions& options,
                system::Progress& progress) {
  reference::FemJobOptions settings;
  settings.program = system::fem_program().string();
  settings.identity = reference::program_identity(settings.program);
  settings.parallel = options.jobs;
  settings.single_thread = options.jobs > 1;
  settings.limits = options.fem_limits;
  // A case's loads share their process, the largest contact first, whose mesh may serve the others.
  std::vector<std::size_t> order(runs.size());
  std::iota(order.begin(), order.end(), 0);
  const auto case_of = [&](std::size_t run) {
    return runs[run].contact_case - runs[0].contact_case;
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t left, std::size_t right) {
    return std::pair(case_of(left), -runs[left].load_N) <
           std::pair(case_of(right), -runs[right].load_N);
  });
  std::vector<reference::FemJob> jobs;
  for (const std::size_t i : order) {
    reference::FemJob job;
    job.title = runs[i].title();
    job.problem = runs[i].problem;
    job.file = runs[i].folder / "result.json";
    job.output_directory = runs[i].folder;
    job.group = static_cast<std::size_t>(case_of(i));
    jobs.push_back(std::move(job));
  }
  const auto run_of = [&](const reference::FemJob& job) -> LoadRun& {
    return runs[order[static_cast<std::size_t>(&job - jobs.data())]];
  };
  const std::vector<const reference::FemJob*> pending = reference::pending_fem_jobs(
      jobs, settings, progress, [&](const reference::FemJob& job, json result) {
        run_of(job).fem = std::move(result);
        run_of(job).reused = true;
      });
  reference::FemJobProgress shown(progress, jobs.size(), pending.size());
  std::size_t done = jobs.size() - pending.size();
  const int signal = reference::run_fem_jobs(
      pending, settings,
      [&](const reference::FemJob& job, const std::string& line) { shown.line(job, line); },
      [&](const reference::FemJob& job, const reference::FemAnswer& answer) {
        ++done;
        run_of(job).fem = answer.result;
        run_of(job).failure = answer.failure;
        shown.finished(job, describe(answer));
      });
  if (signal != 0)
    progress.say(
        fmt::format("softfinger: interrupted: {} of {} FEM results are finished in {}; the same "
                    "command continues from there",
                    done, runs.size(), (options.output / "fem").string()));
  return signal;
}

/// Whether a profile of the model's pressure may be drawn without being felt: some models solve
/// their problem anew for a point of it.
bool has_cheap_pressure(const prediction::ModelAnswer& answer) {
  constexpr double kAffordable_ms = 2;
  if (answer.model->card().hot_path) return true;
  const auto start = Clock::now();
  answer.model->pressure_Pa(answer.problem, answer.prediction, 0, 0);
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count() < kAffordable_ms;
}

json model_profile(const prediction::ModelAnswer& answer, bool along_x) {
  constexpr int kPoints = 61;
  json position = json::array(), pressure = json::array();
  const double end_m = along_x ? answer.prediction.a_m : answer.prediction.b_m;
  for (int i = 0; i < kPoints; ++i) {
    // Denser towards the edge, where a Hertz pressure falls steeply.
    const double x_m = end_m * std::sin(1.57079632679489662 * i / (kPoints - 1));
    position.push_back(x_m);
    pressure.push_back(answer.model->pressure_Pa(answer.problem, answer.prediction,
                                                 along_x ? x_m : 0, along_x ? 0 : x_m));
  }
  return {{"position_m", position}, {"pressure_Pa", pressure}};
}

json model_json(const prediction::ModelAnswer& answer, const json& fem) {
  json result = to_json(answer, prediction::TorqueRule::exact, 0);
  result.erase("load_N");
  result.erase("error_estimate");
  const bool has_answer = answer.prediction.has_answer;
  const double paper_Nm = answer.friction_ellipsoid(prediction::TorqueRule::paper).max_torque_Nm();
  result["has_answer"] = has_answer;
  result["max_torque_paper_Nm"] = has_answer ? text::finite_or_null(paper_Nm) : json();
  result["relative_error"] = nullptr;
  result["profile_x"] = result["profile_y"] = nullptr;
  if (!has_answer) return result;
  if (has_cheap_pressure(answer)) {
    result["profile_x"] = model_profile(answer, true);
    result["profile_y"] = model_profile(answer, false);
  }
  if (fem.is_null()) return result;
  json& errors = result["relative_error"] = json::object();
  const auto compare_key = [&](const char* name, const char* model_key, const char* fem_key) {
    const double true_value = fem.at(fem_key).get<double>();
    errors[name] =
        result[model_key].is_number()
            ? text::finite_or_null((result[model_key].get<double>() - true_value) / true_value)
            : json();
  };
  compare_key("a", "a_m", "a_m");
  compare_key("b", "b_m", "b_m");
  compare_key("area", "area_m2", "area_m2");
  compare_key("indentation", "indentation_m", "indentation_m");
  compare_key("peak_pressure", "peak_pressure_Pa", "peak_pressure_Pa");
  compare_key("max_torque", "max_torque_Nm", "max_torque_Nm");
  compare_key("max_torque_paper", "max_torque_paper_Nm", "max_torque_Nm");
  return result;
}

json load_json(const LoadRun& run, const fs::path& output, judgement::LoadErrors& errors) {
  const input::Case& contact_case = *run.contact_case;
  json geometry = {{"radii_m", {run.geometry.radii.major_m, run.geometry.radii.minor_m}},
                   {"radii_std_m", nullptr},
                   {"axis_rad", run.geometry.radii.axis_rad},
                   {"s", nullptr},
                   {"patch", prediction::patch_to_json(run.geometry)}};
  if (run.geometry.patch) {
    const auto& deviations = run.geometry.patch->relative.radii_std_m;
    geometry["radii_std_m"] = {text::finite_or_null(deviations[0]),
                               text::finite_or_null(deviations[1])};
  }
  json fem = run.fem;
  errors.load_N = run.load_N;
  errors.fem_finished = !fem.is_null();
  errors.fem_failure = run.failure;
  if (errors.fem_finished) {
    geometry["s"] = std::sqrt(fem["a_m"].get<double>() * fem["b_m"].get<double>()) /
                    contact_case.layer.thickness_m;
    fem["trusted"] = errors.fem_trusted = reference::fem_is_trusted(fem);
    // The page lies in the output folder: links from it must not depend on where that folder is.
    const fs::path folder = run.folder.lexically_relative(output);
    if (fem.contains("vtu") && fem["vtu"].is_string())
      fem["vtu"] = (folder / fs::path(fem["vtu"].get<std::string>()).filename()).generic_string();
    else
      fem["vtu"] = nullptr;
  }
  json models = json::array();
  for (const PressureModel* model : all_pressure_models()) {
    if (model->card().finite_strain && !contact_case.fem_finite) continue;
    const prediction::ModelAnswer answer =
        prediction::ask_model(*model, contact_case, run.geometry.radii, run.load_N, kCostBudget_ns);
    models.push_back(model_json(answer, run.fem));
    judgement::ModelError error;
    error.model = model->card().name;
    error.has_answer = answer.prediction.has_answer;
    error.valid = answer.prediction.valid();
    error.hot_path = model->card().hot_path;
    // Nobody asked for a measured law: that there is none is no verdict on it.
    error.applicable =
        std::string_view(answer.prediction.validity.begin()->check) != "power_law_known";
    const json& relative = models.back()["relative_error"];
    if (relative.is_object() && relative["area"].is_number() &&
        relative["max_torque"].is_number()) {
      error.area = relative["area"];
      error.max_torque = relative["max_torque"];
    }
    errors.models.push_back(error);
  }
  json result = {{"load_N", run.load_N}, {"geometry", geometry}, {"fem", fem}, {"models", models}};
  if (!errors.fem_finished) result["fem_failure"] = run.failure;
  return result;
}

std::string machine_name() {
  utsname system = {};
  uname(&system);
  std::string processor = system.machine;
  std::ifstream information("/proc/cpuinfo");
  for (std::string line; std::getline(information, line);)
    if (line.rfind("model name", 0) == 0 && line.find(": ") != std::string::npos) {
      processor = line.substr(line.find(": ") + 2);
      break;
    }
  return fmt::format("{}, {} {}", processor, system.sysname, system.machine);
}

json provenance(const CompareOptions& options, double wall_s, const std::vector<LoadRun>& runs) {
  const std::time_t now = std::time(nullptr);
  char date[32] = "";
  std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
  json peak_memory_MB;
  for (const LoadRun& run : runs)
    if (run.fem.is_object() && run.fem.contains("peak_memory_MB") &&
        run.fem["peak_memory_MB"].is_number() &&
        (peak_memory_MB.is_null() || run.fem["peak_memory_MB"] > peak_memory_MB))
      peak_memory_MB = run.fem["peak_memory_MB"];
  return {{"version", system::program_version()},
          {"date", date},
          {"compiler", SOFTFINGER_COMPILER},
          {"build_type", SOFTFINGER_BUILD_TYPE},
          {"machine", machine_name()},
          {"cores", default_job_count()},
          {"command", options.command},
          {"wall_s", wall_s},
          {"peak_memory_MB", peak_memory_MB}};
}

json model_cards() {
  json cards = json::array();
  for (const PressureModel* model : all_pressure_models()) {
    const ModelCard& card = model->card();
    cards.push_back({{"name", card.name},
                     {"title", card.title},
                     {"assumptions", card.assumptions},
                     {"equations", card.equations},
                     {"source", card.source},
                     {"validity", card.validity},
                     {"cost", card.cost}});
  }
  return cards;
}

/// Cases of a report that is there already and that a new one would leave out.
std::vector<std::string> cases_left_out(const fs::path& report_file,
                                        const std::map<std::string, std::string>& file_of_id) {
  std::vector<std::string> ids;
  std::ifstream file(report_file);
  const json report =
      file ? text::parse_json(std::string(std::istreambuf_iterator<char>(file), {})) : json();
  if (!report.is_object() || !report.contains("cases") || !report["cases"].is_array()) return ids;
  for (const json& entry : report["cases"])
    if (entry.is_object() && entry.contains("id") && entry["id"].is_string() &&
        !file_of_id.count(entry["id"]))
      ids.push_back(entry["id"]);
  return ids;
}

/// One row per case, load and model, FEM first; empty where a number does not exist. Models have
/// relative errors against FEM, FEM has the errors that it states itself.
std::string results_csv(const json& report) {
  static const char* const kNumbers[] = {
      "a_m",     "b_m",           "axis_rad",      "indentation_m", "peak_pressure_Pa",
      "area_m2", "max_torque_Nm", "eccentricity_m"};
  static const char* const kErrors[] = {"a",         "b", "area", "indentation", "peak_pressure",
                                        "max_torque"};
  std::string csv =
      "case,load_N,thickness_m,youngs_modulus_Pa,poisson_ratio,friction_coefficient,"
      "radius_major_m,radius_minor_m,model,valid";
  for (const char* key : kNumbers) csv += std::string(",") + key;
  csv += ",max_torque_paper_Nm";
  for (const char* key : kErrors) csv += std::string(",relative_error_") + key;
  for (const char* key : kErrors) csv += std::string(",stated_error_") + key;
  csv += ",cost_ns,wall_s\n";
  const auto cell = [](const json& object, const char* key) {
    return object.is_object() && object.contains(key) && object[key].is_number()
               ? "," + object[key].dump()
               : std::string(",");
  };
  for (const json& entry : report["cases"])
    for (const json& load : entry["loads"]) {
      const auto row = [&](const json& values, const std::string& valid, const json& relative,
                           const json& stated) {
        csv += text::csv_cell(entry["id"].get<std::string>()) + cell(load, "load_N") +
               cell(entry["layer"], "thickness_m") + cell(entry["layer"], "youngs_modulus_Pa") +
               cell(entry["layer"], "poisson_ratio") + cell(entry, "friction_coefficient");
        for (const json& radius : load["geometry"]["radii_m"]) csv += "," + radius.dump();
        csv += "," + text::csv_cell(values["model"].get<std::string>()) + "," + valid;
        for (const char* key : kNumbers) csv += cell(values, key);
        csv += cell(values, "max_torque_paper_Nm");
        for (const char* key : kErrors) csv += cell(relative, key);
        for (const char* key : kErrors) csv += cell(stated, key);
        csv += cell(values, "cost_ns") + cell(values, "wall_s") + "\n";
      };
      if (load["fem"].is_object()) {
        json fem = load["fem"];
        fem["model"] = "fem";
        row(fem, fem["trusted"].get<bool>() ? "yes" : "no", nullptr, fem["error"]);
      }
      for (const json& model : load["models"])
        row(model, model["valid"].get<bool>() ? "yes" : "no", model["relative_error"], nullptr);
    }
  return csv;
}

/// The atlas with the contacts of all runs, and of the seed's fingertips, marked; null without one.
json atlas_with_marks(const std::vector<LoadRun>& runs) {
  json atlas = judgement::atlas_overview(judgement::error_atlas().file());
  if (atlas.is_null()) return atlas;
  json& marks = atlas["marks"] = judgement::seed_marks();
  for (const LoadRun& run : runs)
    if (json mark = judgement::map_mark(*run.contact_case,
                                        run.contact_case->problem(run.geometry.radii, run.load_N));
        mark["seed"] == false)
      marks.push_back(std::move(mark));
  return atlas;
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
  std::vector<input::Case> cases;
  std::map<std::string, std::string> file_of_id;
  for (const fs::path& file : options.case_files) {
    cases.push_back(input::read_case(file));
    const auto [entry, is_new] = file_of_id.emplace(cases.back().id, file.string());
    if (!is_new)
      throw InputError(file.string(), "id", cases.back().id,
                       "an id of its own; " + entry->second + " has the same");
  }
  system::Progress progress;
  std::vector<LoadRun> runs;
  for (const input::Case& contact_case : cases) {
    const prediction::GeometryResolver geometry(contact_case);
    for (const std::string& remark : geometry.remarks()) progress.say("softfinger: " + remark);
    for (double load_N : contact_case.loads_N) {
      LoadRun run;
      run.contact_case = &contact_case;
      run.load_N = load_N;
      run.geometry = geometry.resolve(load_N);
      run.problem =
          reference::fem_problem(contact_case, run.geometry, load_N,
                                 std::min(3, contact_case.fem_level + (options.full ? 1 : 0)));
      run.folder = options.output / "fem" / reference::load_folder(contact_case.id, load_N);
      runs.push_back(std::move(run));
    }
  }
  // Both refuse before anything is written.
  system::fem_program();
  judgement::error_atlas();
  judgement::finite_strain_atlas();
  const system::OutputFolder output(options.output);
  // After all that may be refused in a single line.
  if (const auto ids = cases_left_out(options.output / "report.json", file_of_id); !ids.empty())
    progress.say(fmt::format(
        "softfinger: the report in {} will be replaced by one without {}{}; another --output keeps "
        "it",
        options.output.string(), ids.front(),
        ids.size() > 1 ? fmt::format(" and {} more", ids.size() - 1) : ""));
  for (const input::Case& contact_case : cases)
    for (const std::string& remark : prediction::power_law_remarks(contact_case))
      progress.say("softfinger: " + contact_case.id + ": " + remark);
  if (const int signal = run_pending(runs, options, progress)) return 128 + signal;

  json report = {{"tolerance", kTolerance}, {"models", model_cards()}, {"cases", json::array()}};
  std::string answer;
  bool all_trusted = true;
  std::size_t next = 0;
  for (const input::Case& contact_case : cases) {
    std::vector<judgement::LoadErrors> errors;
    json loads = json::array();
    for (std::size_t i = 0; i < contact_case.loads_N.size(); ++i) {
      errors.emplace_back();
      loads.push_back(load_json(runs[next++], options.output, errors.back()));
      all_trusted = all_trusted && errors.back().fem_trusted;
    }
    const judgement::Verdict verdict = judgement::compose_verdict(errors, kTolerance);
    json sublayers = json::array();
    for (const input::Sublayer& sublayer : contact_case.sublayers) {
      sublayers.push_back(prediction::layer_json(sublayer.layer));
      sublayers.back()["name"] = sublayer.name;
    }
    report["cases"].push_back({{"id", contact_case.id},
                               {"question", contact_case.question},
                               {"verdict", verdict.sentence},
                               {"verdict_class", verdict.verdict_class},
                               {"file", contact_case.file.filename().string()},
                               {"case_toml", contact_case.text},
                               {"layer", prediction::layer_json(contact_case.layer)},
                               {"sublayers", sublayers},
                               {"friction_coefficient", contact_case.friction_coefficient},
                               {"loads", loads}});
    answer += fmt::format("{}: {}\n", contact_case.id, verdict.sentence);
  }
  const double wall_s = std::chrono::duration<double>(Clock::now() - start).count();
  report["provenance"] = provenance(options, wall_s, runs);

  const std::string text = dump(report);
  // The page only: the numbers are the program's own, and the same in every report.
  report["atlas"] = atlas_with_marks(runs);
  report["finite_strain"] =
      judgement::finite_strain_overview(judgement::finite_strain_atlas().file());
  system::write_files_together({{options.output / "results.csv", results_csv(report)},
                                {options.output / "report.json", text},
                                {options.output / "report.html", report::render_report(report)}});
  if (!all_trusted)
    answer +=
        "At least one FEM result failed or is less accurate than its stated limits (2 % in a and "
        "b, "
        "1 % in indentation and torque).\n";
  answer += fmt::format("Report: {}\n", fs::absolute(options.output / "report.html").string());
  system::write_text_to_stdout(answer);
  return all_trusted ? 0 : 1;
}

}  // namespace softfinger::suite
