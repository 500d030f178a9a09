#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace softfinger::text {

/// The number that is the whole text: decimal, with a point, finite: "2", "-0.5", ".5", "1e-3".
/// Null for anything else: an empty text, nan and inf, 0x10, 1'000 and 1,5, letters after the
/// number, a number that a double cannot hold.
std::optional<double> read_number(std::string_view text);

/// Reads a whole number by the same rules: "-2", "10".
std::optional<long long> read_whole_number(std::string_view text);

/// The numbers between commas, which may have blanks around them: "1, 5". Null if any of them is
/// none.
std::optional<std::vector<double>> read_numbers(std::string_view text);

/// The letters A to Z as small ones.
std::string lower_case(std::string text);

}  // namespace softfinger::text
