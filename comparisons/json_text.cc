#include "comparisons/json_text.h"

#include "softfinger/input/nesting.h"

namespace softfinger {

nlohmann::json parse_json(const std::string& text) {
  if (deepest_nesting(text) > kDeepestJson) return nullptr;
  nlohmann::json parsed = nlohmann::json::parse(text, nullptr, false);
  return parsed.is_discarded() ? nlohmann::json() : parsed;
}

}  // namespace softfinger
