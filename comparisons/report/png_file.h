#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace softfinger::report {

/// Bytes of a PNG file.
/// @param rgb  width * height colours, row by row from above
/// @throws std::runtime_error with libpng's message
std::string png_file(int width, int height, const std::vector<std::array<std::uint8_t, 3>>& rgb);

}  // namespace softfinger::report
