#include "comparisons/input/mask.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::input {
namespace {

/// The file without the chunks that say how its numbers become light. The contact's edge is where
/// the stored values are half, whatever their depth: libpng would otherwise convert a linear
/// picture to sRGB, in which half lies elsewhere.
std::string without_colour_spaces(const std::string& bytes) {
  constexpr std::size_t kSignature = 8, kAroundData = 12;  // length, name and checksum
  std::string kept = bytes.substr(0, kSignature);
  for (std::size_t at = kept.size(); at < bytes.size();) {
    std::size_t length = 0;
    for (std::size_t i = at; i < std::min(at + 4, bytes.size()); ++i)
      length = 256 * length + static_cast<unsigned char>(bytes[i]);
    const std::string chunk = bytes.substr(at, length + kAroundData);
    const std::string name = chunk.size() < 8 ? "" : chunk.substr(4, 4);
    if (name != "gAMA" && name != "cHRM" && name != "sRGB" && name != "iCCP" && name != "cICP")
      kept += chunk;
    at += chunk.size();
  }
  return kept;
}

/// Which pixels belong to the contact.
class Mask {
 public:
  Mask(const std::string& file_bytes, bool is_dark, const std::string& file) {
    const std::string bytes = without_colour_spaces(file_bytes);
    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    const auto refuse = [&] {
      const std::string reason = image.message;
      png_image_free(&image);
      throw InputError(file, "the picture cannot be read (" + reason + ")", "", "a PNG file");
    };
    if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) refuse();
    width_ = image.width;
    height_ = image.height;
    if (double(width_) * double(height_) > kMostMaskPixels) {
      png_image_free(&image);
      throw InputError(file, "size of the picture", fmt::format("{} x {} pixels", width_, height_),
                       fmt::format("at most {:.0f} million pixels", 1e-6 * kMostMaskPixels));
    }
    image.format = PNG_FORMAT_GA;
    // Without it libpng takes 16 bits to be linear.
    image.flags |= PNG_IMAGE_FLAG_16BIT_sRGB;
    std::vector<png_byte> grey_and_alpha(PNG_IMAGE_SIZE(image));
    if (!png_image_finish_read(&image, nullptr, grey_and_alpha.data(), 0, nullptr)) refuse();
    is_contact_.resize(width_ * height_);
    for (std::size_t i = 0; i < is_contact_.size(); ++i)
      is_contact_[i] =
          grey_and_alpha[2 * i + 1] >= 128 && (grey_and_alpha[2 * i] >= 128) != is_dark;
  }

  std::size_t width() const { return width_; }
  std::size_t height() const { return height_; }
  bool at(std::size_t row, std::size_t column) const { return is_contact_[row * width_ + column]; }

 private:
  std::size_t width_ = 0, height_ = 0;
  std::vector<bool> is_contact_;
};

}  // namespace

MaskedContact parse_mask(const std::string& bytes, double metres_per_pixel, bool is_dark,
                         const std::string& file) {
  const Mask mask(bytes, is_dark, file);
  const char* const other =
      is_dark ? "without --dark the light pixels count" : "with --dark the dark pixels count";
  MaskedContact contact;
  double sum_x = 0, sum_y = 0, sum_xx = 0, sum_yy = 0, sum_xy = 0, edges = 0;
  // From the middle, where fewer digits cancel.
  const double middle_x = 0.5 * double(mask.width()), middle_y = 0.5 * double(mask.height());
  for (std::size_t row = 0; row < mask.height(); ++row)
    for (std::size_t column = 0; column < mask.width(); ++column) {
      if (!mask.at(row, column)) continue;
      if (row == 0 || column == 0 || row + 1 == mask.height() || column + 1 == mask.width())
        throw InputError(file,
                         fmt::format("the contact reaches the picture's edge at row {}, column {}",
                                     row + 1, column + 1),
                         "", fmt::format("a contact inside the picture; {}", other));
      edges += !mask.at(row - 1, column) + !mask.at(row + 1, column) + !mask.at(row, column - 1) +
               !mask.at(row, column + 1);
      const double x = double(column) + 0.5 - middle_x, y = middle_y - double(row) - 0.5;
      ++contact.pixels;
      sum_x += x;
      sum_y += y;
      sum_xx += x * x;
      sum_yy += y * y;
      sum_xy += x * y;
    }
  if (contact.pixels == 0)
    throw InputError(file, "the picture has no contact", "",
                     fmt::format("pixels {} than half; {}", is_dark ? "darker" : "lighter", other));
  const double count = double(contact.pixels);
  const double mean_x = sum_x / count, mean_y = sum_y / count;
  const double xx = sum_xx / count - mean_x * mean_x;
  const double yy = sum_yy / count - mean_y * mean_y;
  const double xy = sum_xy / count - mean_x * mean_y;
  const double half = std::hypot(0.5 * (xx - yy), xy);
  const double unit = metres_per_pixel;
  // A single pixel is a square, not a point.
  const auto semi_axis_m = [&](double moment) {
    return 2 * unit * std::sqrt(std::max(moment, 1. / 12));
  };
  contact.a_m = semi_axis_m(0.5 * (xx + yy) + half);
  contact.b_m = semi_axis_m(0.5 * (xx + yy) - half);
  contact.axis_rad = 0.5 * std::atan2(2 * xy, xx - yy);
  contact.centre_m = {unit * (mean_x + middle_x), unit * (middle_y - mean_y)};
  contact.area_m2 = unit * unit * count;
  contact.semi_axis_std_m = unit / std::sqrt(12.);
  // Pixel edges run in steps: around a circle they are 4/pi times as long as it.
  contact.area_std_m2 = 0.25 * kPi * edges * unit * contact.semi_axis_std_m;
  contact.ellipse_departure = 1 - kPi * contact.a_m * contact.b_m / contact.area_m2;
  return contact;
}

}  // namespace softfinger::input
