#pragma once

#include <array>
#include <filesystem>
#include <string>

/// The contact as somebody pictured it: an ink print, or pixels marked in a photograph.
namespace softfinger::input {

/// Limits of a picture. The message that refuses one states the limit.
constexpr std::size_t kLargestMaskFile = 64 << 20;  ///< bytes
constexpr double kMostMaskPixels = 50e6;

/// The contact's pixels, in metres. Their edge is known to within half a pixel, to the same side
/// all round (where is the ink dark enough?): its standard deviation is a pixel/sqrt(12), and that
/// of the area the contact's perimeter times as much.
struct MaskedContact {
  long long pixels = 0;
  double area_m2 = 0, area_std_m2 = 0;
  /// Semi-axes of the ellipse with the second moments of the pixels: a = 2 sqrt(moment/area).
  double a_m = 0, b_m = 0, semi_axis_std_m = 0;
  double axis_rad = 0;  ///< of the long axis, from the picture's right side anticlockwise
  std::array<double, 2> centre_m{};  ///< from the picture's left and upper edge
  /// (area - pi a b)/area: ridges, holes and specks make it negative.
  double ellipse_departure = 0;
};

/// @param bytes  a PNG file
/// @param is_dark  the contact is what is darker than half, like ink on paper; else lighter. Half
///                 is that of the stored values, whatever their depth and the file's gamma. What is
///                 more than half transparent is no contact
/// @param file  for messages
/// @throws InputError for what is no PNG, has too many pixels, no contact, or a contact that
/// reaches the picture's edge and may go on beyond it
MaskedContact parse_mask(const std::string& bytes, double metres_per_pixel, bool is_dark,
                         const std::string& file);

}  // namespace softfinger::input
