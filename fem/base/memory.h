#pragma once

namespace softfinger::fem {

constexpr double kBytesPerMB = 1024 * 1024;

/// Memory that this process may still take, in MB: the system's available memory, or less where the
/// control group or `ulimit -v` (address space) sets a lower limit.
double available_memory_MB();

/// Largest resident size so far, in MB.
double peak_memory_MB();

}  // namespace softfinger::fem
