#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

#include "softfinger/input/errors.h"

namespace softfinger {

/// Deepest nesting of brackets that is read. JSON of this project is nested at most ten deep.
constexpr long kDeepestJson = 64;

/// Returns how deep the brackets of a JSON text are nested. Brackets inside strings do not count.
/// For a text that is not JSON the result is at least the depth at which a parser stops.
inline long deepest_nesting(std::string_view text) {
  long depth = 0, deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char letter = text[i];
    if (in_string && letter == '\\')
      ++i;
    else if (letter == '"')
      in_string = !in_string;
    else if (in_string)
      continue;
    else if (letter == '[' || letter == '{')
      deepest = std::max(deepest, ++depth);
    else if (letter == ']' || letter == '}')
      --depth;
  }
  return deepest;
}

/// Throws where a JSON text is nested too deep. To be called before parsing: code that walks
/// through the parsed values (copies or writes them) needs stack for each level, and 300,000 levels
/// overflow it.
/// @param where  the file's name, for the message
/// @throws InputError
inline void check_nesting(std::string_view text, const std::string& where) {
  const long depth = deepest_nesting(text);
  if (depth > kDeepestJson)
    throw InputError(where, "nesting of brackets", std::to_string(depth),
                     "at most " + std::to_string(kDeepestJson));
}

}  // namespace softfinger
