#include "comparisons/report/surface_data.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "comparisons/text/base64.h"

namespace softfinger::report {
namespace {

template <typename Number>
std::string encoded_array(const std::vector<Number>& numbers) {
  return text::base64(text::bytes_of(numbers));
}

}  // namespace

TriangleSurface coarsened(const TriangleSurface& surface, std::size_t most_triangles) {
  if (surface.triangles.size() <= most_triangles) return surface;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : surface.vertices_m) box.extend(vertex);
  // Each attempt has three quarters of the cells per side, so this ends.
  for (double cells = std::sqrt(static_cast<double>(most_triangles));; cells *= 0.75) {
    const double cell_m = box.sizes().maxCoeff() / cells;
    TriangleSurface coarse;
    std::vector<int> joined, members;
    std::map<std::array<long, 3>, int> vertex_of_cell;
    for (const Eigen::Vector3d& vertex : surface.vertices_m) {
      const Eigen::Vector3d place = (vertex - box.min()) / cell_m;
      const std::array<long, 3> cell = {static_cast<long>(place.x()), static_cast<long>(place.y()),
                                        static_cast<long>(place.z())};
      const auto [entry, is_new] =
          vertex_of_cell.emplace(cell, static_cast<int>(coarse.vertices_m.size()));
      if (is_new) {
        coarse.vertices_m.emplace_back(Eigen::Vector3d::Zero());
        members.push_back(0);
      }
      joined.push_back(entry->second);
      coarse.vertices_m[entry->second] += vertex;
      ++members[entry->second];
    }
    for (std::size_t i = 0; i < members.size(); ++i) coarse.vertices_m[i] /= members[i];
    for (const auto& [i, j, k] : surface.triangles)
      if (joined[i] != joined[j] && joined[j] != joined[k] && joined[k] != joined[i])
        coarse.triangles.push_back({joined[i], joined[j], joined[k]});
    if (coarse.triangles.size() <= most_triangles) return coarse;
  }
}

TriangleSurface split_at_edges(const TriangleSurface& surface) {
  constexpr double kSharp_rad = 0.6;
  struct Copy {
    Eigen::Vector3d normal;
    int vertex;
  };
  std::vector<std::vector<Copy>> copies(surface.vertices_m.size());
  TriangleSurface split;
  for (std::array<int, 3> triangle : surface.triangles) {
    const auto& [i, j, k] = triangle;
    const Eigen::Vector3d normal = (surface.vertices_m[j] - surface.vertices_m[i])
                                       .cross(surface.vertices_m[k] - surface.vertices_m[i])
                                       .normalized();
    for (int& vertex : triangle) {
      std::vector<Copy>& known = copies[vertex];
      auto copy = std::find_if(known.begin(), known.end(), [&](const Copy& candidate) {
        return candidate.normal.dot(normal) > std::cos(kSharp_rad);
      });
      if (copy == known.end()) {
        split.vertices_m.push_back(surface.vertices_m[vertex]);
        known.push_back({normal, static_cast<int>(split.vertices_m.size()) - 1});
        copy = known.end() - 1;
      }
      vertex = copy->vertex;
    }
    split.triangles.push_back(triangle);
  }
  return split;
}

Json surface_json(const TriangleSurface& surface) {
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  for (const Eigen::Vector3d& vertex : surface.vertices_m)
    for (const double number : vertex) positions.push_back(static_cast<float>(number));
  for (const std::array<int, 3>& triangle : surface.triangles)
    indices.insert(indices.end(), triangle.begin(), triangle.end());
  Json out = {{"positions", encoded_array(positions)}};
  if (surface.vertices_m.size() <= 0x10000)
    out["triangles16"] = encoded_array(std::vector<std::uint16_t>(indices.begin(), indices.end()));
  else
    out["triangles32"] = encoded_array(indices);
  return out;
}

}  // namespace softfinger::report
