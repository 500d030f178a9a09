#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace softfinger {

/// Text from outside as a terminal may show it: what would command the terminal, or turn the
/// reading direction, becomes readable (`\x1b`, `\u202e`). These are the control characters (C0 but
/// for line feed and tab, DEL, C1), the bidirectional overrides and isolates, and bytes that are no
/// UTF-8, of which some terminals take 0x80 to 0x9f for C1.
inline std::string visible_text(std::string_view text) {
  /// The character at `at` and its bytes; no bytes where there is no UTF-8.
  const auto character = [text](std::size_t at, std::uint32_t& code) -> std::size_t {
    const auto byte = [&](std::size_t i) {
      return std::uint32_t(static_cast<unsigned char>(text[i]));
    };
    code = byte(at);
    if (code < 0x80) return 1;
    const std::size_t size = code >= 0xf0 ? 4 : code >= 0xe0 ? 3 : 2;
    if (code < 0xc2 || code > 0xf4 || at + size > text.size()) return 0;
    code &= 0x7fu >> size;
    for (std::size_t i = at + 1; i < at + size; ++i) {
      if ((byte(i) & 0xc0) != 0x80) return 0;
      code = code << 6 | (byte(i) & 0x3f);
    }
    constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
    return code < kLeast[size] || code > 0x10ffff || is_surrogate ? 0 : size;
  };
  const auto is_harmless = [](std::uint32_t code) {
    if (code == '\n' || code == '\t') return true;
    return !(code < 0x20 || (code >= 0x7f && code <= 0x9f) || (code >= 0x202a && code <= 0x202e) ||
             (code >= 0x2066 && code <= 0x2069));
  };
  std::string visible;
  visible.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    std::uint32_t code = 0;
    const std::size_t size = character(at, code);
    if (size > 0 && is_harmless(code)) {
      visible += text.substr(at, size);
    } else {
      char escape[16];
      if (size > 1)
        std::snprintf(escape, sizeof escape, "\\u%04x", unsigned(code));
      else
        std::snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned char>(text[at]));
      visible += escape;
    }
    at += size > 0 ? size : 1;
  }
  return visible;
}

}  // namespace softfinger
