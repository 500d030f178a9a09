#include "comparisons/text/alike_lines.h"

#include <cctype>
#include <map>

namespace softfinger::text {
namespace {

/// The line without what is in quotes and without its numbers.
std::string skeleton(const std::string& line) {
  std::string result;
  bool is_quoted = false, is_number = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char letter = line[i];
    if (letter == '\\' && is_quoted) {
      ++i;
      continue;
    }
    if (letter == '"') is_quoted = !is_quoted;
    if (is_quoted) continue;
    // A sign belongs to its number.
    if (letter == '-' && i + 1 < line.size() &&
        std::isdigit(static_cast<unsigned char>(line[i + 1])))
      continue;
    const bool is_digit = std::isdigit(static_cast<unsigned char>(letter)) != 0;
    is_number = is_digit || (is_number && (letter == '.' || letter == 'e' || letter == '-'));
    if (is_digit && (result.empty() || result.back() != '0')) result += '0';
    if (!is_number) result += letter;
  }
  return result;
}

}  // namespace

std::vector<std::string> alike_as_one(const std::vector<std::string>& lines,
                                      const std::string& how_to_see_all) {
  std::vector<std::string> result;
  std::vector<int> counts;
  std::map<std::string, std::size_t> place_of;
  for (const std::string& line : lines) {
    const auto [found, is_new] = place_of.emplace(skeleton(line), result.size());
    if (is_new) {
      result.push_back(line);
      counts.push_back(0);
    } else {
      ++counts[found->second];
    }
  }
  for (std::size_t i = 0; i < result.size(); ++i)
    if (counts[i] > 0)
      result[i] += " (and " + std::to_string(counts[i]) + " more alike; " + how_to_see_all + ")";
  return result;
}

}  // namespace softfinger::text
