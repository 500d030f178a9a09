#include "softfinger/dynamics/impulse_starts.h"

#include <algorithm>
#include <atomic>
#include <future>
#include <mutex>
#include <thread>
#include <utility>

#include "softfinger/dynamics/impulse_start.h"

namespace softfinger::internal {
namespace {

/// Where the given starts failed, 1 in 1,200 iterations ends in a solution,
/// whichever start they belong to: a path costs as much as thousands, and of 11 scenes that took
/// paths 10 were solved sooner from more starts. Of more contacts than the hundred that this was
/// measured with an iteration may cost the square of their number more.
constexpr int kMostIterationsInAll = 20000;
constexpr double kMeasuredContacts = 100;
/// In lanes they cost a third.
constexpr int kMostIterationsInLanes = 60000;
/// Shapes cost several times as much per iteration, and hardly more per path.
constexpr int kMostIterationsOfShapes = 6000;
constexpr int kMostStarts = kGivenStarts + 200;
/// After this part of the iterations, and the given starts, a point is a solution as well where its
/// residual is the rounding of W r. Before, other starts often find one with smaller impulses.
constexpr double kPartForUnrounded = 0.25;
/// A search needs nine times the memory of W.
constexpr int kMostThreads = 4, kMostContactsInParallel = 250;

/// The square of how many more contacts there are than were measured; 1 at least.
double larger_than_measured(int contacts) {
  const double larger = std::max(1., contacts / kMeasuredContacts);
  return larger * larger;
}

int threads_for(int contact_capacity, int asked) {
  if (contact_capacity > kMostContactsInParallel) return 1;
  if (asked > 0) return std::min(asked, kMostStarts);
  return std::clamp(int(std::thread::hardware_concurrency()), 1, kMostThreads);
}

}  // namespace

/// Starts from `first` on, before `end`.
class ImpulseStarts::Queue {
 public:
  /// @param search           where the starts before these have led
  /// @param most_iterations  of all starts of the problem
  Queue(const ImpulseSearch& search, int iterations, int most_iterations, int first, int end)
      : found_(search.found()),
        iterations_(iterations),
        most_iterations_(most_iterations),
        first_(first),
        next_(first),
        last_needed_(end - 1),
        counted_(first) {
    ended_.resize(std::size_t(end - first));
  }

  /// Takes starts until none is needed. One per thread.
  void work(const Task& task, ImpulseSearch& search, ImpulseSearch::Effort effort) {
    try {
      for (int start = next_++; is_needed(start); start = next_++) {
        search.best().forget();
        task.result = {};
        go_to_start(start, search);
        search.approach(task, most_iterations(start), effort,
                        [this, start] { return is_needed(start); });
        end(start, {true, task.result.newton_iterations, search.found()});
      }
    } catch (...) {
      stop();
      throw;
    }
  }
  /// No start is needed any more.
  void stop() { last_needed_ = -1; }

  const ImpulseSearch::Found& found() const { return found_; }
  int iterations() const { return iterations_; }
  bool is_solved() const { return is_solved_; }

 private:
  struct Ended {
    bool has_ended = false;
    int iterations = 0;
    ImpulseSearch::Found found;
  };

  bool is_needed(int start) const { return start <= last_needed_; }

  /// Counts the starts that have ended as far as none is missing.
  void end(int start, Ended ended) {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_[std::size_t(start - first_)] = std::move(ended);
    for (; is_needed(counted_) && ended_[std::size_t(counted_ - first_)].has_ended; ++counted_) {
      Ended& one = ended_[std::size_t(counted_ - first_)];
      iterations_ += one.iterations;
      found_.take_if_better(std::move(one.found));
      decide(counted_);
    }
  }

  /// Whether the starts up to this one are enough.
  void decide(int start) {
    const bool is_drawn = start >= kGivenStarts;
    is_solved_ =
        found_.best.is_solved(is_drawn && iterations_ >= kPartForUnrounded * most_iterations_);
    if (is_solved_ || (is_drawn && iterations_ >= most_iterations_)) last_needed_ = start;
  }

  ImpulseSearch::Found found_;
  int iterations_, most_iterations_;
  bool is_solved_ = false;
  int first_;
  std::atomic<int> next_, last_needed_;
  std::mutex mutex_;
  int counted_;  ///< all before it
  std::vector<Ended> ended_;
};

ImpulseStarts::ImpulseStarts(const ContactOperator& contacts, int contact_capacity, int threads)
    : contacts_(contacts),
      contact_capacity_(contact_capacity),
      threads_(threads_for(contact_capacity, threads)),
      lanes_(contacts, contact_capacity, threads_) {}

void ImpulseStarts::begin_problem() {
  iterations_ = 0;
  for (Beside& beside : beside_) beside.search->begin_problem();
}

bool ImpulseStarts::find_from_given(const Task& task, ImpulseSearch& search,
                                    ImpulseSearch::Effort effort) {
  // Alone, because it solves nine of ten problems. Lanes take the others together with drawn ones.
  const bool has_lanes = LaneRace::fits(task, search);
  const int before = task.result.newton_iterations;
  if (has_lanes) effort.eased_starts = 1;
  go_to_start(0, search);
  search.approach(task, most_iterations(0), effort);
  iterations_ += task.result.newton_iterations - before;
  if (search.found().best.is_solved(false)) return true;
  return !has_lanes && find(task, search, effort, 1, kGivenStarts);
}

bool ImpulseStarts::find_from_drawn(const Task& task, ImpulseSearch& search,
                                    ImpulseSearch::Effort effort) {
  if (!LaneRace::fits(task, search)) return find(task, search, effort, kGivenStarts, kMostStarts);
  const int most = int(kMostIterationsInLanes / larger_than_measured(contacts_.contacts()));
  return lanes_.find(task, search, effort, {1, most, int(kPartForUnrounded * most)});
}

bool ImpulseStarts::find(const Task& task, ImpulseSearch& search, ImpulseSearch::Effort effort,
                         int first, int end) {
  while (int(beside_.size()) < threads_ - 1)
    beside_.push_back({std::make_unique<ImpulseSearch>(contacts_, contact_capacity_), {}, {}});
  const bool has_shapes = task.problem.friction_rule == FrictionRule::limit_surface;
  const int most = int((has_shapes ? kMostIterationsOfShapes : kMostIterationsInAll) /
                       larger_than_measured(contacts_.contacts()));
  Queue queue(search, iterations_, most, first, end);
  std::vector<std::future<void>> running;
  LcpResult own;
  try {
    for (Beside& beside : beside_) {
      beside.solution.resize(contacts_.contacts());
      // Where the machine gives no more threads, nothing is left to do when it is waited for.
      running.push_back(std::async(std::launch::async | std::launch::deferred, [&] {
        queue.work({task.problem, beside.solution, beside.result}, *beside.search, effort);
      }));
    }
    queue.work({task.problem, task.solution, own}, search, effort);
    for (std::future<void>& one : running) one.get();
  } catch (...) {
    queue.stop();
    throw;
  }
  task.result.newton_iterations += queue.iterations() - iterations_;
  iterations_ = queue.iterations();
  search.continue_from(queue.found());
  return queue.is_solved();
}

}  // namespace softfinger::internal
