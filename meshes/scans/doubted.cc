#include "meshes/scans/doubted.h"

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

namespace softfinger::meshes {

using Eigen::Vector3d;

TriangleSurface doubted(const TriangleSurface& surface, double crease_rad, double part,
                        unsigned int pattern) {
  TriangleSurface result = surface;
  const std::size_t count = surface.vertices_m.size();
  std::vector<Vector3d> normals(count, Vector3d::Zero());
  for (const auto& [i, j, k] : surface.triangles) {
    const auto at = [&](int vertex) {
      return surface.vertices_m[static_cast<std::size_t>(vertex)];
    };
    const Vector3d area = (at(j) - at(i)).cross(at(k) - at(i));
    for (const int vertex : {i, j, k}) normals[static_cast<std::size_t>(vertex)] += area;
  }
  for (Vector3d& normal : normals) normal.normalize();

  std::vector<double> sagitta(count, 0), edges(count, 0);
  for (const auto& triangle : surface.triangles)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto i = static_cast<std::size_t>(triangle[c]),
                 j = static_cast<std::size_t>(triangle[(c + 1) % 3]);
      if (normals[i].dot(normals[j]) < std::cos(crease_rad)) continue;
      const double under =
          (normals[j] - normals[i]).dot(surface.vertices_m[j] - surface.vertices_m[i]) / 8;
      for (const std::size_t vertex : {i, j}) {
        sagitta[vertex] += std::abs(under);
        ++edges[vertex];
      }
    }
  // The generator's numbers are prescribed by the standard, unlike those of its distributions.
  std::mt19937 random(pattern);
  for (std::size_t i = 0; i < count; ++i) {
    const double sign = random() % 2 == 0 ? 1 : -1;
    if (edges[i] > 0) result.vertices_m[i] += sign * part * sagitta[i] / edges[i] * normals[i];
  }
  return result;
}

}  // namespace softfinger::meshes
