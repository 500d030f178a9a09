// softfinger-sweep: `softfinger sweep` and `softfinger atlas` on the ranks of an MPI run. A program
// of its own, so that `softfinger` needs no MPI.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "comparisons/commands/demand_input.h"
#include "comparisons/commands/typed_words.h"
#include "comparisons/distributed/rank_pool.h"
#include "comparisons/judgement/atlas/make_atlas.h"
#include "comparisons/sweep/run_sweep.h"
#include "comparisons/system/files.h"
#include "comparisons/system/program_paths.h"
#include "comparisons/text/json_text.h"
#include "softfinger/input/errors.h"
#include "softfinger/input/visible_text.h"

namespace softfinger::distributed {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct Options {
  std::string sweep, atlas, output, command_line;
  std::vector<std::string> settings;
  bool finite_strain = false;
  int random = 0;
  unsigned seed = 1;
  commands::DemandInput demand;
  reference::FemLimits fem_limits;
};

/// Points per task of a sweep without finite elements: about a tenth of a second.
constexpr std::size_t kPointsPerTask = 10000;

void say(const std::string& line) {
  std::fputs(("softfinger-sweep: " + visible_text(line) + "\n").c_str(), stderr);
}

/// Calls `work`, on any rank and thread. If it throws, the run ends on all ranks.
template <class Work>
auto or_end_all(const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const system::Interrupted& interruption) {
    end_all_ranks(128 + interruption.signal);
  } catch (const InputError& error) {
    say(std::string("error: ") + error.what());
    end_all_ranks(2);
  } catch (const std::exception& error) {
    say(std::string("error: ") + error.what());
    end_all_ranks(3);
  }
}

/// Runs one job as a process of this rank. The result is in the job's file when this returns.
std::string do_fem_job(const reference::FemJob& job, const reference::FemJobOptions& settings) {
  json report;
  const int signal = reference::run_fem_jobs(
      {&job}, settings, [](const reference::FemJob&, const std::string&) {},
      [&](const reference::FemJob&, const reference::FemAnswer& answer) {
        report = {{"failure", answer.failure}, {"summary", describe(answer)}};
      });
  if (signal != 0) throw system::Interrupted(signal);
  return report.dump(-1, ' ', false, json::error_handler_t::replace);
}

fs::path chunk_file(const fs::path& output, long chunk) {
  return output / fmt::format("rows_{:06}.csv", chunk);
}

/// Computes the rows of a task and writes them to a file, whole or not at all.
void make_chunk(const sweep::SweepPlan& plan, long chunk) {
  sweep::SweepRows rows = plan.rows();
  std::string text;
  const std::size_t begin = std::size_t(chunk) * kPointsPerTask;
  const std::size_t end = std::min(begin + kPointsPerTask, plan.sweep.points());
  for (std::size_t point = begin; point < end; ++point) rows.append(point, text);
  system::write_file_atomically(chunk_file(plan.output, chunk), text);
}

class RankWorkers : public sweep::SweepWorkers {
 public:
  /// @param jobs  the jobs; the number of a task is the index of its job
  RankWorkers(RankPool& pool, const std::vector<reference::FemJob>& jobs)
      : pool_(pool), jobs_(jobs) {}

  int parallel() const override { return pool_.ranks(); }

  int run_fem(const std::vector<const reference::FemJob*>& pending, const reference::FemJobOptions&,
              const std::function<void(const reference::FemJob&, const std::string& failure,
                                       const std::string& summary)>& on_finished) override {
    std::vector<long> tasks;
    for (const reference::FemJob* job : pending) tasks.push_back(job - jobs_.data());
    pool_.run(tasks, [&](long task, const std::string& text) {
      const json report = text::parse_json(text);
      on_finished(jobs_[std::size_t(task)], report.at("failure"), report.at("summary"));
    });
    return 0;
  }

  int make_rows(const sweep::SweepPlan& plan, sweep::RowsFile& file,
                const std::function<void()>& on_progress) override {
    std::vector<long> tasks;
    const std::size_t chunks = (plan.sweep.points() + kPointsPerTask - 1) / kPointsPerTask;
    for (std::size_t chunk = file.points() / kPointsPerTask; chunk < chunks; ++chunk)
      tasks.push_back(long(chunk));
    // Only files that this run has made: others may be left from another sweep.
    std::set<long> made;
    // The rows before an interruption may end in the middle of a task: these rows are skipped.
    std::size_t known_rows = file.points() % kPointsPerTask * plan.sweep.base().loads_N.size();
    pool_.run(tasks, [&](long task, const std::string&) {
      made.insert(task);
      for (long chunk; made.count(chunk = long(file.points() / kPointsPerTask));) {
        const fs::path part = chunk_file(plan.output, chunk);
        std::string rows = system::read_file_to_rewrite(part);
        for (; known_rows > 0; --known_rows) rows.erase(0, rows.find('\n') + 1);
        made.erase(chunk);
        const std::size_t end =
            std::min((std::size_t(chunk) + 1) * kPointsPerTask, plan.sweep.points());
        file.append(rows, end - file.points());
        fs::remove(part);
        on_progress();
      }
    });
    return 0;
  }

 private:
  RankPool& pool_;
  const std::vector<reference::FemJob>& jobs_;
};

int sweep_on_ranks(const Options& options, int rank) {
  const fs::path file = system::find_sweep_file(options.sweep);
  const std::string text = text_of_rank_0(rank == 0 ? sweep::read_sweep_text(file) : "");
  input::Settings settings;
  for (const std::string& typed : options.settings) settings.push_back(input::parse_setting(typed));
  const sweep::SweepPlan plan(text, input::name_of_typed(file), options.output, options.fem_limits,
                              settings, options.demand.demand());
  if (!plan.fem.pads.empty())
    throw InputError(plan.sweep.base().geometry_where,
                     "softfinger-sweep solves no finite elements of flat pads: softfinger sweep "
                     "does, on one machine",
                     "", "");
  const RankTask work = [&](long task) {
    return or_end_all([&] {
      if (plan.sweep.fem()) return do_fem_job(plan.fem.jobs[std::size_t(task)], plan.fem.settings);
      make_chunk(plan, task);
      return std::string();
    });
  };
  if (rank != 0) {
    serve_tasks(work);
    return 0;
  }
  RankPool pool(work);
  RankWorkers workers(pool, plan.fem.jobs);
  return sweep::run_sweep(plan, workers, options.command_line);
}

int atlas_on_ranks(const Options& options, int rank) {
  const std::vector<judgement::AtlasRun> runs =
      options.random > 0      ? judgement::random_runs(options.random, options.seed)
      : options.finite_strain ? judgement::finite_strain_runs()
                              : judgement::designed_runs();
  const std::vector<reference::FemJob> jobs = judgement::atlas_jobs(runs, options.output);
  reference::FemJobOptions settings;
  settings.program = system::fem_program().string();
  settings.identity = reference::program_identity(settings.program);
  settings.limits = options.fem_limits;
  const RankTask work = [&](long task) {
    return or_end_all([&] { return do_fem_job(jobs[std::size_t(task)], settings); });
  };
  if (rank != 0) {
    serve_tasks(work);
    return 0;
  }
  const system::OutputFolder folder(options.output);
  RankPool pool(work);
  RankWorkers workers(pool, jobs);
  system::Progress progress;
  const auto pending =
      reference::pending_fem_jobs(jobs, settings, progress, [](const auto&, const auto&) {});
  reference::FemJobProgress shown(progress, jobs.size(), pending, workers.parallel());
  workers.run_fem(pending, settings,
                  [&](const reference::FemJob& job, const std::string&,
                      const std::string& summary) { shown.finished(job, summary); });
  const auto atlas = judgement::collect_atlas(runs, jobs, settings, options.command_line);
  if (!atlas) return 1;
  system::write_file_atomically(options.atlas, to_csv(*atlas));
  return 0;
}

/// @returns nothing to do the work, or the exit status
std::optional<int> parse(int argument_count, char** arguments, Options& options, int rank) {
  CLI::App app(
      "softfinger sweep, or the error atlas, on the ranks of an MPI run. Each rank solves one\n"
      "finite-element problem at a time; rank 0 hands them out and also computes. The output "
      "folder "
      "has\n"
      "to be one that all ranks see. The same command continues after an interruption.",
      "softfinger-sweep");
  app.set_version_flag("-V,--version", "softfinger-sweep " + system::program_version());
  CLI::Option* sweep = app.add_option("SWEEP", options.sweep,
                                      "case file (TOML) with a table [sweep], or a built-in sweep");
  CLI::Option* atlas =
      app.add_option("--atlas", options.atlas,
                     "instead the error atlas: the CSV file to write when all runs are "
                     "there; --output keeps the runs");
  atlas->excludes(sweep);
  app.add_option(
         "--set", options.settings,
         "KEY=VALUE in place of the file's value, for instance layer.thickness_mm=3; may be "
         "repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->excludes(atlas);
  app.add_option("-o,--output", options.output, "folder for the results, created when missing")
      ->required();
  app.add_flag("--finite-strain", options.finite_strain, "the atlas at finite strain")
      ->needs(atlas);
  app.add_option("--random", options.random, "instead N contacts drawn at random, 1 to 100000")
      ->check(CLI::Range(1, 100000))
      ->needs(atlas);
  app.add_option("--seed", options.seed, "of the random contacts; default: 1")->needs(atlas);
  app.add_option("--fem-time-s", options.fem_limits.time_s,
                 "longest time of one finite-element problem, 1 to 1e7 s; default: 3600")
      ->check(CLI::Range(1., 1e7));
  app.add_option("--fem-memory-MB", options.fem_limits.memory_MB,
                 "largest memory of one finite-element problem, 50 to 1e7 MB; default: 8192")
      ->check(CLI::Range(50., 1e7));
  app.footer(
      "Samples:\n"
      "  mpirun -np 64 softfinger-sweep my_sweep.toml --output my_sweep\n"
      "  mpirun -np 64 softfinger-sweep --atlas error_atlas.csv --output atlas_runs");
  commands::add_demand(app, options.demand);
  for (const char* of_sweep : {"--tolerance", "--quantities"})
    app.get_option(of_sweep)->excludes(atlas);
  commands::prepare_options(app);
  try {
    app.parse(argument_count, arguments);
    if (options.sweep.empty() == options.atlas.empty())
      throw CLI::RequiredError("exactly one of SWEEP and --atlas");
  } catch (const CLI::Success& request) {
    return rank == 0 ? app.exit(request) : 0;
  } catch (const InputError& error) {
    if (rank == 0) say(std::string("error: ") + error.what());
    return 2;
  } catch (const CLI::ParseError& error) {
    if (rank == 0) say(std::string("error: ") + error.what() + " (see softfinger-sweep --help)");
    return 2;
  }
  return std::nullopt;
}

}  // namespace
}  // namespace softfinger::distributed

int main(int argument_count, char** arguments) {
  using namespace softfinger::distributed;
  softfinger::system::open_standard_descriptors();
  std::signal(SIGXFSZ, SIG_IGN);
  const MpiSession mpi(argument_count, arguments);
  Options options;
  options.command_line = "softfinger-sweep";
  for (int i = 1; i < argument_count; ++i) options.command_line += std::string(" ") + arguments[i];
  if (const auto status = parse(argument_count, arguments, options, mpi.rank())) return *status;
  return or_end_all([&] {
    return options.atlas.empty() ? sweep_on_ranks(options, mpi.rank())
                                 : atlas_on_ranks(options, mpi.rank());
  });
}
