#include "comparisons/distributed/rank_pool.h"

#include <mpi.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>
#include <thread>

namespace softfinger::distributed {
namespace {

// A worker sends the report of its last task, or nothing at first; rank 0 answers with a task.
constexpr int kReport = 1, kTask = 2;
constexpr long kEnd = -1;

/// Pause between two polls for messages. A blocking receive of MPI would keep a core busy, which
/// the computing ranks need.
constexpr useconds_t kPause_us = 500;

void wait_for_message(int source, int tag, MPI_Status& status) {
  for (int there = 0; !there;) {
    MPI_Iprobe(source, tag, MPI_COMM_WORLD, &there, &status);
    if (!there) usleep(kPause_us);
  }
}

/// The thread on which rank 0 does its own tasks.
class OwnWorker {
 public:
  explicit OwnWorker(const RankTask& work) : thread_([this, &work] { loop(work); }) {}
  ~OwnWorker() {
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
      changed_.notify_all();
    }
    thread_.join();
  }

  bool is_idle() const { return idle_; }
  void give(long task) {
    const std::lock_guard lock(mutex_);
    idle_ = false;
    task_ = task;
    has_task_ = true;
    changed_.notify_all();
  }
  /// Whether a task has ended. If so, its report is moved out and the thread is idle again.
  bool take(long& task, std::string& report) {
    const std::lock_guard lock(mutex_);
    if (!has_report_) return false;
    has_report_ = false;
    idle_ = true;
    task = task_;
    report = std::move(report_);
    return true;
  }

 private:
  void loop(const RankTask& work) {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return has_task_ || ended_; });
      if (!has_task_) return;
      has_task_ = false;
      const long task = task_;
      lock.unlock();
      std::string report = work(task);
      lock.lock();
      report_ = std::move(report);
      has_report_ = true;
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool idle_ = true;  // used by the main thread only
  bool has_task_ = false, has_report_ = false, ended_ = false;
  long task_ = 0;
  std::string report_;
  std::thread thread_;  // the last member, because it uses all the others
};

}  // namespace

void serve_tasks(const RankTask& work) {
  std::string report;
  while (true) {
    MPI_Send(report.data(), static_cast<int>(report.size()), MPI_CHAR, 0, kReport, MPI_COMM_WORLD);
    MPI_Status status;
    wait_for_message(0, kTask, status);
    long task = 0;
    MPI_Recv(&task, 1, MPI_LONG, 0, kTask, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    if (task == kEnd) return;
    report = work(task);
  }
}

RankPool::RankPool(RankTask work) : work_(std::move(work)) {
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  others_.resize(static_cast<std::size_t>(size));
}

RankPool::~RankPool() {
  for (std::size_t rank = 1; rank < others_.size(); ++rank) {
    const int number = static_cast<int>(rank);
    if (others_[rank].state == Other::silent) {
      MPI_Status status;
      wait_for_message(number, kReport, status);
      MPI_Recv(nullptr, 0, MPI_CHAR, number, kReport, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    }
    MPI_Send(&kEnd, 1, MPI_LONG, number, kTask, MPI_COMM_WORLD);
  }
}

bool RankPool::take_reports(
    const std::function<void(long task, const std::string& report)>& on_done, std::size_t& done) {
  for (bool some = false;; some = true) {
    int there = 0, length = 0;
    MPI_Status status;
    MPI_Iprobe(MPI_ANY_SOURCE, kReport, MPI_COMM_WORLD, &there, &status);
    if (!there) return some;
    MPI_Get_count(&status, MPI_CHAR, &length);
    std::string report(static_cast<std::size_t>(length), '\0');
    MPI_Recv(report.data(), length, MPI_CHAR, status.MPI_SOURCE, kReport, MPI_COMM_WORLD,
             MPI_STATUS_IGNORE);
    Other& other = others_[static_cast<std::size_t>(status.MPI_SOURCE)];
    const bool was_busy = other.state == Other::busy;
    other.state = Other::waiting;
    if (!was_busy) continue;
    ++done;
    on_done(other.task, report);
  }
}

void RankPool::run(const std::vector<long>& tasks,
                   const std::function<void(long task, const std::string& report)>& on_done) {
  OwnWorker own(work_);
  std::size_t next = 0, done = 0;
  while (done < tasks.size()) {
    bool news = take_reports(on_done, done);
    long task = 0;
    std::string report;
    if (own.take(task, report)) {
      news = true;
      ++done;
      on_done(task, report);
    }
    for (std::size_t rank = 1; rank < others_.size() && next < tasks.size(); ++rank) {
      if (others_[rank].state != Other::waiting) continue;
      others_[rank] = {Other::busy, tasks[next++]};
      MPI_Send(&others_[rank].task, 1, MPI_LONG, static_cast<int>(rank), kTask, MPI_COMM_WORLD);
    }
    if (own.is_idle() && next < tasks.size()) own.give(tasks[next++]);
    if (!news) usleep(kPause_us);
  }
}

std::string text_of_rank_0(const std::string& text) {
  unsigned long length = text.size();
  MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG, 0, MPI_COMM_WORLD);
  std::string everywhere = text;
  everywhere.resize(length);
  MPI_Bcast(everywhere.data(), static_cast<int>(length), MPI_CHAR, 0, MPI_COMM_WORLD);
  return everywhere;
}

void end_all_ranks(int exit_status) {
  MPI_Abort(MPI_COMM_WORLD, exit_status);
  _exit(exit_status);
}

MpiSession::MpiSession(int& argument_count, char**& arguments) {
  // Only the main thread calls MPI.
  int provided = 0;
  MPI_Init_thread(&argument_count, &arguments, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

MpiSession::~MpiSession() { MPI_Finalize(); }

}  // namespace softfinger::distributed
