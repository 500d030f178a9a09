#include "comparisons/simulation/overlapping_shapes.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "comparisons/simulation/triangulate.h"

namespace softfinger::simulation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A column of the grid enters a shape (+1) or leaves it (-1) at this height.
struct Crossing {
  double z_m = 0;
  std::size_t shape = 0;
  int step = 0;
};

/// Volume that is counted by two shapes; by one mesh twice where both are the same.
struct Overlap {
  std::map<std::pair<std::size_t, std::size_t>, double> volume_m3;
  double body_volume_m3 = 0;
};

class ColumnGrid {
 public:
  explicit ColumnGrid(const Eigen::AlignedBox3d& box) : corner_(box.min().head<2>()) {
    cell_ = (box.max() - box.min()).head<2>() / kColumns;
    columns_.resize(kColumns * kColumns);
  }

  void add(const TriangleSurface& surface, std::size_t shape) {
    for (const auto& corners : surface.triangles) {
      const auto vertex = [&](std::size_t i) -> const Vector3d& {
        return surface.vertices_m[std::size_t(corners[i])];
      };
      add_triangle(vertex(0), vertex(1), vertex(2), shape);
    }
  }

  Overlap overlap(std::size_t shapes) {
    Overlap result;
    const double area_m2 = cell_.prod();
    std::vector<int> counts(shapes);
    for (std::vector<Crossing>& column : columns_) {
      std::sort(column.begin(), column.end(),
                [](const Crossing& one, const Crossing& other) { return one.z_m < other.z_m; });
      std::fill(counts.begin(), counts.end(), 0);
      for (std::size_t i = 0; i + 1 < column.size(); ++i) {
        counts[column[i].shape] += column[i].step;
        count_interval(counts, area_m2 * (column[i + 1].z_m - column[i].z_m), result);
      }
    }
    return result;
  }

 private:
  static constexpr int kColumns = 48;
  /// Place of a column in its cell, away from where the edges of boxes and of regular meshes lie.
  static constexpr double kPlace_x = 0.4371, kPlace_y = 0.5517;

  static void count_interval(const std::vector<int>& counts, double volume_m3, Overlap& result) {
    std::size_t before = counts.size();
    for (std::size_t s = 0; s < counts.size(); ++s) {
      if (counts[s] <= 0) continue;
      result.body_volume_m3 += counts[s] * volume_m3;
      if (counts[s] > 1) result.volume_m3[{s, s}] += volume_m3;
      if (before < counts.size()) result.volume_m3[{before, s}] += volume_m3;
      before = s;
    }
  }

  void add_triangle(const Vector3d& a, const Vector3d& b, const Vector3d& c, std::size_t shape) {
    const auto cross = [](const Vector2d& one, const Vector2d& other) {
      return one.x() * other.y() - one.y() * other.x();
    };
    const Vector2d ab = (b - a).head<2>(), ac = (c - a).head<2>();
    const double twice_area = cross(ab, ac);
    if (twice_area == 0) return;
    const auto first = [&](int axis, double place) {
      const double low = std::min({a[axis], b[axis], c[axis]});
      return std::max(0, int(std::ceil((low - corner_[axis]) / cell_[axis] - place)));
    };
    const auto last = [&](int axis, double place) {
      const double high = std::max({a[axis], b[axis], c[axis]});
      return std::min(kColumns - 1, int(std::floor((high - corner_[axis]) / cell_[axis] - place)));
    };
    for (int i = first(0, kPlace_x); i <= last(0, kPlace_x); ++i)
      for (int j = first(1, kPlace_y); j <= last(1, kPlace_y); ++j) {
        const Vector2d at =
            corner_ + cell_.cwiseProduct(Vector2d(i + kPlace_x, j + kPlace_y)) - a.head<2>();
        const double of_b = cross(at, ac) / twice_area, of_c = cross(ab, at) / twice_area;
        if (of_b < 0 || of_c < 0 || of_b + of_c > 1) continue;
        // A facet that faces downwards is where a column on its way up enters.
        columns_[std::size_t(i * kColumns + j)].push_back(
            {a.z() + of_b * (b.z() - a.z()) + of_c * (c.z() - a.z()), shape,
             twice_area < 0 ? 1 : -1});
      }
  }

  Vector2d corner_, cell_;
  std::vector<std::vector<Crossing>> columns_;
};

Overlap overlap_of(const std::vector<input::Shape>& shapes) {
  std::vector<TriangleSurface> surfaces;
  Eigen::AlignedBox3d box;
  for (const input::Shape& shape : shapes) {
    surfaces.push_back(triangulate(shape, 0));
    for (const Vector3d& vertex : surfaces.back().vertices_m) box.extend(vertex);
  }
  ColumnGrid grid(box);
  for (std::size_t s = 0; s < surfaces.size(); ++s) grid.add(surfaces[s], s);
  return grid.overlap(surfaces.size());
}

/// The shape's name without the body's, so that copies say it once.
std::string in_words(const Overlap& overlap) {
  constexpr double kRounding = 1e-3;
  std::pair<std::size_t, std::size_t> worst;
  double largest_m3 = 0, sum_m3 = 0;
  std::size_t count = 0;
  for (const auto& [pair, volume_m3] : overlap.volume_m3) {
    sum_m3 += volume_m3;
    if (volume_m3 > kRounding * overlap.body_volume_m3) ++count;
    if (volume_m3 <= largest_m3) continue;
    largest_m3 = volume_m3;
    worst = pair;
  }
  if (count == 0) return "";
  const std::string where =
      worst.first == worst.second
          ? fmt::format("shells of shape {} lie within each other or overlap", worst.first + 1)
          : fmt::format("shapes {} and {} overlap", worst.first + 1, worst.second + 1);
  return fmt::format(
      "{}{}: about {:.2g} % of the volume counts twice in its mass or inertia; give mass_g with "
      "inertia_kg_mm2, or one closed surface",
      where, count > 1 ? fmt::format(", and {} other pairs", count - 1) : "",
      100 * sum_m3 / overlap.body_volume_m3);
}

}  // namespace

std::vector<std::string> overlap_remarks(const input::Scene& scene) {
  std::vector<std::string> remarks;
  std::set<std::string> said;
  for (const input::SceneBody& body : scene.bodies) {
    if (!body.is_mass_derived) continue;
    const std::string text = in_words(overlap_of(body.shapes));
    if (!text.empty() && said.insert(text).second)
      remarks.push_back("body \"" + body.name + "\": " + text);
  }
  return remarks;
}

}  // namespace softfinger::simulation
