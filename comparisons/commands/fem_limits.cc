#include <fmt/format.h>

#include "comparisons/commands/commands.h"
#include "comparisons/commands/number_range.h"

namespace softfinger::commands {

void add_fem_limits(CLI::App& command, reference::FemLimits& limits) {
  command
      .add_option(
          "--fem-time-s", limits.time_s,
          fmt::format("longest time of one finite-element problem, 1 to 1e7 s; a longer one "
                      "is ended and the others continue; default: {:g}",
                      limits.time_s))
      ->check(number_range(1, 1e7));
  command
      .add_option(
          "--fem-memory-MB", limits.memory_MB,
          fmt::format(
              "largest memory of one finite-element problem, 50 to 1e7 MB; a larger one is ended "
              "likewise; "
              "default: {:g}",
              limits.memory_MB))
      ->check(number_range(50, 1e7));
}

}  // namespace softfinger::commands
