#include <cmath>

#include "comparisons/commands/commands.h"
#include "softfinger/input/errors.h"

namespace softfinger::commands {

void refuse_nan(double value, const char* option, const char* allowed) {
  if (std::isnan(value)) throw InputError("command line", option, "nan", allowed);
}

}  // namespace softfinger::commands
