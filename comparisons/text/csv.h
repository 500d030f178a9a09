#pragma once

#include <string>
#include <string_view>

namespace softfinger::text {

/// A cell of a table of comma-separated values (RFC 4180). It is quoted if it contains a comma, a
/// quote or a line break, and unchanged otherwise.
inline std::string csv_cell(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string cell = "\"";
  for (const char c : text) {
    if (c == '"') cell += '"';
    cell += c;
  }
  return cell + '"';
}

}  // namespace softfinger::text
