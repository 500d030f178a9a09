#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

/// More than one thread within a problem. What is computed does not depend on their number: parts
/// that may run at a time share no sum. Beside other processes one thread is best.
namespace softfinger::fem {

/// The number of threads: that of the environment variable DEAL_II_NUM_THREADS, else that of the
/// processors.
int thread_count();

/// Another number of threads while it lives. It tells in how many parts work goes on; the
/// processors may be fewer.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;
};

/// Calls `part` with 0 to count - 1, at the same time where there are threads for it, and returns
/// when all have ended. One thread calls them in turn. Parts may call this function too.
/// @throws what the first one throws, in the order of their numbers; later ones may be left out
void in_parallel(int count, const std::function<void(int)>& part);

/// Calls two functions in the same way.
void side_by_side(const std::function<void()>& one, const std::function<void()>& other);

/// Calls `compute` with 0 to count - 1 at the same time, and `add` with each after it, one after
/// the other in their order: sums do not depend on the number of threads. Of what was computed and
/// not yet added there is `2 batch` at most: the caller may keep it at places modulo that.
void in_order(int count, int batch, const std::function<void(int)>& compute,
              const std::function<void(int)>& add);

/// Objects that one thread at a time may use, kept for the next one that needs one.
template <class Object>
class Pool {
 public:
  explicit Pool(std::function<std::unique_ptr<Object>()> make) : make_(std::move(make)) {}

  /// @param use  called with an object that no other thread has
  template <class Use>
  void with(const Use& use) {
    std::unique_ptr<Object> object = take();
    use(*object);
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(object));
  }

 private:
  std::unique_ptr<Object> take() {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Object> object = std::move(idle_.back());
        idle_.pop_back();
        return object;
      }
    }
    // Not under the lock: deal.II's objects are made by tasks, and who waits for these may take
    // another one that needs an object, too.
    return make_();
  }

  std::function<std::unique_ptr<Object>()> make_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Object>> idle_;
};

/// This lock is held while a library works that has one state for the whole process: gmsh has one
/// model, and it and METIS draw from the C library's random numbers. Two at a time would change
/// each other's meshes and orders.
std::unique_lock<std::mutex> lock_global_state();

/// CPU time of this thread's work and of the parts of it that other threads have done, from some
/// time on. What the thread does for other work while it waits is left out.
double work_seconds();

}  // namespace softfinger::fem
