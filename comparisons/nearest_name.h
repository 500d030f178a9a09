#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace softfinger {

/// Number of single-letter insertions, deletions, replacements and swaps of neighbours between two
/// words.
int edit_distance(std::string_view one, std::string_view other);

/// The candidate with the smallest edit distance; candidates must not be empty.
std::string nearest_name(std::string_view typed, const std::vector<std::string>& candidates);

/// "a, b, c"
std::string joined(const std::vector<std::string>& words, std::string_view separator = ", ");

}  // namespace softfinger
