#include "comparisons/text/number.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace softfinger::text {
namespace {

template <typename Number>
std::optional<Number> read_whole_text(std::string_view text) {
  // from_chars knows no plus sign. It reads no blanks, no hexadecimal digits and no locale's
  // commas.
  if (!text.empty() && text[0] == '+') {
    text.remove_prefix(1);
    if (!text.empty() && text[0] == '-') return std::nullopt;
  }
  Number value = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (text.empty() || read.ec != std::errc() || read.ptr != end) return std::nullopt;
  return value;
}

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t");
  return first == std::string_view::npos ? "" : text.substr(first, last - first + 1);
}

}  // namespace

std::optional<double> read_number(std::string_view text) {
  const auto value = read_whole_text<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<long long> read_whole_number(std::string_view text) {
  return read_whole_text<long long>(text);
}

std::optional<std::vector<double>> read_numbers(std::string_view text) {
  std::vector<double> values;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const auto value = read_number(without_blanks(text.substr(start, end - start)));
    if (!value) return std::nullopt;
    values.push_back(*value);
    start = end + 1;
  }
  return values;
}

std::string lower_case(std::string text) {
  for (char& letter : text)
    if (letter >= 'A' && letter <= 'Z') letter = char(letter - 'A' + 'a');
  return text;
}

}  // namespace softfinger::text
