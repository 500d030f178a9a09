#pragma once

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger::tests {

/// The array that base64 wrote, padding and all.
template <typename Number>
std::vector<Number> from_base64(const std::string& text) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  if (text.size() % 4 != 0) throw std::invalid_argument("base64: a group is incomplete");
  std::string bytes;
  for (std::size_t i = 0; i < text.size(); i += 4) {
    std::uint32_t bits = 0;
    int count = 3;
    for (std::size_t k = i; k < i + 4; ++k) {
      const std::size_t digit = text[k] == '=' ? 0 : kDigits.find(text[k]);
      if (digit == std::string_view::npos) throw std::invalid_argument("base64: bad character");
      count -= text[k] == '=';
      bits = bits << 6 | static_cast<std::uint32_t>(digit);
    }
    for (int k = 0; k < count; ++k) bytes += static_cast<char>(bits >> (16 - 8 * k) & 255);
  }
  if (bytes.size() % sizeof(Number) != 0) throw std::invalid_argument("base64: half a number");
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

}  // namespace softfinger::tests
