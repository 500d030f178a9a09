#include "fem/base/threads.h"

#include <deal.II/base/multithread_info.h>
#include <deal.II/base/thread_management.h>

#include <algorithm>
#include <atomic>
#include <ctime>
#include <exception>
#include <vector>

namespace softfinger::fem {
namespace {

/// CPU time that this thread's work has taken on other threads, less what the thread has done for
/// others.
thread_local double t_elsewhere = 0;

std::atomic<int> g_thread_limit{0};  ///< 0: none

/// Calls the parts that no other thread has begun.
class Parts {
 public:
  Parts(int count, const std::function<void(int)>& part)
      : part_(part), failures_(static_cast<std::size_t>(count)) {}

  void call() {
    for (int i = next_++; i < count(); i = next_++) {
      try {
        part_(i);
      } catch (...) {
        failures_[static_cast<std::size_t>(i)] = std::current_exception();
        next_ = count();
      }
    }
  }

  void rethrow_first() const {
    for (const std::exception_ptr& failure : failures_)
      if (failure) std::rethrow_exception(failure);
  }

 private:
  int count() const { return static_cast<int>(failures_.size()); }

  const std::function<void(int)>& part_;
  std::atomic<int> next_{0};
  std::vector<std::exception_ptr> failures_;
};

}  // namespace

int thread_count() {
  const int limit = g_thread_limit;
  return limit > 0 ? limit : static_cast<int>(dealii::MultithreadInfo::n_threads());
}

ThreadLimit::ThreadLimit(int threads) { g_thread_limit = threads; }
ThreadLimit::~ThreadLimit() { g_thread_limit = 0; }

void in_parallel(int count, const std::function<void(int)>& part) {
  Parts parts(count, part);
  const int helpers = std::max(0, std::min(count, thread_count()) - 1);
  std::vector<double> spent(static_cast<std::size_t>(helpers));
  std::vector<dealii::Threads::Task<>> tasks;
  for (double& of_helper : spent)
    tasks.push_back(dealii::Threads::new_task([&parts, &of_helper] {
      const double begin = work_seconds();
      parts.call();
      of_helper = work_seconds() - begin;
      // A thread that waits in other work may take a task: it is none of that.
      t_elsewhere -= of_helper;
    }));
  parts.call();
  for (const auto& task : tasks) task.join();
  for (const double of_helper : spent) t_elsewhere += of_helper;
  parts.rethrow_first();
}

void side_by_side(const std::function<void()>& one, const std::function<void()>& other) {
  in_parallel(2, [&](int i) { (i == 0 ? one : other)(); });
}

void in_order(int count, int batch, const std::function<void(int)>& compute,
              const std::function<void(int)>& add) {
  for (int begin = 0; begin < count + batch; begin += batch) {
    const int end = std::min(count, begin + batch);
    in_parallel(1 + std::max(0, end - begin), [&](int part) {
      if (part > 0) return compute(begin + part - 1);
      for (int i = std::max(0, begin - batch); i < std::min(count, begin); ++i) add(i);
    });
  }
}

std::unique_lock<std::mutex> lock_global_state() {
  static std::mutex one_at_a_time;
  return std::unique_lock(one_at_a_time);
}

double work_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec) + t_elsewhere;
}

}  // namespace softfinger::fem
