#pragma once

#include <functional>

/// More than one thread within a problem. What is computed does not depend on their number: parts
/// that may run at a time share no sum. Beside other processes one thread is best.
namespace softfinger::fem {

/// That of the environment variable DEAL_II_NUM_THREADS, else that of the processors.
int thread_count();

/// Calls both functions, at the same time where there is a second thread, and returns when both
/// have ended.
/// @throws what `one` throws, else what `other` throws
void side_by_side(const std::function<void()>& one, const std::function<void()>& other);

}  // namespace softfinger::fem
