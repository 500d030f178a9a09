#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "softfinger/input/constants.h"
#include "softfinger/input/triangle_surface.h"

/// Small triangulated surfaces whose curvature is known.
namespace softfinger::samples {

/// z = height(x, y) over a square of half width w, n x n cells, facing +z.
inline TriangleSurface graph(double w, int n, const std::function<double(double, double)>& height) {
  TriangleSurface surface;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double x = (2.0 * i / n - 1) * w, y = (2.0 * j / n - 1) * w;
      surface.vertices_m.emplace_back(x, y, height(x, y));
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, b = a + n + 1;
      surface.triangles.push_back({a, b, b + 1});
      surface.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return surface;
}

/// Quadric with radii along directions turned by `axis_rad` from x.
inline TriangleSurface quadric(double w, int n, double radius_u, double radius_v,
                               double axis_rad = 0) {
  const double c = std::cos(axis_rad), s = std::sin(axis_rad);
  return graph(w, n, [=](double x, double y) {
    const double u = c * x + s * y, v = c * y - s * x;
    return -(u * u / radius_u + v * v / radius_v) / 2;
  });
}

/// Sphere from an octahedron whose triangles are cut into four `levels` times.
inline TriangleSurface sphere(double radius, int levels) {
  TriangleSurface surface;
  for (int axis = 0; axis < 3; ++axis)
    for (double sign : {1.0, -1.0})
      surface.vertices_m.push_back(sign * Eigen::Vector3d::Unit(axis));
  for (int x : {0, 1})
    for (int y : {2, 3})
      for (int z : {4, 5}) {
        if ((x + y + z) % 2 == 0)
          surface.triangles.push_back({x, y, z});
        else
          surface.triangles.push_back({x, z, y});
      }
  for (int level = 0; level < levels; ++level) {
    std::map<std::array<int, 2>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [entry, added] =
          middles.emplace(std::array<int, 2>{std::min(a, b), std::max(a, b)},
                          static_cast<int>(surface.vertices_m.size()));
      if (added)
        surface.vertices_m.push_back((surface.vertices_m[a] + surface.vertices_m[b]).normalized());
      return entry->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : surface.triangles) {
      const int d = middle(a, b), e = middle(b, c), f = middle(c, a);
      finer.insert(finer.end(), {{a, d, f}, {d, b, e}, {f, e, c}, {d, e, f}});
    }
    surface.triangles = finer;
  }
  for (auto& v : surface.vertices_m) v *= radius;
  return surface;
}

}  // namespace softfinger::samples
