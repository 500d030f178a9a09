#include "meshes/scans/hidden_facets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/BVH>
#include <utility>

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;
using Box = Eigen::AlignedBox3d;

struct Triangle {
  Vector3d corner, first, second;  ///< first, second: edges from the corner

  Vector3d at(double u, double v) const { return corner + u * first + v * second; }
  double size() const { return first.norm() + second.norm(); }
};

/// Whether a ray meets one of the triangles (T. Moeller, B. Trumbore, Fast, minimum storage
/// ray-triangle intersection, J. Graphics Tools 2, 1997).
class Ray {
 public:
  Ray(const std::vector<Triangle>& triangles, Vector3d from, const Vector3d& direction,
      std::size_t own)
      : triangles_(triangles), from_(std::move(from)), direction_(direction), own_(own) {}

  bool intersectVolume(const Box& box) {
    ++steps_;
    double enters = 0, leaves = std::numeric_limits<double>::infinity();
    for (int c = 0; c < 3; ++c) {
      const double to_low = (box.min()[c] - from_[c]) / direction_[c],
                   to_high = (box.max()[c] - from_[c]) / direction_[c];
      // In the plane of a face there is 0 / 0. A box missed there makes a facet seen.
      enters = std::max(enters, std::min(to_low, to_high));
      leaves = std::min(leaves, std::max(to_low, to_high));
    }
    return enters <= leaves;
  }

  /// True ends the search.
  bool intersectObject(std::size_t index) {
    if (index == own_) return false;
    const Triangle& triangle = triangles_[index];
    const Vector3d across = direction_.cross(triangle.second);
    const double determinant = triangle.first.dot(across);
    const double parallel = 1e-12 * triangle.first.norm() * triangle.second.norm();
    if (!(std::abs(determinant) > parallel)) return false;
    const Vector3d start = from_ - triangle.corner;
    const double u = start.dot(across) / determinant;
    const Vector3d other = start.cross(triangle.first);
    const double v = direction_.dot(other) / determinant;
    const double distance = triangle.second.dot(other) / determinant;
    // Copies of the ray's own facet, given twice or from both sides, do not block it.
    constexpr double round_off = 1e-7;
    const double size = triangles_[own_].size() + triangle.size();
    meets_ = u >= 0 && v >= 0 && u + v <= 1 && distance > round_off * size;
    return meets_;
  }

  bool meets() const { return meets_; }
  long steps() const { return steps_; }  ///< through the tree

 private:
  const std::vector<Triangle>& triangles_;
  Vector3d from_, direction_;
  std::size_t own_;
  bool meets_ = false;
  long steps_ = 0;
};

/// Directions in which a facet is looked at. The normal comes first: most facets are seen from
/// there.
std::array<Vector3d, 7> directions_from(const Vector3d& normal) {
  constexpr double tilt = 50 * M_PI / 180;
  const Vector3d one = normal.unitOrthogonal(), two = normal.cross(one);
  std::array<Vector3d, 7> directions;
  directions[0] = normal;
  for (int i = 0; i < 6; ++i) {
    const double angle = i * M_PI / 3;
    directions[static_cast<std::size_t>(i + 1)] =
        std::cos(tilt) * normal + std::sin(tilt) * (std::cos(angle) * one + std::sin(angle) * two);
  }
  return directions;
}

}  // namespace

std::vector<bool> hidden_facets(const TriangleSurface& surface,
                                const std::vector<std::size_t>& facets,
                                const std::vector<Vector3d>& normals) {
  std::vector<Triangle> triangles;
  std::vector<std::size_t> numbers;
  std::vector<Box> boxes;
  for (const std::size_t facet : facets) {
    const auto corner = [&](std::size_t c) -> const Vector3d& {
      return surface.vertices_m[static_cast<std::size_t>(surface.triangles[facet][c])];
    };
    numbers.push_back(triangles.size());
    triangles.push_back({corner(0), corner(1) - corner(0), corner(2) - corner(0)});
    Box box(corner(0));
    boxes.push_back(box.extend(corner(1)).extend(corner(2)));
  }
  const Eigen::KdBVH<double, 3, std::size_t> tree(numbers.begin(), numbers.end(), boxes.begin(),
                                                  boxes.end());
  // The middle, then places near the corners.
  constexpr std::array<std::array<double, 2>, 4> places{
      {{1. / 3, 1. / 3}, {0.1, 0.1}, {0.8, 0.1}, {0.1, 0.8}}};
  // Rays take tens of steps. Slivers that cross each other by the thousand would take as many each:
  // from there on facets count as seen.
  constexpr long most_steps_per_facet = 5000;
  long steps_left = most_steps_per_facet * static_cast<long>(facets.size());
  const auto is_hidden = [&](std::size_t i) {
    const auto directions = directions_from(normals[facets[i]]);
    const auto is_free = [&](const std::array<double, 2>& place, const Vector3d& direction) {
      Ray ray(triangles, triangles[i].at(place[0], place[1]), direction, i);
      if (steps_left > 0) Eigen::BVIntersect(tree, ray);
      steps_left -= ray.steps();
      return !ray.meets();
    };
    return std::none_of(places.begin(), places.end(), [&](const auto& place) {
      return std::any_of(directions.begin(), directions.end(),
                         [&](const Vector3d& direction) { return is_free(place, direction); });
    });
  };
  std::vector<bool> hidden(facets.size());
  for (std::size_t i = 0; i < facets.size(); ++i) hidden[i] = is_hidden(i);
  if (std::all_of(hidden.begin(), hidden.end(), [](bool is) { return is; }))
    hidden.assign(facets.size(), false);
  return hidden;
}

TriangleSurface seen_surface(const TriangleSurface& surface, double within) {
  std::vector<std::size_t> near;
  std::vector<Vector3d> normals(surface.triangles.size(), Vector3d::Zero());
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const auto& [i, j, k] = surface.triangles[f];
    const Vector3d &a = surface.vertices_m[static_cast<std::size_t>(i)],
                   &b = surface.vertices_m[static_cast<std::size_t>(j)],
                   &c = surface.vertices_m[static_cast<std::size_t>(k)];
    const Vector3d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const Vector3d apart = low.cwiseMax(-high).cwiseMax(0.0);
    if (apart.norm() > within) continue;
    const Vector3d area = (b - a).cross(c - a);
    const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
    // A needle's normal is round-off.
    if (!(area.norm() > 1e-6 * longest * longest)) continue;
    normals[f] = area.normalized();
    near.push_back(f);
  }
  const std::vector<bool> hidden = hidden_facets(surface, near, normals);
  TriangleSurface seen;
  seen.vertices_m = surface.vertices_m;
  for (std::size_t i = 0; i < near.size(); ++i)
    if (!hidden[i]) seen.triangles.push_back(surface.triangles[near[i]]);
  return seen;
}

}  // namespace softfinger::meshes
