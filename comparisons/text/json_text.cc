#include "comparisons/text/json_text.h"

#include <cmath>

#include "softfinger/input/nesting.h"

namespace softfinger::text {

nlohmann::json parse_json(const std::string& text) {
  if (deepest_nesting(text) > kDeepestJson) return nullptr;
  nlohmann::json parsed = nlohmann::json::parse(text, nullptr, false);
  return parsed.is_discarded() ? nlohmann::json() : parsed;
}

nlohmann::json finite_or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

std::string printed(nlohmann::json object) {
  object["schema"] = kSchema;
  return object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

}  // namespace softfinger::text
