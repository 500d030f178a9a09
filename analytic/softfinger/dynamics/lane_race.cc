#include "softfinger/dynamics/lane_race.h"

#include <algorithm>
#include <atomic>
#include <future>

#include "softfinger/math/wide.h"

namespace softfinger::internal {
namespace {

constexpr double kMostMemory = 64e6;  // of a group, in bytes
constexpr int kIterationsPerStep = LaneRace::kGroups * ProximalLanes::kLanes;

/// The last step that has to be taken.
class Finish {
 public:
  explicit Finish(int step) : step_(step) {}

  int step() const { return step_; }
  void bring_forward(int step) {
    for (int last = step_; step < last && !step_.compare_exchange_weak(last, step);) {
    }
  }

 private:
  std::atomic<int> step_;
};

}  // namespace

LaneRace::LaneRace(const ContactOperator& contacts, int contact_capacity, int threads)
    : contacts_(contacts),
      contact_capacity_(contact_capacity),
      threads_(std::min(threads, kGroups)) {}

bool LaneRace::fits(const Task& task, ImpulseSearch& search) {
  return has_wide_instructions && task.problem.friction_rule == FrictionRule::ellipsoid &&
         ProximalLanes::memory(task.problem.contacts(), search.factor().rank()) <= kMostMemory;
}

bool LaneRace::find(const Task& task, ImpulseSearch& search, ImpulseSearch::Effort effort,
                    Limits limits) {
  while (int(groups_.size()) < kGroups)
    groups_.push_back(std::make_unique<LaneSearch>(contacts_, contact_capacity_));
  for (int group = 0; group < kGroups; ++group)
    groups_[std::size_t(group)]->begin_problem(search.factor(), limits.first_start + group,
                                               kGroups);

  const int end = std::max(1, limits.most_iterations / kIterationsPerStep);
  Finish finish(end - 1);
  int solved[kGroups];  // in which step
  std::fill(solved, solved + kGroups, end);
  const auto run = [&](int thread) {
    for (int step = 0; step <= finish.step(); ++step)
      for (int group = thread; group < kGroups; group += threads_) {
        const bool may_be_rounded = step * kIterationsPerStep >= limits.unrounded;
        if (!groups_[std::size_t(group)]->advance(task.problem, effort, may_be_rounded)) continue;
        solved[group] = step;
        finish.bring_forward(step);
        break;
      }
  };
  std::vector<std::future<void>> running;
  try {
    // Where the machine gives no more threads, the others' part is done when it is waited for.
    for (int thread = 1; thread < threads_; ++thread)
      running.push_back(
          std::async(std::launch::async | std::launch::deferred, [&run, thread] { run(thread); }));
    run(0);
    for (std::future<void>& one : running) one.get();
  } catch (...) {
    finish.bring_forward(-1);
    throw;
  }

  const int first = int(std::min_element(solved, solved + kGroups) - solved);
  task.result.newton_iterations += kIterationsPerStep * solved[first];
  ImpulseSearch::Found best = search.found();
  for (int group = 0; group < kGroups; ++group)
    if (solved[first] == end || group == first)
      best.take_if_better(ImpulseSearch::Found(groups_[std::size_t(group)]->found()));
  search.continue_from(best);
  return solved[first] < end;
}

}  // namespace softfinger::internal
