#include <cstdlib>
#include <string>

#include "comparisons/commands/commands.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {

void require_single_process(const std::string& in_place) {
  for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    const char* const size = std::getenv(variable);
    if (size && std::atoi(size) > 1)
      throw InputError("mpirun", "ranks", size, "1 for softfinger; on many ranks: " + in_place);
  }
}

}  // namespace softfinger::commands
