#include "comparisons/report/taxel_picture.h"

#include <algorithm>
#include <cmath>

#include "comparisons/report/png_file.h"

namespace softfinger::report {
namespace {

using Colour = std::array<std::uint8_t, 3>;

/// White over yellow and orange to dark red (the scale YlOrRd of ColorBrewer), 0 to 1.
Colour heat_colour(double share) {
  constexpr std::array<std::array<double, 3>, 5> kScale{
      {{255, 255, 255}, {254, 217, 118}, {253, 141, 60}, {227, 26, 28}, {128, 0, 38}}};
  const double place = std::clamp(share, 0., 1.) * double(kScale.size() - 1);
  const std::size_t lower = std::min(std::size_t(place), kScale.size() - 2);
  Colour colour;
  for (std::size_t c = 0; c < 3; ++c)
    colour[c] = std::uint8_t(std::lround(
        kScale[lower][c] + (place - double(lower)) * (kScale[lower + 1][c] - kScale[lower][c])));
  return colour;
}

}  // namespace

std::string taxel_picture(const prediction::TaxelAnswer& answer) {
  const taxels::TaxelGrid& grid = answer.readings.grid;
  constexpr int kLongerSide = 800;
  constexpr Colour kLine{200, 200, 200}, kEdge{0, 90, 181};
  const int side = std::max(8, kLongerSide / std::max(grid.columns, grid.rows));
  const int width = grid.columns * side + 1, height = grid.rows * side + 1;
  const double largest_N = answer.readings.force_N.maxCoeff();
  const double pixel_m = grid.pitch_m / side;
  std::vector<Colour> pixels(std::size_t(width) * std::size_t(height), kLine);
  const auto distance = [&](double i, double j) {
    const double x_m = grid.left_m() + i * pixel_m;
    const double y_m = grid.lower_m() + (height - 1 - j) * pixel_m;
    return std::hypot(x_m / answer.a_m, y_m / answer.b_m);
  };
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      Colour& pixel = pixels[std::size_t(j) * std::size_t(width) + std::size_t(i)];
      if (i % side != 0 && j % side != 0) {
        const double force_N = answer.readings.force_N(grid.rows - 1 - j / side, i / side);
        pixel = heat_colour(largest_N > 0 ? force_N / largest_N : 0);
      }
      // The edge passes between a pixel and one of its neighbours.
      const bool inside = distance(i, j) < 1;
      if (inside != (distance(i + 2, j) < 1) || inside != (distance(i, j + 2) < 1)) pixel = kEdge;
    }
  return png_file(width, height, pixels);
}

}  // namespace softfinger::report
