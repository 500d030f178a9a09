#include "meshes/io/cut_polygon.h"

#include <Eigen/Geometry>
#include <cstddef>
#include <limits>

namespace softfinger::meshes {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Twice the signed area.
double area(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Newell's normal: the mean one where the corners are not quite in a plane; its length is twice
/// the area.
Vector3d normal_of(const std::vector<int>& polygon, const std::vector<Vector3d>& vertices) {
  Vector3d normal = Vector3d::Zero();
  const Vector3d& origin = vertices[std::size_t(polygon[0])];  // a near one: less rounding
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    normal += (vertices[std::size_t(polygon[i])] - origin)
                  .cross(vertices[std::size_t(polygon[i + 1])] - origin);
  return normal;
}

/// The corners along the two coordinates in which the polygon is largest, so that it goes round
/// anticlockwise.
std::vector<Vector2d> flattened(const std::vector<int>& polygon,
                                const std::vector<Vector3d>& vertices) {
  const Vector3d normal = normal_of(polygon, vertices);
  int dropped = 0;
  normal.cwiseAbs().maxCoeff(&dropped);
  int first = (dropped + 1) % 3, second = (dropped + 2) % 3;
  if (normal[dropped] < 0) std::swap(first, second);
  std::vector<Vector2d> corners;
  for (const int vertex : polygon)
    corners.emplace_back(vertices[std::size_t(vertex)][first],
                         vertices[std::size_t(vertex)][second]);
  return corners;
}

/// Whether the triangle of three neighbouring corners lies inside and holds no other corner.
bool is_ear(const std::vector<std::size_t>& left, std::size_t i,
            const std::vector<Vector2d>& corners) {
  const std::size_t n = left.size();
  const std::size_t before = left[(i + n - 1) % n], tip = left[i], after = left[(i + 1) % n];
  const Vector2d &a = corners[before], &b = corners[tip], &c = corners[after];
  if (!(area(a, b, c) > 0)) return false;
  for (const std::size_t other : left) {
    const Vector2d& p = corners[other];
    // A corner of another name may lie in the same place, where a slit leads to a hole.
    if (p == a || p == b || p == c) continue;
    if (area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0) return false;
  }
  return true;
}

}  // namespace

void cut_polygon(const std::vector<int>& polygon, const std::vector<Vector3d>& vertices,
                 std::vector<std::array<int, 3>>& triangles) {
  if (polygon.size() == 3) {
    triangles.push_back({polygon[0], polygon[1], polygon[2]});
    return;
  }
  const std::vector<Vector2d> corners = flattened(polygon, vertices);
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < polygon.size(); ++i) left.push_back(i);
  const auto cut_off = [&](std::size_t i) {
    const std::size_t n = left.size();
    triangles.push_back(
        {polygon[left[(i + n - 1) % n]], polygon[left[i]], polygon[left[(i + 1) % n]]});
    left.erase(left.begin() + std::ptrdiff_t(i));
  };
  // From the ear that was cut last onwards, or every search would begin among the same refusals.
  std::size_t start = 1;
  while (left.size() > 3) {
    std::size_t ear = start % left.size();
    std::size_t refused = 0;
    while (refused < left.size() && !is_ear(left, ear, corners)) {
      ear = (ear + 1) % left.size();
      ++refused;
    }
    cut_off(refused < left.size() ? ear : 1);
    start = ear;
  }
  cut_off(1);
}

}  // namespace softfinger::meshes
