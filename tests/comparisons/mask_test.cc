#include "comparisons/input/mask.h"

#include <gtest/gtest.h>

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
