#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <map>

#include "softfinger/input/triangle_surface.h"

namespace softfinger::meshes {

/// An octahedron, each facet cut into n² and blown up to an ellipsoid: its vertices are exact.
inline TriangleSurface triangulated_ellipsoid(const Eigen::Vector3d& semi_axes,
                                              const Eigen::Vector3d& centre, int n) {
  TriangleSurface surface;
  std::map<std::array<int, 3>, int> index;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [entry, added] = index.emplace(at, static_cast<int>(surface.vertices_m.size()));
    if (added) {
      const Eigen::Vector3d unit = Eigen::Vector3d(at[0], at[1], at[2]).normalized();
      surface.vertices_m.push_back(centre + semi_axes.cwiseProduct(unit));
    }
    return entry->second;
  };
  for (int octant = 0; octant < 8; ++octant) {
    const int sx = octant & 1 ? -1 : 1, sy = octant & 2 ? -1 : 1, sz = octant & 4 ? -1 : 1;
    const auto at = [&](int i, int j) { return vertex({sx * i, sy * j, sz * (n - i - j)}); };
    const auto add = [&](int a, int b, int c) {
      if (sx * sy * sz < 0) std::swap(b, c);
      surface.triangles.push_back({a, b, c});
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add(at(i, j), at(i + 1, j), at(i, j + 1));
        if (i + j + 1 < n) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  }
  return surface;
}

inline double longest_edge(const TriangleSurface& surface) {
  double longest = 0;
  for (const auto& t : surface.triangles)
    for (int i = 0; i < 3; ++i)
      longest =
          std::max(longest, (surface.vertices_m[t[i]] - surface.vertices_m[t[(i + 1) % 3]]).norm());
  return longest;
}

}  // namespace softfinger::meshes
