#include "comparisons/input/mask.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "png_of.h"
#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

constexpr unsigned kWidth = 200, kHeight = 160;
constexpr double kPixel_m = 0.1e-3;

/// Light where `inside`, of pixels from the left and from above.
std::string picture(const std::function<bool(double x, double y)>& inside, png_byte light = 255,
                    png_byte dark = 0) {
  std::vector<png_byte> grey;
  for (unsigned row = 0; row < kHeight; ++row)
    for (unsigned column = 0; column < kWidth; ++column)
      grey.push_back(inside(column + 0.5, row + 0.5) ? light : dark);
  return tests::png_of(grey, kWidth, kHeight);
}

bool in_ellipse(double x, double y) {
  const double angle = kPi / 6, dx = x - 90, dy = 80 - y;  // 30° anticlockwise, seen upright
  const double along = dx * std::cos(angle) + dy * std::sin(angle);
  const double across = dy * std::cos(angle) - dx * std::sin(angle);
  return std::hypot(along / 60, across / 30) < 1;
}

std::string refusal(const std::string& bytes, bool is_dark = false) {
  try {
    parse_mask(bytes, kPixel_m, is_dark, "print.png");
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(Mask, HasTheAreaAndTheAxesOfAnEllipse) {
  const MaskedContact contact = parse_mask(picture(in_ellipse), kPixel_m, false, "print.png");
  const double a_m = 60 * kPixel_m, b_m = 30 * kPixel_m;
  // Pixels are counted by their centres, errors of single ones cancel: well below the stated error,
  // which is that of an edge seen too far outside or inside all round.
  EXPECT_NEAR(contact.area_m2, kPi * a_m * b_m, 0.5 * contact.area_std_m2);
  EXPECT_NEAR(contact.a_m, a_m, 0.5 * contact.semi_axis_std_m);
  EXPECT_NEAR(contact.b_m, b_m, 0.5 * contact.semi_axis_std_m);
  EXPECT_NEAR(contact.axis_rad, kPi / 6, 2e-3);
  EXPECT_NEAR(contact.centre_m[0], 90 * kPixel_m, 0.1 * kPixel_m);
  EXPECT_NEAR(contact.centre_m[1], 80 * kPixel_m, 0.1 * kPixel_m);
  EXPECT_NEAR(contact.ellipse_departure, 0, 2e-3);
  // Ramanujan's perimeter; of an ellipse the steps are between 1 and sqrt(2) times as long as the
  // edge, on average 4/pi to within a tenth.
  const double perimeter_m = kPi * (3 * (a_m + b_m) - std::sqrt((3 * a_m + b_m) * (a_m + 3 * b_m)));
  EXPECT_NEAR(contact.area_std_m2, perimeter_m * kPixel_m / std::sqrt(12.),
              0.1 * contact.area_std_m2);
}

TEST(Mask, TakesInkOnPaperAsWell) {
  const MaskedContact light = parse_mask(picture(in_ellipse), kPixel_m, false, "print.png");
  const MaskedContact dark = parse_mask(picture(in_ellipse, 60, 230), kPixel_m, true, "print.png");
  EXPECT_EQ(dark.pixels, light.pixels);
  EXPECT_EQ(dark.a_m, light.a_m);
}

TEST(Mask, SeesThatAPictureIsNoFilledEllipse) {
  const auto striped = [](double x, double y) { return in_ellipse(x, y) && int(y) % 2 == 0; };
  const MaskedContact contact = parse_mask(picture(striped), kPixel_m, false, "print.png");
  EXPECT_NEAR(contact.ellipse_departure, -1, 0.05) << "half of it is missing";
}

/// A disc whose values fall from 1 to 0 between 20 and 60 pixels from the middle, so that half is
/// at 40: the contact's edge depends on what half means.
double blurred_disc(double x, double y) {
  return std::clamp((60 - std::hypot(x - 100, y - 80)) / 40, 0., 1.);
}

struct PngFormat {
  const char* name;
  int depth, colour_type;
  double gamma = 0;  ///< of a gAMA chunk; 0: none
  bool says_srgb = false;
};

/// The blurred disc in this format, written by libpng.
std::string blurred_png(const PngFormat& format, bool is_dark) {
  std::string bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp writer, png_bytep data, png_size_t size) {
        static_cast<std::string*>(png_get_io_ptr(writer))
            ->append(reinterpret_cast<const char*>(data), size);
      },
      nullptr);
  png_set_IHDR(png, info, kWidth, kHeight, format.depth, format.colour_type, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (format.gamma > 0) png_set_gAMA(png, info, format.gamma);
  if (format.says_srgb) png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  std::vector<png_color> greys;
  for (int i = 0; i < 256; ++i) greys.push_back({png_byte(i), png_byte(i), png_byte(i)});
  if (format.colour_type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, greys.data(), 256);
  png_write_info(png, info);
  const int most = (1 << format.depth) - 1, colours = format.colour_type & PNG_COLOR_MASK_COLOR;
  const bool has_alpha = (format.colour_type & PNG_COLOR_MASK_ALPHA) != 0;
  const int samples = colours && format.colour_type != PNG_COLOR_TYPE_PALETTE ? 3 : 1;
  for (unsigned row = 0; row < kHeight; ++row) {
    std::vector<png_byte> line;
    const auto put = [&](double value) {
      const auto level = int(std::lround(value * most));
      if (format.depth == 16) line.push_back(png_byte(level >> 8));
      line.push_back(png_byte(level & 255));
    };
    for (unsigned column = 0; column < kWidth; ++column) {
      const double value = blurred_disc(column + 0.5, row + 0.5);
      for (int sample = 0; sample < samples; ++sample) put(is_dark ? 1 - value : value);
      if (has_alpha) put(1);
    }
    png_write_row(png, line.data());
  }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

TEST(Mask, HasTheSameAreaInEveryDepthColourTypeAndGamma) {
  for (const bool is_dark : {false, true}) {
    const double area_m2 = kPi * std::pow(40 * kPixel_m, 2);
    for (const PngFormat& format : {
             PngFormat{"8 bit", 8, PNG_COLOR_TYPE_GRAY},
             PngFormat{"8 bit, gamma 1", 8, PNG_COLOR_TYPE_GRAY, 1.},
             PngFormat{"8 bit, gamma 1/2.2", 8, PNG_COLOR_TYPE_GRAY, 1 / 2.2},
             PngFormat{"16 bit", 16, PNG_COLOR_TYPE_GRAY},
             PngFormat{"16 bit, sRGB", 16, PNG_COLOR_TYPE_GRAY, 0, true},
             PngFormat{"16 bit, gamma 1", 16, PNG_COLOR_TYPE_GRAY, 1.},
             PngFormat{"8 bit, alpha", 8, PNG_COLOR_TYPE_GRAY_ALPHA},
             PngFormat{"16 bit, alpha", 16, PNG_COLOR_TYPE_GRAY_ALPHA},
             PngFormat{"8 bit, colour", 8, PNG_COLOR_TYPE_RGB},
             PngFormat{"16 bit, colour", 16, PNG_COLOR_TYPE_RGB},
             PngFormat{"16 bit, colour, alpha, gamma 1", 16, PNG_COLOR_TYPE_RGB_ALPHA, 1.},
             PngFormat{"palette", 8, PNG_COLOR_TYPE_PALETTE},
             PngFormat{"palette, gamma 1", 8, PNG_COLOR_TYPE_PALETTE, 1.},
         }) {
      const MaskedContact contact =
          parse_mask(blurred_png(format, is_dark), kPixel_m, is_dark, "print.png");
      // A level of 8 bits is 0.16 pixels wide here, which is half a stated deviation.
      EXPECT_NEAR(contact.area_m2, area_m2, 0.5 * contact.area_std_m2)
          << format.name << (is_dark ? ", dark" : ", light");
    }
  }
}

TEST(Mask, RefusesWhatShowsNoWholeContact) {
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(refusal("no picture"), "PNG"));
  EXPECT_TRUE(has(refusal(""), "PNG"));
  const std::string whole = picture(in_ellipse);
  EXPECT_TRUE(has(refusal(whole.substr(0, whole.size() / 2)), "PNG"));
  EXPECT_TRUE(has(refusal(picture([](double, double) { return false; })), "no contact"));
  // The paper around the ink reaches the edge.
  const std::string edge = refusal(picture(in_ellipse, 60, 230));
  EXPECT_TRUE(has(edge, "reaches the picture's edge")) << edge;
  EXPECT_TRUE(has(edge, "--dark")) << edge;
  // A header that promises 60000 x 60000 pixels must not allocate them.
  std::string huge = whole;
  huge.replace(16, 8, std::string("\0\0\xea\x60\0\0\xea\x60", 8));
  EXPECT_FALSE(refusal(huge).empty());
}

}  // namespace
}  // namespace softfinger::input
