#pragma once

#include <string>
#include <string_view>

namespace softfinger::text {

/// A cell of a table of comma-separated values (RFC 4180). It is quoted if it contains a comma, a
/// quote or a line break. A text that a spreadsheet would run as a formula, because it begins with
/// =,
/// +, -, @, gets an apostrophe before it. Any other text is unchanged.
inline std::string csv_cell(std::string_view text) {
  const bool is_formula =
      !text.empty() && std::string_view("=+-@").find(text.front()) != std::string_view::npos;
  std::string cell = is_formula ? "'" : "";
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return cell.append(text);
  cell.insert(cell.begin(), '"');
  for (const char c : text) {
    if (c == '"') cell += '"';
    cell += c;
  }
  return cell + '"';
}

}  // namespace softfinger::text
