#include "softfinger/pads/outline_refusal.h"

#include "softfinger/input/errors.h"

namespace softfinger {

void refuse_outline(const char* field, const std::string& value, const std::string& allowed) {
  throw InputError("outline", field, value, allowed);
}

}  // namespace softfinger
