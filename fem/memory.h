#pragma once

namespace softfinger::fem {

/// What this process may still take, in MB: the system's available memory, less where a limit of
/// the control group or of the address space (`ulimit -v`) is nearer.
double available_memory_MB();

/// Largest resident size so far, in MB.
double peak_memory_MB();

}  // namespace softfinger::fem
