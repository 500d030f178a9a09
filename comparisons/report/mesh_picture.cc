#include "comparisons/report/mesh_picture.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "comparisons/report/png_file.h"

namespace softfinger::report {
namespace {

using Eigen::Array3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kColumns = 3, kRows = 2, kTile = 320;
/// Samples per pixel and direction: edges are smooth.
constexpr int kSamples = 2;
const Array3d kPaper(1, 1, 1), kInk(0.25, 0.29, 0.34), kSkin(0.93, 0.78, 0.68),
    kMark(0.05, 0.42, 0.75);

/// A viewer at infinity.
struct View {
  const char* from;
  Vector3d right, up;
  Vector3d towards() const { return right.cross(up); }
};

const std::array<View, kColumns * kRows>& views() {
  static const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  static const std::array<View, kColumns* kRows> all = {
      View{"-y", x, z}, {"-x", -y, z}, {"-z", x, -y}, {"+y", -x, z}, {"+x", y, z}, {"+z", x, y}};
  return all;
}

/// Five columns by seven rows, from above.
const std::map<char, std::array<const char*, 7>>& glyphs() {
  static const std::map<char, std::array<const char*, 7>> all = {
      {'+', {"     ", "  #  ", "  #  ", "#####", "  #  ", "  #  ", "     "}},
      {'-', {"     ", "     ", "     ", "#####", "     ", "     ", "     "}},
      {'x', {"     ", "     ", "#   #", " # # ", "  #  ", " # # ", "#   #"}},
      {'y', {"     ", "     ", "#   #", "#   #", " ####", "    #", " ### "}},
      {'z', {"     ", "     ", "#####", "   # ", "  #  ", " #   ", "#####"}},
      {'m', {"     ", "     ", "## # ", "# # #", "# # #", "# # #", "# # #"}},
      {'0', {" ### ", "#   #", "#  ##", "# # #", "##  #", "#   #", " ### "}},
      {'1', {"  #  ", " ##  ", "  #  ", "  #  ", "  #  ", "  #  ", " ### "}},
      {'2', {" ### ", "#   #", "    #", "   # ", "  #  ", " #   ", "#####"}},
      {'5', {"#####", "#    ", "#### ", "    #", "    #", "#   #", " ### "}}};
  return all;
}

class Canvas {
 public:
  static constexpr int width = kColumns * kTile * kSamples, height = kRows * kTile * kSamples;

  Canvas()
      : colour_(std::size_t(width) * height, kPaper),
        depth_(std::size_t(width) * height, -std::numeric_limits<double>::infinity()) {}

  /// @param nearness  what is nearer hides what is behind it
  void put(int x, int y, double nearness, const Array3d& colour) {
    if (x < 0 || y < 0 || x >= width || y >= height) return;
    const std::size_t at = std::size_t(y) * width + std::size_t(x);
    if (nearness < depth_[at]) return;
    depth_[at] = nearness;
    colour_[at] = colour;
  }

  void put_on_top(int x, int y, const Array3d& colour) {
    put(x, y, std::numeric_limits<double>::infinity(), colour);
  }

  void fill(int x, int y, int wide, int high, const Array3d& colour) {
    for (int j = 0; j < high; ++j)
      for (int i = 0; i < wide; ++i) put_on_top(x + i, y + j, colour);
  }

  void disc(const Vector2d& centre, double radius, const Array3d& colour) {
    for (int y = int(centre.y() - radius); y <= int(centre.y() + radius); ++y)
      for (int x = int(centre.x() - radius); x <= int(centre.x() + radius); ++x)
        if (std::hypot(x + 0.5 - centre.x(), y + 0.5 - centre.y()) <= radius)
          put_on_top(x, y, colour);
  }

  void write(int x, int y, int size, const std::string& text) {
    for (const char letter : text) {
      if (const auto glyph = glyphs().find(letter); glyph != glyphs().end())
        for (int row = 0; row < 7; ++row)
          for (int column = 0; column < 5; ++column)
            if (glyph->second[std::size_t(row)][column] == '#')
              fill(x + column * size, y + row * size, size, size, kInk);
      x += 6 * size;
    }
  }

  std::string png() const {
    std::vector<std::array<std::uint8_t, 3>> pixels;
    for (int y = 0; y < height; y += kSamples)
      for (int x = 0; x < width; x += kSamples) {
        Array3d sum = Array3d::Zero();
        for (int j = 0; j < kSamples; ++j)
          for (int i = 0; i < kSamples; ++i)
            sum += colour_[std::size_t(y + j) * width + std::size_t(x + i)];
        const Array3d mean = sum / (kSamples * kSamples);
        const auto byte = [&](int part) { return std::uint8_t(std::lround(255 * mean[part])); };
        pixels.push_back({byte(0), byte(1), byte(2)});
      }
    return png_file(width / kSamples, height / kSamples, pixels);
  }

 private:
  std::vector<Array3d> colour_;
  std::vector<double> depth_;
};

/// One view of the surface, in its tile.
struct Tile {
  const View& view;
  Vector3d centre_m;
  double samples_per_m;
  Vector2d middle;  ///< in samples

  Vector2d place(const Vector3d& point_m) const {
    const Vector3d from_centre = samples_per_m * (point_m - centre_m);
    return middle + Vector2d(view.right.dot(from_centre), -view.up.dot(from_centre));
  }

  void draw(const std::array<Vector3d, 3>& corners_m, Canvas& canvas) const {
    const Vector3d towards = view.towards();
    // From behind the viewer's left shoulder. Files may list corners the wrong way round.
    const Vector3d light = (towards + 0.4 * view.up - 0.3 * view.right).normalized();
    const Vector3d normal =
        (corners_m[1] - corners_m[0]).cross(corners_m[2] - corners_m[0]).normalized();
    const Array3d colour = (0.3 + 0.7 * std::abs(normal.dot(light))) * kSkin;
    std::array<Vector2d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = place(corners_m[k]);
    const auto cross = [](const Vector2d& a, const Vector2d& b) {
      return a.x() * b.y() - a.y() * b.x();
    };
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    if (area == 0) return;
    const Vector2d least = p[0].cwiseMin(p[1]).cwiseMin(p[2]),
                   most = p[0].cwiseMax(p[1]).cwiseMax(p[2]);
    for (int y = int(std::floor(least.y())); y <= int(most.y()); ++y)
      for (int x = int(std::floor(least.x())); x <= int(most.x()); ++x) {
        const Vector2d at(x + 0.5, y + 0.5);
        const double of_1 = cross(at - p[0], p[2] - p[0]) / area;
        const double of_2 = cross(p[1] - p[0], at - p[0]) / area;
        if (of_1 < 0 || of_2 < 0 || of_1 + of_2 > 1) continue;
        const Vector3d here =
            (1 - of_1 - of_2) * corners_m[0] + of_1 * corners_m[1] + of_2 * corners_m[2];
        canvas.put(x, y, towards.dot(here - centre_m), colour);
      }
  }
};

/// Whole millimetres, about a quarter of a tile.
void draw_bar(const Tile& tile, Canvas& canvas) {
  constexpr double kLongest = 0.35 * kTile * kSamples;
  const double most_mm = 1e3 * kLongest / tile.samples_per_m;
  double decade = 1;
  while (10 * decade <= most_mm) decade *= 10;
  const double length_mm = decade * (5 * decade <= most_mm ? 5 : 2 * decade <= most_mm ? 2 : 1);
  const int wide = int(std::lround(1e-3 * length_mm * tile.samples_per_m));
  // A surface of micrometres has no bar.
  if (wide > kLongest) return;
  const int x = int(tile.middle.x()) - kTile * kSamples / 2 + 24,
            y = int(tile.middle.y()) + kTile * kSamples / 2 - 28;
  canvas.fill(x, y, wide, 4, kInk);
  canvas.write(x, y - 26, 3, std::to_string(std::lround(length_mm)) + " mm");
}

}  // namespace

std::string mesh_picture(const TriangleSurface& surface, const std::vector<MeshPoint>& points) {
  Eigen::AlignedBox3d box;
  for (const auto& triangle : surface.triangles)
    for (const int corner : triangle) box.extend(surface.vertices_m[std::size_t(corner)]);
  constexpr double kFilled = 0.8;  // of a tile
  Canvas canvas;
  for (std::size_t v = 0; v < views().size(); ++v) {
    const int column = int(v) % kColumns, row = int(v) / kColumns, tile_size = kTile * kSamples;
    const Tile tile{views()[v], box.center(), kFilled * tile_size / box.sizes().maxCoeff(),
                    tile_size * Vector2d(column + 0.5, row + 0.5)};
    for (const auto& triangle : surface.triangles)
      tile.draw({surface.vertices_m[std::size_t(triangle[0])],
                 surface.vertices_m[std::size_t(triangle[1])],
                 surface.vertices_m[std::size_t(triangle[2])]},
                canvas);
    for (const MeshPoint& point : points) {
      constexpr double kFacing = 0.2;
      if (point.normal.dot(tile.view.towards()) < kFacing) continue;
      canvas.disc(tile.place(point.point_m), 6 * kSamples, kPaper);
      canvas.disc(tile.place(point.point_m), 4 * kSamples, kMark);
    }
    canvas.write(column * tile_size + 24, row * tile_size + 24, 4, tile.view.from);
    draw_bar(tile, canvas);
  }
  return canvas.png();
}

}  // namespace softfinger::report
