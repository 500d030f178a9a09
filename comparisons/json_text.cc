#include "comparisons/json_text.h"

namespace softfinger {

nlohmann::json parse_json(const std::string& text) {
  constexpr int kDeepest = 64;
  struct TooDeep {};
  const auto limit_depth = [](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
    if (depth > kDeepest) throw TooDeep();
    return true;
  };
  try {
    return nlohmann::json::parse(text, limit_depth);
  } catch (const nlohmann::json::exception&) {
    return nullptr;
  } catch (const TooDeep&) {
    return nullptr;
  }
}

}  // namespace softfinger
