#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

/// Tasks handed out one by one to the ranks of an MPI run, so that no rank waits for another.
namespace softfinger::distributed {

/// Does the task with this number and returns a report. Called on any rank; the caller gives
/// numbers their meaning.
using RankTask = std::function<std::string(long task)>;

/// Serves all ranks except 0: does tasks until rank 0 ends the run.
void serve_tasks(const RankTask& work);

/// Serves rank 0: hands out the tasks in their order, and does tasks itself on a second thread.
class RankPool {
 public:
  /// @param work  must not throw
  explicit RankPool(RankTask work);
  int ranks() const { return static_cast<int>(others_.size()); }
  /// Ends the other ranks' `serve_tasks`.
  ~RankPool();
  RankPool(const RankPool&) = delete;
  RankPool& operator=(const RankPool&) = delete;

  /// Returns when all tasks are done. An exception of `on_done` is passed on when this rank's own
  /// task has ended.
  /// @param on_done  called on the calling thread when a task ends, with the report of `work`
  void run(const std::vector<long>& tasks,
           const std::function<void(long task, const std::string& report)>& on_done);

 private:
  /// The state of another rank: it has sent nothing yet, it waits for a task, or it does one.
  struct Other {
    enum { silent, waiting, busy } state = silent;
    long task = 0;
  };
  /// Handles the messages that have arrived. @returns whether there was one
  bool take_reports(const std::function<void(long task, const std::string& report)>& on_done,
                    std::size_t& done);

  RankTask work_;
  std::vector<Other> others_;  ///< by rank; the first is unused
};

/// Sends a text of rank 0 to all ranks; returns it on each.
std::string text_of_rank_0(const std::string& text);

/// Ends the run on all ranks, after an error on this one.
[[noreturn]] void end_all_ranks(int exit_status);

/// Initialises MPI, and finalises it when destroyed.
class MpiSession {
 public:
  MpiSession(int& argument_count, char**& arguments);
  ~MpiSession();
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }

 private:
  int rank_ = 0, size_ = 1;
};

}  // namespace softfinger::distributed
