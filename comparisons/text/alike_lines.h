#pragma once

#include <string>
#include <vector>

namespace softfinger::text {

/// Lines that differ in names in quotes and in numbers alone become one: the first of them, with
/// the number of the others. The order stays.
/// @param how_to_see_all  ends such a line, for instance "--verbose lists them"
std::vector<std::string> alike_as_one(const std::vector<std::string>& lines,
                                      const std::string& how_to_see_all);

}  // namespace softfinger::text
