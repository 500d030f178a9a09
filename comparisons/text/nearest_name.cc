#include "comparisons/text/nearest_name.h"

#include <algorithm>
#include <utility>

namespace softfinger::text {

int edit_distance(std::string_view one, std::string_view other) {
  // Optimal string alignment; three rows suffice because a swap looks two rows back.
  const int columns = static_cast<int>(other.size()) + 1;
  std::vector<int> before(columns), previous(columns), current(columns);
  for (int j = 0; j < columns; ++j) previous[j] = j;
  for (int i = 1; i <= static_cast<int>(one.size()); ++i) {
    current[0] = i;
    for (int j = 1; j < columns; ++j) {
      const int replace = previous[j - 1] + (one[i - 1] == other[j - 1] ? 0 : 1);
      current[j] = std::min({previous[j] + 1, current[j - 1] + 1, replace});
      if (i > 1 && j > 1 && one[i - 1] == other[j - 2] && one[i - 2] == other[j - 1])
        current[j] = std::min(current[j], before[j - 2] + 1);
    }
    before.swap(previous);
    previous.swap(current);
  }
  return previous[columns - 1];
}

std::optional<std::string> nearest_name(std::string_view typed,
                                        const std::vector<std::string>& candidates) {
  constexpr std::size_t kLongestName = 200, kShortestBeginning = 2;
  typed = typed.substr(0, kLongestName);
  // A forgotten unit, as in "point" for "point_mm", is more likely than three wrong letters.
  const auto is_beginning_of = [&](std::string_view name) {
    return typed.size() >= kShortestBeginning && name.substr(0, typed.size()) == typed;
  };
  const auto distance = [&](std::string_view name) {
    return std::pair(!is_beginning_of(name), edit_distance(typed, name));
  };
  const auto nearest = std::min_element(candidates.begin(), candidates.end(),
                                        [&](const std::string& one, const std::string& other) {
                                          return distance(one) < distance(other);
                                        });
  if (nearest == candidates.end()) return std::nullopt;
  const auto [differs, changes] = distance(*nearest);
  const std::size_t longer = std::max(typed.size(), nearest->size());
  if (differs && 3 * static_cast<std::size_t>(changes) > longer) return std::nullopt;
  return *nearest;
}

std::string did_you_mean(std::string_view typed, const std::vector<std::string>& candidates,
                         std::string_view separator) {
  const auto nearest = nearest_name(typed, candidates);
  return nearest ? std::string(separator) + "did you mean \"" + *nearest + "\"?" : "";
}

std::string shortened(std::string_view text, std::size_t most_bytes) {
  if (text.size() <= most_bytes) return std::string(text);
  std::size_t end = most_bytes - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;
  return std::string(text.substr(0, end)) + "...";
}

std::string joined(const std::vector<std::string>& words, std::string_view separator) {
  std::string text;
  for (const auto& word : words) {
    if (!text.empty()) text += separator;
    text += word;
  }
  return text;
}

}  // namespace softfinger::text
