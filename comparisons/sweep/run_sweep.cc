#include "comparisons/sweep/run_sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <exception>
#include <fstream>
#include <map>
#include <mutex>
#include <string_view>
#include <thread>

#include "comparisons/input/mesh_file.h"
#include "comparisons/report/sweep_page.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/system/progress.h"
#include "comparisons/text/json_text.h"
#include "meshes/io/input_files.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/hash.h"

namespace softfinger::sweep {
namespace fs = std::filesystem;
using nlohmann::json;

namespace {

/// Points that a thread computes at a time: enough that handing them out costs nothing, few enough
/// that the rows that wait to be written need little memory.
constexpr std::size_t kPointsPerChunk = 500;

// A global, because a signal handler cannot reach anything else.
volatile std::sig_atomic_t g_signal = 0;

/// While it exists, SIGINT and SIGTERM only set `g_signal`.
class SignalFlag {
 public:
  SignalFlag() {
    g_signal = 0;
    for (const int number : {SIGINT, SIGTERM}) std::signal(number, [](int n) { g_signal = n; });
  }
  ~SignalFlag() {
    for (const int number : {SIGINT, SIGTERM}) std::signal(number, SIG_DFL);
  }
};

/// Threads finish chunks in any order. They wait here, a limited number of them, until they can be
/// written in order.
class ChunkQueue {
 public:
  ChunkQueue(std::size_t chunks, std::size_t longest) : chunks_(chunks), longest_(longest) {}

  /// Gives a worker the next chunk to compute. False when there is none or the sweep has been
  /// stopped.
  bool take(std::size_t& chunk) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock,
                  [&] { return stopped_ || next_ >= chunks_ || next_ < written_ + longest_; });
    if (stopped_ || next_ >= chunks_) return false;
    chunk = next_++;
    return true;
  }
  void put(std::size_t chunk, std::string text) {
    const std::lock_guard lock(mutex_);
    done_[chunk] = std::move(text);
    changed_.notify_all();
  }
  void fail(std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = error;
    stopped_ = true;
    changed_.notify_all();
  }
  void stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }
  /// Gives the writer the next chunk in order. False when it is not finished within a tenth of a
  /// second.
  bool wait_for_next(std::string& text) {
    std::unique_lock lock(mutex_);
    // With a time limit, because the writer has to look for signals in between.
    changed_.wait_for(lock, std::chrono::milliseconds(100),
                      [&] { return error_ || done_.count(written_) > 0; });
    if (error_) std::rethrow_exception(error_);
    const auto found = done_.find(written_);
    if (found == done_.end()) return false;
    text = std::move(found->second);
    done_.erase(found);
    ++written_;
    changed_.notify_all();
    return true;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t chunks_, longest_, next_ = 0, written_ = 0;
  std::map<std::size_t, std::string> done_;
  std::exception_ptr error_;
  bool stopped_ = false;
};

/// A hash of each file that the case names, and of the surface that is made of a mesh: it is also
/// that of the files which the mesh names, such as a glTF's buffers.
json contents_of(const input::Case& contact_case) {
  json contents = json::object();
  const auto add = [&](const fs::path& file) {
    if (!file.empty()) contents[file.string()] = meshes::content_hash(file.string());
  };
  const auto add_mesh = [&](const fs::path& file, const std::string& part) {
    add(file);
    const fs::path surface = file.empty() ? file : input::plain_mesh_file(file, part);
    if (surface != file)
      contents[file.string() + ", surface " + part] = meshes::content_hash(surface.string());
  };
  if (const auto* pair = std::get_if<input::BodyPair>(&contact_case.geometry))
    for (const input::CaseBody* body : {&pair->finger, &pair->object})
      if (const auto* mesh = std::get_if<input::MeshBody>(body)) {
        add_mesh(mesh->path, mesh->part);
        add_mesh(mesh->core, mesh->core_part);
      }
  add(contact_case.fem_mesh);
  return contents;
}

/// Existing rows belong to this sweep if all of this is the same.
json identity_of(const SweepPlan& plan, const std::string& header) {
  return {{"program", reference::program_identity("/proc/self/exe")},
          {"sweep_toml", plan.sweep.text()},
          {"files", contents_of(plan.sweep.base())},
          {"rows", plan.sweep.rows()},
          {"tolerance", plan.demand.tolerance},
          {"quantities", plan.demand.quantities},
          {"columns", header}};
}

/// The sweep's answer in one line.
struct LeadingModel {
  std::string name;        ///< empty where no model is usable in any row
  std::size_t usable = 0;  ///< the number of rows in which it is
  double least_torque_Nm = INFINITY, largest_torque_Nm = -INFINITY;  ///< of these rows
};

/// The model that is recommended for the contact of the sweep's own case, by which `predict` would
/// answer it. If it is not among the sweep's or is usable nowhere, the one that is usable in the
/// most rows.
LeadingModel leading_model(const SweepPlan& plan) {
  std::vector<LeadingModel> leads(plan.contact->models().size());
  std::vector<std::size_t> torques(leads.size()), words(leads.size());
  std::ifstream file(plan.output / "results.csv");
  std::string line;
  std::getline(file, line);
  // The failure alone can be quoted, and it is last.
  const auto split = [](std::string_view text, std::vector<std::string_view>& cells) {
    cells.clear();
    for (std::size_t start = 0; start <= text.size();) {
      const std::size_t end = std::min(text.find(',', start), text.size());
      cells.push_back(text.substr(start, end - start));
      start = end + 1;
    }
  };
  std::vector<std::string_view> cells;
  split(line, cells);
  for (std::size_t i = 0; i < leads.size(); ++i) {
    leads[i].name = plan.contact->models()[i]->name;
    const auto column = [&](const char* name) {
      return std::size_t(std::find(cells.begin(), cells.end(), leads[i].name + name) -
                         cells.begin());
    };
    torques[i] = column("_max_torque_Nm");
    words[i] = column("_usable");
  }
  for (std::string row; std::getline(file, row);) {
    split(row, cells);
    for (std::size_t i = 0; i < leads.size(); ++i) {
      if (std::max(words[i], torques[i]) >= cells.size() || cells[words[i]] != "yes") continue;
      const double torque_Nm = std::strtod(std::string(cells[torques[i]]).c_str(), nullptr);
      ++leads[i].usable;
      leads[i].least_torque_Nm = std::min(leads[i].least_torque_Nm, torque_Nm);
      leads[i].largest_torque_Nm = std::max(leads[i].largest_torque_Nm, torque_Nm);
    }
  }
  const std::string recommended = plan.contact->recommended();
  const auto rank = [&](const LeadingModel& lead) {
    return lead.usable > 0 && lead.name == recommended ? SIZE_MAX : lead.usable;
  };
  const auto best =
      std::max_element(leads.begin(), leads.end(),
                       [&](const auto& one, const auto& other) { return rank(one) < rank(other); });
  return best == leads.end() || best->usable == 0 ? LeadingModel{} : *best;
}

/// Rows for the page, at most 20000, evenly spaced among all; {"columns", "rows"}.
json sample_of(const fs::path& results, std::size_t all_rows) {
  constexpr std::size_t kMostRows = 20000;
  const std::size_t every = (all_rows + kMostRows - 1) / kMostRows;
  json columns = json::array(), rows = json::array();
  std::ifstream file(results);
  std::string line;
  const auto cells = [](const std::string& text) {
    json values = json::array();
    for (std::size_t start = 0; start <= text.size();) {
      // Only the last cell can be quoted.
      const std::size_t end = start < text.size() && text[start] == '"'
                                  ? text.size()
                                  : std::min(text.find(',', start), text.size());
      const std::string cell = text.substr(start, end - start);
      char* rest = nullptr;
      const double value = std::strtod(cell.c_str(), &rest);
      if (cell.empty())
        values.push_back(nullptr);
      else if (*rest == '\0' && std::isfinite(value))
        values.push_back(value);
      else
        values.push_back(cell.front() == '"' ? cell.substr(1, cell.size() - 2) : cell);
      start = end + 1;
    }
    return values;
  };
  if (std::getline(file, line)) columns = cells(line);
  for (std::size_t row = 0; std::getline(file, line); ++row)
    if (row % every == 0) rows.push_back(cells(line));
  return {{"columns", columns}, {"rows", rows}};
}

void write_page(const SweepPlan& plan, const LeadingModel& lead, const std::string& command,
                std::size_t failed) {
  const input::Case& base = plan.sweep.base();
  json keys = json::array(), models = json::array();
  for (const SweptKey& swept : plan.sweep.keys()) {
    const auto [smallest, largest] = std::minmax_element(swept.values.begin(), swept.values.end());
    keys.push_back({{"key", swept.key},
                    {"count", swept.values.size()},
                    {"least", *smallest},
                    {"largest", *largest},
                    {"log", swept.log_spacing}});
  }
  for (const ModelCard* model : plan.contact->models())
    models.push_back({{"name", model->name}, {"title", model->title}});
  json page = sample_of(plan.output / "results.csv", plan.sweep.rows());
  page.update({{"id", base.id},
               {"question", base.question},
               {"keys", keys},
               {"models", models},
               {"leading_model", lead.name},
               {"usable", prediction::in_words(plan.demand)},
               {"fem", plan.sweep.fem()},
               {"loads_N", base.loads_N},
               {"points", plan.sweep.points()},
               {"friction_coefficient", base.shear_law.friction_coefficient},
               {"all_rows", plan.sweep.rows()},
               {"failed", failed},
               {"sweep_toml", plan.sweep.text()},
               {"command", command},
               {"version", system::program_version()}});
  system::write_file_atomically(plan.output / "sweep.html", report::render_sweep(page));
}

/// Runs the finite elements, and writes the rows of a point as soon as all its results are
/// finished.
int run_fem_and_rows(const SweepPlan& plan, SweepWorkers& workers, RowsFile& file,
                     system::Progress& progress, std::vector<std::string>& failures) {
  const SweepFemJobs& fem = plan.fem;
  failures.resize(fem.count());
  std::vector<char> finished(fem.count(), 0);
  SweepRows rows = plan.rows();
  const std::size_t loads = plan.sweep.base().loads_N.size();
  const auto append_what_is_whole = [&] {
    const auto is_there = [&](long job) { return job < 0 || finished[std::size_t(job)]; };
    while (file.points() < plan.sweep.points()) {
      const auto first = fem.job_of_row.begin() + std::ptrdiff_t(file.points() * loads);
      if (!std::all_of(first, first + std::ptrdiff_t(loads), is_there)) break;
      std::string text;
      rows.append(file.points(), fem, failures, text);
      file.append(text, 1);
    }
  };
  append_what_is_whole();
  if (!fem.pads.empty()) {
    reference::FemJobOptions settings = fem.settings;
    settings.parallel = workers.parallel();
    return reference::run_pad_jobs(
        fem.pads, settings, progress,
        [&](const reference::PadJob& job, const reference::PadSolution& solution) {
          const auto index = std::size_t(&job - fem.pads.data());
          finished[index] = 1;
          failures[index] = solution.failure;
          append_what_is_whole();
        });
  }
  const auto index_of = [&](const reference::FemJob& job) {
    return std::size_t(&job - fem.jobs.data());
  };
  const std::vector<const reference::FemJob*> pending = reference::pending_fem_jobs(
      fem.jobs, fem.settings, progress,
      [&](const reference::FemJob& job, const reference::ReferenceResult&) {
        finished[index_of(job)] = 1;
      });
  append_what_is_whole();
  reference::FemJobProgress shown(progress, fem.jobs.size(), pending, workers.parallel());
  const int signal = workers.run_fem(
      pending, fem.settings,
      [&](const reference::FemJob& job, const std::string& failure, const std::string& summary) {
        finished[index_of(job)] = 1;
        failures[index_of(job)] = failure;
        shown.finished(job, summary);
        append_what_is_whole();
      });
  return signal;
}

}  // namespace

SweepPlan::SweepPlan(const std::string& sweep_text, const fs::path& sweep_file,
                     const fs::path& output_folder, const reference::FemLimits& limits,
                     const input::Settings& settings, const prediction::Demand& demanded)
    : file(sweep_file),
      output(output_folder),
      sweep(sweep_text, file, settings),
      demand(demanded),
      contact(std::holds_alternative<input::PadPair>(sweep.base().geometry)
                  ? swept_pad(sweep, demand)
                  : swept_bodies(sweep, demand)) {
  if (!sweep.fem()) return;
  const fs::path program = system::fem_program();
  SweepRows some_rows = rows();
  fem = sweep_fem_jobs(sweep, some_rows, output / "fem");
  fem.settings.program = program.string();
  fem.settings.identity = reference::program_identity(program);
  fem.settings.limits = limits;
}

int LocalWorkers::run_fem(
    const std::vector<const reference::FemJob*>& jobs, const reference::FemJobOptions& settings,
    const std::function<void(const reference::FemJob&, const std::string& failure,
                             const std::string& summary)>& on_finished) {
  reference::FemJobOptions local = settings;
  local.parallel = parallel_;
  return reference::run_fem_jobs(
      jobs, local, [](const reference::FemJob&, const std::string&) {},
      [&](const reference::FemJob& job, const reference::FemAnswer& answer) {
        on_finished(job, answer.failure, describe(answer));
      });
}

int LocalWorkers::make_rows(const SweepPlan& plan, RowsFile& file,
                            const std::function<void()>& on_progress) {
  const SignalFlag signals;
  const std::size_t first = file.points(), points = plan.sweep.points() - first;
  const std::size_t chunks = (points + kPointsPerChunk - 1) / kPointsPerChunk;
  ChunkQueue queue(chunks, 4 * std::size_t(parallel_));
  const auto make_chunks = [&] {
    try {
      SweepRows rows = plan.rows();
      for (std::size_t chunk = 0; queue.take(chunk);) {
        std::string text;
        const std::size_t begin = first + chunk * kPointsPerChunk;
        const std::size_t end = std::min(begin + kPointsPerChunk, plan.sweep.points());
        for (std::size_t point = begin; point < end; ++point) rows.append(point, text);
        queue.put(chunk, std::move(text));
      }
    } catch (...) {
      queue.fail(std::current_exception());
    }
  };
  std::vector<std::thread> threads;
  threads.reserve(std::size_t(parallel_));
  std::exception_ptr error;
  // Whatever fails, the threads have to end before this function returns.
  try {
    for (int i = 0; i < parallel_; ++i) threads.emplace_back(make_chunks);
    for (std::string text; file.points() < plan.sweep.points() && !g_signal;) {
      if (!queue.wait_for_next(text)) continue;
      file.append(text, std::min(kPointsPerChunk, plan.sweep.points() - file.points()));
      on_progress();
    }
  } catch (...) {
    error = std::current_exception();
  }
  queue.stop();
  for (std::thread& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
  return g_signal;
}

namespace {

/// The range of the torque and where the rows are, on standard output.
int answer(const SweepPlan& plan, const LeadingModel& lead, std::size_t failed, bool as_json) {
  const std::string rows = fs::absolute(plan.output / "results.csv").string(),
                    page = fs::absolute(plan.output / "sweep.html").string();
  const input::Case& base = plan.sweep.base();
  if (as_json) {
    json out = {{"sweep", base.id},
                {"rows", plan.sweep.rows()},
                {"failed", failed},
                {"results", rows},
                {"page", page}};
    out["leading_model"] =
        lead.name.empty()
            ? json()
            : json({{"model", lead.name},
                    {"usable_rows", lead.usable},
                    {"max_torque_Nm", {lead.least_torque_Nm, lead.largest_torque_Nm}}});
    system::write_to_stdout(text::printed(out));
  } else {
    const std::string torque =
        lead.name.empty()
            ? fmt::format("no model is usable ({}) in any row", prediction::in_words(plan.demand))
            : fmt::format("torque {:.3g} to {:.3g} mN·m by {}, usable ({}) in {} of {} rows",
                          1e3 * lead.least_torque_Nm, 1e3 * lead.largest_torque_Nm, lead.name,
                          prediction::in_words(plan.demand), lead.usable, plan.sweep.rows());
    system::write_text_to_stdout(
        fmt::format("{}: {}\nRows: {}\nPage: {}\n", base.id, torque, rows, page));
  }
  return failed > 0 ? 1 : 0;
}

}  // namespace

int run_sweep(const SweepPlan& plan, SweepWorkers& workers, const std::string& command,
              bool as_json) {
  const system::OutputFolder folder(plan.output);
  system::Progress progress;
  for (const auto& remarks : {plan.sweep.base().remarks, plan.contact->remarks()})
    for (const std::string& remark : remarks) progress.say("softfinger: " + remark);
  const std::string header = plan.rows().header();
  json identity = identity_of(plan, header);
  const std::string identity_hash =
      hash_text(hash_of(identity.dump(-1, ' ', false, json::error_handler_t::replace)));
  const fs::path record = plan.output / "sweep.json", results = plan.output / "results.csv";
  std::error_code missing;
  json before =
      fs::exists(record, missing) ? text::parse_json(system::read_file_to_rewrite(record)) : json();
  // With finite elements the rows are written again, because missing results are tried again.
  if (before.is_object() && before.contains("check") && !plan.sweep.fem()) {
    const json check = std::move(before["check"]);
    before.erase("check");
    const bool is_same = before == identity && check.is_string();
    if (is_same && RowsFile::is_whole(results, check.get<std::string>())) {
      // The page can be missing after a full disk.
      const LeadingModel lead = leading_model(plan);
      if (!fs::exists(plan.output / "sweep.html", missing)) write_page(plan, lead, command, 0);
      progress.say(fmt::format("softfinger: {} is finished: reused", results.string()));
      return answer(plan, lead, 0, as_json);
    }
    if (is_same && fs::exists(results, missing))
      progress.say(fmt::format("softfinger: {} was changed after it had been written: made again",
                               results.string()));
  }
  RowsFile file(plan.output, header, identity_hash, !plan.sweep.fem());
  if (file.had_changed_rows())
    progress.say(
        fmt::format("softfinger: in {} rows were changed after they had been written: "
                    "made again from point {} on",
                    (plan.output / "results.partial.csv").string(), file.points()));
  if (file.points() > 0)
    progress.say(
        fmt::format("softfinger: continues after {} of {} points, which are already computed",
                    file.points(), plan.sweep.points()));

  std::vector<std::string> failures;
  int signal = 0;
  if (plan.sweep.fem()) {
    signal = run_fem_and_rows(plan, workers, file, progress, failures);
  } else {
    const auto start = std::chrono::steady_clock::now();
    const std::size_t first = file.points();
    signal = workers.make_rows(plan, file, [&] {
      const double elapsed_s =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      progress.show(fmt::format(
          "{}: {} of {} points; about {:.0f} s left", plan.sweep.base().id, file.points(),
          plan.sweep.points(),
          elapsed_s / double(file.points() - first) * double(plan.sweep.points() - file.points())));
    });
  }
  if (signal != 0) {
    progress.say(fmt::format(
        "softfinger: interrupted: {} of {} points are in {}; the same command continues from there",
        file.points(), plan.sweep.points(), plan.output.string()));
    return 128 + signal;
  }
  identity["check"] = file.check();
  system::write_file_atomically(
      record, identity.dump(1, ' ', false, json::error_handler_t::replace) + "\n");
  file.finish();
  const std::size_t failed =
      std::size_t(std::count_if(failures.begin(), failures.end(),
                                [](const std::string& failure) { return !failure.empty(); }));
  const LeadingModel lead = leading_model(plan);
  write_page(plan, lead, command, failed);
  if (failed > 0)
    progress.say(
        fmt::format("softfinger: {} of {} finite-element results are missing; the same "
                    "command tries them again",
                    failed, plan.fem.count()));
  return answer(plan, lead, failed, as_json);
}

}  // namespace softfinger::sweep
