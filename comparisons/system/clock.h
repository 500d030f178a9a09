#pragma once

#include <ctime>
#include <string>

namespace softfinger::system {

/// The present time (UTC) in the format of strftime: "2026-11-01T12:00:00Z" by default.
inline std::string utc_now(const char* format = "%Y-%m-%dT%H:%M:%SZ") {
  const std::time_t now = std::time(nullptr);
  char text[64] = "";
  std::strftime(text, sizeof text, format, std::gmtime(&now));
  return text;
}

}  // namespace softfinger::system
