#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "softfinger/input/constants.h"
#include "softfinger/input/triangle_surface.h"

/// Closed surfaces with flat and curved parts. Metres, counter-clockwise seen from outside.
namespace softfinger::meshes {

/// A profile turned about z. @param profile  (radius, height): counter-clockwise about the solid's
/// section at +x; ends with radius 0 lie on the axis, others close a ring
inline TriangleSurface revolved_surface(const std::vector<Eigen::Vector2d>& profile, int segments) {
  TriangleSurface surface;
  std::vector<std::vector<int>> rings;
  for (const Eigen::Vector2d& at : profile) {
    const int count = at.x() > 0 ? segments : 1;
    rings.emplace_back();
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * kPi * i / segments;
      rings.back().push_back(int(surface.vertices_m.size()));
      surface.vertices_m.emplace_back(at.x() * std::cos(angle), at.x() * std::sin(angle), at.y());
    }
  }
  const bool closes = profile.front().x() > 0;
  for (std::size_t r = 0; r + (closes ? 0 : 1) < rings.size(); ++r) {
    const auto &lower = rings[r], &upper = rings[(r + 1) % rings.size()];
    for (int i = 0; i < segments; ++i) {
      const auto at = [i](const std::vector<int>& ring, int ahead) {
        return ring[std::size_t(i + ahead) % ring.size()];
      };
      if (lower.size() > 1) surface.triangles.push_back({at(lower, 0), at(lower, 1), at(upper, 0)});
      if (upper.size() > 1) surface.triangles.push_back({at(lower, 1), at(upper, 1), at(upper, 0)});
    }
  }
  return surface;
}

/// A box around the origin, its edges rounded; `cuts` squares along each edge of a face.
inline TriangleSurface rounded_box_surface(const Eigen::Vector3d& size_m, double edge_radius_m,
                                           int cuts) {
  TriangleSurface surface;
  const Eigen::Vector3d half = size_m / 2;
  const Eigen::Vector3d core = half.array() - edge_radius_m;
  const auto vertex = [&](const Eigen::Vector3d& on_box) {
    const Eigen::Vector3d inner = on_box.cwiseMax(-core).cwiseMin(core);
    const Eigen::Vector3d point =
        edge_radius_m > 0 ? Eigen::Vector3d(inner + edge_radius_m * (on_box - inner).normalized())
                          : on_box;
    for (int v = 0; v < int(surface.vertices_m.size()); ++v)
      if ((surface.vertices_m[std::size_t(v)] - point).norm() < 1e-9 * half.norm()) return v;
    surface.vertices_m.push_back(point);
    return int(surface.vertices_m.size()) - 1;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1., 1.})
      for (int i = 0; i < cuts; ++i)
        for (int j = 0; j < cuts; ++j) {
          const auto corner = [&](int di, int dj) {
            Eigen::Vector3d at;
            at[axis] = side * half[axis];
            at[(axis + 1) % 3] = (2. * (i + di) / cuts - 1) * half[(axis + 1) % 3];
            at[(axis + 2) % 3] = (2. * (j + dj) / cuts - 1) * half[(axis + 2) % 3];
            return vertex(at);
          };
          int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (side < 0) std::swap(b, d);
          surface.triangles.push_back({a, b, c});
          surface.triangles.push_back({a, c, d});
        }
  return surface;
}

/// Points of an arc about (radius, height), both ends included.
inline std::vector<Eigen::Vector2d> arc(const Eigen::Vector2d& centre, double radius_m,
                                        double from_rad, double to_rad, int cuts) {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= cuts; ++i) {
    const double angle = from_rad + (to_rad - from_rad) * i / cuts;
    points.push_back(centre + radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return points;
}

/// A drinking glass that stands on z = 0: a foot with a rounded edge, a conical wall, hollow.
inline TriangleSurface glass_surface(double foot_radius_m, double rim_radius_m, double height_m,
                                     int segments) {
  const double wall_m = 0.06 * rim_radius_m, round_m = 2 * wall_m;
  std::vector<Eigen::Vector2d> profile = {{0, 0}};
  for (const Eigen::Vector2d& at : arc({foot_radius_m - round_m, round_m}, round_m, -kPi / 2, 0, 6))
    profile.push_back(at);
  const int cuts = 30;
  for (int i = 1; i <= cuts; ++i)
    profile.emplace_back(foot_radius_m + (rim_radius_m - foot_radius_m) * i / cuts,
                         round_m + (height_m - round_m) * i / cuts);
  for (int i = 0; i <= cuts; ++i)
    profile.emplace_back(rim_radius_m - wall_m - (rim_radius_m - foot_radius_m) * i / cuts,
                         height_m - (height_m - round_m) * i / cuts);
  profile.emplace_back(0, round_m);
  return revolved_surface(profile, segments);
}

}  // namespace softfinger::meshes
