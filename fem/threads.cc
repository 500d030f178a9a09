#include "fem/threads.h"

#include <deal.II/base/multithread_info.h>
#include <deal.II/base/thread_management.h>

#include <exception>

namespace softfinger::fem {
namespace {

/// @returns what the function throws
std::exception_ptr failure_of(const std::function<void()>& function) {
  try {
    function();
  } catch (...) {
    return std::current_exception();
  }
  return nullptr;
}

}  // namespace

int thread_count() { return static_cast<int>(dealii::MultithreadInfo::n_threads()); }

void side_by_side(const std::function<void()>& one, const std::function<void()>& other) {
  std::exception_ptr of_other;
  auto task = dealii::Threads::new_task([&] { of_other = failure_of(other); });
  const std::exception_ptr of_one = failure_of(one);
  task.join();
  for (const std::exception_ptr& failure : {of_one, of_other})
    if (failure) std::rethrow_exception(failure);
}

}  // namespace softfinger::fem
