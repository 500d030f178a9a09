#pragma once

#include "comparisons/input/case.h"
#include "comparisons/input/toml_reader.h"

/// Internal to the readers of files that hold a case.
namespace softfinger::input {

/// `parse_case` for a text that is parsed already. @param text  to keep with the case
Case case_of(const toml::table& root, const std::string& text, const std::filesystem::path& file);

}  // namespace softfinger::input
