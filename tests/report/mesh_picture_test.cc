#include "comparisons/report/mesh_picture.h"

#include <gtest/gtest.h>
#include <png.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/report/sample_mesh.h"

namespace softfinger {
namespace {

struct Picture {
  unsigned width = 0, height = 0;
  std::vector<png_byte> bytes;  ///< red, green, blue

  std::array<int, 3> at(unsigned x, unsigned y) const {
    const std::size_t first = 3 * (std::size_t(y) * width + x);
    return {bytes[first], bytes[first + 1], bytes[first + 2]};
  }
};

Picture read(const std::string& file) {
  Picture picture;
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&image, file.data(), file.size())) return picture;
  image.format = PNG_FORMAT_RGB;
  picture.bytes.resize(PNG_IMAGE_SIZE(image));
  if (!png_image_finish_read(&image, nullptr, picture.bytes.data(), 0, nullptr)) return picture;
  picture.width = image.width;
  picture.height = image.height;
  return picture;
}

constexpr unsigned kTile = 320;

/// Pixels of a tile that show the surface: skin is redder than it is blue.
int skin(const Picture& picture, unsigned column, unsigned row) {
  int count = 0;
  for (unsigned y = 0; y < kTile; ++y)
    for (unsigned x = 0; x < kTile; ++x) {
      const auto [red, green, blue] = picture.at(column * kTile + x, row * kTile + y);
      count += red > blue + 5;
    }
  return count;
}

TEST(MeshPicture, ShowsTheSurfaceFromSixSidesToOneScale) {
  const Picture picture = read(report::mesh_picture(tests::sample_surface(), {}));
  ASSERT_EQ(picture.width, 3 * kTile);
  ASSERT_EQ(picture.height, 2 * kTile);
  // Semi-axes 12, 7, 14 mm: the longest fills 0.8 of a tile. Ellipses seen along y, x, z.
  const double pixels_per_mm = 0.8 * kTile / 28;
  const std::array<double, 3> products = {12 * 14, 7 * 14, 12 * 7};
  for (unsigned row = 0; row < 2; ++row)
    for (unsigned column = 0; column < 3; ++column) {
      const double area = M_PI * products[column] * pixels_per_mm * pixels_per_mm;
      // Facets of 32 to a turn cut off 1 - sin(2 pi/32)/(2 pi/32) = 0.6 %, the edge half a pixel.
      EXPECT_NEAR(skin(picture, column, row), area, 0.012 * area) << column << ", " << row;
    }
}

TEST(MeshPicture, MarksAPointInTheViewsThatItFaces) {
  const auto points = tests::sample_mesh_page().points;  // at -y and +x, the box's middle
  const Picture picture = read(report::mesh_picture(tests::sample_surface(), points));
  ASSERT_EQ(picture.width, 3 * kTile);
  const auto is_marked = [&](unsigned column, unsigned row) {
    const auto [red, green, blue] = picture.at(column * kTile + kTile / 2, row * kTile + kTile / 2);
    return blue > red + 50;
  };
  EXPECT_TRUE(is_marked(0, 0)) << "-y";
  EXPECT_TRUE(is_marked(1, 1)) << "+x";
  EXPECT_FALSE(is_marked(0, 1)) << "+y";
  EXPECT_FALSE(is_marked(1, 0)) << "-x";
  EXPECT_FALSE(is_marked(2, 0)) << "-z";
  EXPECT_FALSE(is_marked(2, 1)) << "+z";
}

TEST(MeshPicture, IsMadeOfAnySizeOfSurface) {
  for (const double size_m : {1e-9, 1e-3, 1e4}) {
    const TriangleSurface surface = {{{0, 0, 0}, {size_m, 0, 0}, {0, size_m, 0}}, {{0, 1, 2}}};
    const Picture picture = read(report::mesh_picture(surface, {}));
    ASSERT_EQ(picture.width, 3 * kTile) << size_m;
    EXPECT_GT(skin(picture, 2, 1), 0.4 * std::pow(0.8 * kTile, 2)) << size_m << ", from +z";
  }
}

}  // namespace
}  // namespace softfinger
