#include "comparisons/report/png_file.h"

#include <png.h>

#include <stdexcept>

namespace softfinger::report {

std::string png_file(int width, int height, const std::vector<std::array<std::uint8_t, 3>>& rgb) {
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = png_uint_32(width);
  image.height = png_uint_32(height);
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string file(size, '\0');
  if (!png_image_write_to_memory(&image, file.data(), &size, 0, rgb.data(), 0, nullptr))
    throw std::runtime_error(std::string("libpng: ") + image.message);
  file.resize(size);
  return file;
}

}  // namespace softfinger::report
