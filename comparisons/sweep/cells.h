#pragma once

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <string>

/// Cells of results.csv, each after a comma.
namespace softfinger::sweep {

/// Ten digits: more than any model is worth, and half the file's size. Empty where there is no
/// number.
inline void append_number(double value, std::string& text) {
  text += ',';
  if (std::isfinite(value)) fmt::format_to(std::back_inserter(text), "{:.10g}", value);
}

inline void append_yes_or_no(bool is_so, std::string& text) { text += is_so ? ",yes" : ",no"; }

}  // namespace softfinger::sweep
