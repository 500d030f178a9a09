#include "fem/base/memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

namespace softfinger::fem {
namespace {

constexpr double kKilobytesPerMB = 1024;

/// The number after `key` in one of the system's lists, in its own unit.
double entry(const char* path, const std::string& key) {
  std::ifstream file(path);
  for (std::string word; file >> word;)
    if (double value = 0; word == key && file >> value) return value;
  return std::numeric_limits<double>::infinity();
}

double number_in(const char* path) {
  std::ifstream file(path);
  double value = 0;
  return file >> value ? value : std::numeric_limits<double>::infinity();  // or the word "max"
}

}  // namespace

double available_memory_MB() {
  double available = entry("/proc/meminfo", "MemAvailable:") / kKilobytesPerMB;
  const double group_limit = number_in("/sys/fs/cgroup/memory.max") / kBytesPerMB;
  const double group_use = number_in("/sys/fs/cgroup/memory.current") / kBytesPerMB;
  if (std::isfinite(group_limit) && std::isfinite(group_use)) {
    // The group's use counts cached files, which give way.
    const double cached = entry("/sys/fs/cgroup/memory.stat", "inactive_file") / kBytesPerMB;
    available = std::min(available, group_limit - group_use + (std::isfinite(cached) ? cached : 0));
  }
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    available = std::min(available, static_cast<double>(limit.rlim_cur) / kBytesPerMB -
                                        entry("/proc/self/status", "VmSize:") / kKilobytesPerMB);
  return available;
}

double peak_memory_MB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / kKilobytesPerMB;
}

}  // namespace softfinger::fem
