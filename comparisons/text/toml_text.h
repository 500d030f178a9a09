#pragma once

#include <string>

namespace softfinger::text {

/// A text as a value of TOML, in quotes.
std::string toml_text(const std::string& text);

}  // namespace softfinger::text
