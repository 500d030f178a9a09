#pragma once

#include <string>
#include <vector>

#include "softfinger/time/relaxation_fit.h"

namespace softfinger::input {

/// Whether a table of measurements is force against time: it has a column time_s.
bool has_times(const std::string& text);

/// A table with the columns time_s (since the approach stopped) and load_N, in any order, comma
/// separated. Lines that are empty or begin with # are skipped. At most 1000 rows.
/// @param file  for messages
/// @throws InputError with "file:line", column and value
std::vector<HeldForce> parse_held_forces(const std::string& text, const std::string& file);

}  // namespace softfinger::input
