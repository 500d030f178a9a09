#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

/// Tasks handed out one by one to the ranks of an MPI run, so that no rank waits for another.
namespace softfinger::distributed {

/// Does a task, numbered as the caller likes, and tells what came of it. On any rank.
using RankTask = std::function<std::string(long task)>;

/// For all ranks but 0: does tasks until rank 0 ends the run.
void serve_tasks(const RankTask& work);

/// For rank 0: hands out the tasks in their order; rank 0 works too, on a thread of its own.
class RankPool {
 public:
  /// @param work  must not throw
  explicit RankPool(RankTask work);
  /// Ends the other ranks' `serve_tasks`.
  ~RankPool();
  RankPool(const RankPool&) = delete;
  RankPool& operator=(const RankPool&) = delete;

  /// @param on_done  on the calling thread, as each task ends, with what `work` told of it
  /// Ends when all tasks are done. What `on_done` throws goes on after this rank's own task.
  void run(const std::vector<long>& tasks,
           const std::function<void(long task, const std::string& report)>& on_done);

 private:
  /// Of another rank: it has not called yet, it waits for a task, or it is at one.
  struct Other {
    enum { silent, waiting, busy } state = silent;
    long task = 0;
  };
  /// Takes the messages that are there. @returns whether there was one
  bool take_reports(const std::function<void(long task, const std::string& report)>& on_done,
                    std::size_t& done);

  RankTask work_;
  std::vector<Other> others_;  ///< by rank; the first is unused
};

/// A text of rank 0 on all ranks.
std::string text_of_rank_0(const std::string& text);

/// An error on any rank ends the run on all of them.
[[noreturn]] void end_all_ranks(int exit_status);

/// MPI for as long as it lives.
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
