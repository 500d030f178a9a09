#pragma once

#include <chrono>

#include "fem/base/threads.h"

namespace softfinger::fem {

/// Time since it was made, by the same thread.
class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  /// CPU time of all threads for what this one works on. Unlike wall time it does not depend on how
  /// busy the machine is, nor on what else runs at the same time.
  double cpu_seconds() const { return work_seconds() - cpu_; }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double cpu_ = work_seconds();
};

}  // namespace softfinger::fem
