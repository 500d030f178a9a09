#include "comparisons/reference/fem_jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "comparisons/system/files.h"
#include "comparisons/text/percent.h"

namespace softfinger::reference {
namespace fs = std::filesystem;

FinishedResult finished_result(const FemJob& job, const FemJobOptions& options) {
  FinishedResult finished = read_finished_result(job.file, options.identity, to_json(job.problem));
  if (!finished.result || !finished.result->vtu_file || job.output_directory.empty())
    return finished;
  std::error_code error;
  if (!fs::exists(job.output_directory / fs::path(*finished.result->vtu_file).filename(), error))
    return {std::nullopt, "its VTU file is missing"};
  return finished;
}

std::vector<const FemJob*> pending_fem_jobs(
    const std::vector<FemJob>& jobs, const FemJobOptions& options, system::Progress& progress,
    const std::function<void(const FemJob&, ReferenceResult result)>& on_reused) {
  std::vector<const FemJob*> pending;
  std::size_t reused = 0;
  for (const FemJob& job : jobs) {
    FinishedResult finished = finished_result(job, options);
    if (finished.result) {
      progress.say(fmt::format("[{}/{}] {}: reused", ++reused, jobs.size(), job.title));
      on_reused(job, *std::move(finished.result));
      continue;
    }
    if (!finished.flaw.empty())
      progress.say(fmt::format("softfinger: {}: made again, it cannot be used: {}",
                               job.file.string(), finished.flaw));
    pending.push_back(&job);
  }
  std::stable_sort(pending.begin(), pending.end(), [](const FemJob* left, const FemJob* right) {
    return left->weight > right->weight;
  });
  return pending;
}

int run_fem_jobs(const std::vector<const FemJob*>& jobs, const FemJobOptions& options,
                 const std::function<void(const FemJob&, const std::string& line)>& on_line,
                 const std::function<void(const FemJob&, const FemAnswer&)>& on_finished) {
  std::vector<FemBatch> batches;
  std::vector<std::vector<const FemJob*>> jobs_of;  // per batch
  for (const FemJob* job : jobs) {
    // A file that is still there answers another problem. It is removed, so that it cannot be taken
    // for this job's result while new files are being written.
    std::error_code ignored;
    fs::remove(job->file, ignored);
    if (batches.empty() || jobs_of.back().back()->group != job->group) {
      batches.emplace_back();
      batches.back().single_thread = options.single_thread;
      batches.back().limits = options.limits;
      jobs_of.emplace_back();
    }
    batches.back().problems.push_back(job->problem);
    if (!job->output_directory.empty()) {
      system::make_writable_folder(job->output_directory);
      batches.back().problems.back().output_directory = job->output_directory;
    }
    jobs_of.back().push_back(job);
  }
  FemCallbacks callbacks;
  callbacks.on_line = [&](FemIndex index, const std::string& line) {
    on_line(*jobs_of[index.batch][index.problem], line);
  };
  callbacks.on_answer = [&](FemIndex index, FemAnswer answer) {
    const FemJob& job = *jobs_of[index.batch][index.problem];
    if (answer.result)
      write_finished_result(job.file, options.identity, to_json(job.problem), *answer.result);
    on_finished(job, answer);
  };
  return run_fem(options.program, batches, options.parallel, callbacks);
}

double expected_s(const FemProblem& problem) {
  // Measured on the built-in cases: a long contact needs more elements, finite strain a nonlinear
  // problem in steps, and a body without the symmetry of the contact has four times the unknowns.
  const double length = std::max(1., problem.radii.major_m / problem.radii.minor_m);
  double time_s = 0.5 * std::pow(length, 0.55);
  if (problem.finite_strain) time_s *= 3.2;
  if (problem.sublayers.size() > 1) time_s *= 5;
  if (problem.bodies) {
    const auto is_scan = [](const PlacedBody& placed) {
      return std::holds_alternative<PlacedMesh>(placed.body);
    };
    const PlacedBody &pad = problem.bodies->pad, &object = problem.bodies->object;
    if (is_scan(pad) || is_scan(object))
      time_s *= 8;
    else if (pad.turn_rad != 0 || object.turn_rad != 0)
      time_s *= 20;
  }
  constexpr int kUsualLevel = 2;
  return time_s * std::pow(5., problem.level - kUsualLevel);
}

FemJobProgress::FemJobProgress(system::Progress& progress, std::size_t all,
                               const std::vector<const FemJob*>& pending, int parallel)
    : progress_(progress),
      all_(all),
      pending_(pending.size()),
      left_(pending.size(),
            std::accumulate(
                pending.begin(), pending.end(), 0.,
                [](double sum, const FemJob* job) { return sum + expected_s(job->problem); }),
            parallel),
      begun_(static_cast<std::size_t>(parallel)) {
  for (std::size_t i = 0; i < pending.size(); ++i) {
    if (i == 0 || pending[i]->group != pending[i - 1]->group) batches_.emplace_back();
    ++batches_.back().left;
    batch_of_[pending[i]] = batches_.size() - 1;
  }
}

/// The first batches begin at once, each other one, in its turn, when one has ended. None for a job
/// of which this is not true, in an MPI run.
std::optional<double> FemJobProgress::took_s(const FemJob& job, double now_s) {
  const auto found = batch_of_.find(&job);
  if (found == batch_of_.end() || found->second >= begun_) return std::nullopt;
  Batch& batch = batches_[found->second];
  const double took_s = now_s - batch.began_s;
  batch.began_s = now_s;
  if (batch.left > 0 && --batch.left == 0 && begun_ < batches_.size())
    batches_[begun_++].began_s = now_s;
  return took_s;
}

double FemJobProgress::elapsed_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

std::string FemJobProgress::remaining() const {
  if (finished_ == 0 || finished_ == pending_) return "";
  return fmt::format("; about {:.0f} s left", left_.left_s(elapsed_s()));
}

void FemJobProgress::line(const FemJob& job, const std::string& text) {
  progress_.show(fmt::format("[{}/{}] {}: {}{}", all_ - pending_ + finished_, all_, job.title, text,
                             remaining()));
}

void FemJobProgress::finished(const FemJob& job, const std::string& outcome) {
  ++finished_;
  const double now_s = elapsed_s();
  left_.finished(expected_s(job.problem), took_s(job, now_s), now_s);
  progress_.say(fmt::format("[{}/{}] {}: {}{}", all_ - pending_ + finished_, all_, job.title,
                            outcome, remaining()));
}

std::string describe(const FemAnswer& answer) {
  if (!answer.result) return "FEM failed: " + answer.failure;
  const ReferenceResult& result = *answer.result;
  const auto in_percent = [](const std::optional<double>& error) {
    return text::percent(error.value_or(std::numeric_limits<double>::quiet_NaN()));
  };
  return fmt::format("{:.0f} unknowns, a ±{}, torque ±{}, {:.1f} s",
                     result.unknowns.value_or(std::numeric_limits<double>::quiet_NaN()),
                     in_percent(result.error.a), in_percent(result.error.max_torque),
                     result.wall_s);
}

}  // namespace softfinger::reference
