#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger::text {

/// Number of single-letter insertions, deletions, replacements and swaps of neighbours between two
/// words.
int edit_distance(std::string_view one, std::string_view other);

/// The candidate that was probably meant: one that begins with the typed word, if that has two
/// letters or more, else the one with the smallest edit distance. Null where that exceeds a third
/// of the longer word: with more letters wrong, it is another word. Only the first 200 bytes of a
/// typed word are compared.
std::optional<std::string> nearest_name(std::string_view typed,
                                        const std::vector<std::string>& candidates);

/// `, did you mean "thickness_mm"?`, or nothing where no candidate is near.
std::string did_you_mean(std::string_view typed, const std::vector<std::string>& candidates,
                         std::string_view separator = ", ");

/// The text shortened for a message: at most `most_bytes`, "..." included if something was cut off.
/// No UTF-8 character is cut in two.
std::string shortened(std::string_view text, std::size_t most_bytes = 60);

/// "a, b, c"
std::string joined(const std::vector<std::string>& words, std::string_view separator = ", ");

}  // namespace softfinger::text
