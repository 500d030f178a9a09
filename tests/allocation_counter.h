#pragma once

#include <cstddef>

namespace softfinger::testing {

/// Heap allocations of this program so far, in all threads. Linking allocation_counter.cc replaces
/// the global operator new.
std::size_t allocations() noexcept;

}  // namespace softfinger::testing
