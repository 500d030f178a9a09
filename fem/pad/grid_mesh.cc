#include "fem/pad/grid_mesh.h"

#include <cmath>

namespace softfinger::fem {
namespace {

/// Size of the cells at a place.
double cell_size(const GridAxis& axis, int cells, double at) {
  constexpr double growth = 0.5, at_edge = 1.5, at_wall = 0.6, largest = 8;
  const double in_contact = axis.contact / cells;
  double size = std::max(in_contact, largest / cells);
  const auto limit = [&](double place, double smallest) {
    size = std::min(size, smallest + growth * std::abs(at - place));
  };
  // A wall that is far from the contact sees little of it.
  constexpr double per_distance = 0.3;
  if (!axis.is_mirrored)
    limit(axis.low, at_wall / cells + per_distance * (axis.first() - axis.low));
  limit(axis.high, at_wall / cells + per_distance * (axis.high - axis.last()));
  const double edge = std::min(in_contact, at_edge / cells);
  if (axis.last() < axis.high) limit(axis.last(), edge);
  if (axis.first() > axis.low) limit(axis.first(), edge);
  const bool inside = at >= axis.first() && at <= axis.last();
  return inside ? std::min(size, in_contact) : size;
}

/// Lines lie where the integral of 1/size reaches whole numbers, all of them moved alike so that
/// the last one lies at the end.
template <class Size>
std::vector<double> graded_lines(double low, double high, const Size& size) {
  constexpr int samples = 4000;
  const double step = (high - low) / samples;
  std::vector<double> count{0};
  for (int i = 0; i < samples; ++i)
    count.push_back(count.back() + step / size(low + (i + 0.5) * step));
  const int intervals = std::max(2, static_cast<int>(std::ceil(count.back())));
  std::vector<double> lines{low};
  std::size_t sample = 0;
  for (int line = 1; line < intervals; ++line) {
    const double wanted = count.back() * line / intervals;
    while (count[sample + 1] < wanted) ++sample;
    const double share = (wanted - count[sample]) / (count[sample + 1] - count[sample]);
    lines.push_back(low + (static_cast<double>(sample) + share) * step);
  }
  lines.push_back(high);
  return lines;
}

}  // namespace

std::vector<double> grid_lines(const GridAxis& axis, int cells) {
  return graded_lines(axis.low, axis.high, [&](double at) { return cell_size(axis, cells, at); });
}

std::vector<double> grid_depths(double contact, int cells) {
  constexpr double growth = 0.5, at_face = 2, at_bond = 0.6, largest = 4;
  return graded_lines(-1, 0, [&](double at) {
    return std::min({largest / cells, at_bond / cells + growth * (at + 1),
                     at_face * std::min(contact, 1.0) / cells - growth * at});
  });
}

PlacedMesh grid_mesh(const std::vector<double>& x, const std::vector<double>& y,
                     const std::vector<double>& depths, const Eigen::AlignedBox2d& touchable) {
  PlacedMesh mesh;
  mesh.curved = false;
  for (const double z : depths)
    for (const double v : y)
      for (const double u : x) mesh.vertices.emplace_back(u, v, z);
  const std::size_t row = x.size(), layer = row * y.size();
  std::vector<Eigen::AlignedBox3d> boxes;
  for (std::size_t k = 0; k + 1 < depths.size(); ++k)
    for (std::size_t j = 0; j + 1 < y.size(); ++j)
      for (std::size_t i = 0; i + 1 < x.size(); ++i) {
        const std::size_t first = k * layer + j * row + i;
        std::array<unsigned int, 8> vertices{};
        for (std::size_t corner = 0; corner < 8; ++corner)
          vertices[corner] = static_cast<unsigned int>(
              first + (corner & 1) + (corner & 2 ? row : 0) + (corner & 4 ? layer : 0));
        mesh.cells.push_back(vertices);
        const Eigen::Vector2d middle((x[i] + x[i + 1]) / 2, (y[j] + y[j + 1]) / 2);
        mesh.touched.push_back(k + 2 == depths.size() && touchable.contains(middle));
        boxes.emplace_back(Eigen::Vector3d(x[i], y[j], depths[k]),
                           Eigen::Vector3d(x[i + 1], y[j + 1], depths[k + 1]));
      }
  mesh.place = [boxes](std::size_t cell, const Eigen::Vector3d& unit) -> Eigen::Vector3d {
    return boxes[cell].min() + unit.cwiseProduct(boxes[cell].sizes());
  };
  return mesh;
}

}  // namespace softfinger::fem
