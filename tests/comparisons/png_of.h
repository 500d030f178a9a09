#pragma once

#include <png.h>

#include <string>
#include <vector>

namespace softfinger::tests {

/// A grey picture, row by row from above, as the bytes of a PNG file.
inline std::string png_of(const std::vector<png_byte>& grey, unsigned width, unsigned height) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = PNG_FORMAT_GRAY;
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&image, nullptr, &size, 0, grey.data(), 0, nullptr);
  std::string bytes(size, '\0');
  png_image_write_to_memory(&image, bytes.data(), &size, 0, grey.data(), 0, nullptr);
  bytes.resize(size);
  return bytes;
}

}  // namespace softfinger::tests
