#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger::text {

/// Number of single-letter insertions, deletions, replacements and swaps of neighbours between two
/// words.
int edit_distance(std::string_view one, std::string_view other);

/// The candidate with the smallest edit distance; candidates must not be empty. Of a very long word
/// the beginning counts.
std::string nearest_name(std::string_view typed, const std::vector<std::string>& candidates);

/// A text for a message: its first `most_bytes`, with "..." where more was there; no character of
/// UTF-8 is cut in two.
std::string shortened(std::string_view text, std::size_t most_bytes = 60);

/// "a, b, c"
std::string joined(const std::vector<std::string>& words, std::string_view separator = ", ");

}  // namespace softfinger::text
