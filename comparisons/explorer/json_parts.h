#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>

/// Pieces of JSON, written by hand: the page's library has no exceptions, which nlohmann's needs.
namespace softfinger::explorer {

inline std::string json_number(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

inline std::string json_string(std::string_view text) {
  std::string out = "\"";
  for (const char letter : text) {
    if (letter == '\n') {
      out += "\\n";
      continue;
    }
    if (letter == '"' || letter == '\\') out += '\\';
    out += letter;
  }
  return out + "\"";
}

/// The parts with commas between them, in brackets.
class List {
 public:
  void add(const std::string& part) { text_ += (text_.empty() ? "" : ",") + part; }
  std::string text() const { return "[" + text_ + "]"; }

 private:
  std::string text_;
};

}  // namespace softfinger::explorer
