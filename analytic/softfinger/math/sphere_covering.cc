#include "softfinger/math/sphere_covering.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace softfinger {
namespace {

using Eigen::Vector3d;

HullFacet facet_through(const std::vector<Vector3d>& points, int i, int j, int k) {
  HullFacet facet;
  facet.normal = (points[j] - points[i]).cross(points[k] - points[i]).normalized();
  facet.offset = facet.normal.dot(points[i]);
  facet.vertex[0] = i;
  facet.vertex[1] = j;
  facet.vertex[2] = k;
  return facet;
}

/// Four points that span the space, the first three anticlockwise seen from the fourth's far side;
/// false if there are none.
bool first_tetrahedron(const std::vector<Vector3d>& points, double tolerance, int (&corner)[4]) {
  const int count = int(points.size());
  if (count < 4) return false;
  const auto farthest = [&](auto distance) {
    int best = 0;
    double largest = -1;
    for (int i = 0; i < count; ++i) {
      const double d = distance(points[i]);
      if (d > largest) largest = d, best = i;
    }
    return std::make_pair(best, largest);
  };
  corner[0] = 0;
  const Vector3d origin = points[0];
  const auto [second, length] = farthest([&](const Vector3d& p) { return (p - origin).norm(); });
  if (!(length > tolerance)) return false;
  const Vector3d axis = (points[second] - origin) / length;
  const auto [third, width] =
      farthest([&](const Vector3d& p) { return (p - origin).cross(axis).norm(); });
  if (!(width > tolerance)) return false;
  const Vector3d normal = axis.cross(points[third] - origin).normalized();
  const auto [fourth, height] =
      farthest([&](const Vector3d& p) { return std::abs(normal.dot(p - origin)); });
  if (!(height > tolerance)) return false;
  corner[1] = second;
  corner[2] = third;
  corner[3] = fourth;
  if (normal.dot(points[fourth] - origin) > 0) std::swap(corner[1], corner[2]);
  return true;
}

double smallest_offset(const std::vector<HullFacet>& facets) {
  double smallest = facets.empty() ? 0 : facets.front().offset;
  for (const HullFacet& facet : facets) smallest = std::min(smallest, facet.offset);
  return smallest;
}

std::vector<Vector3d> fibonacci_spiral(int count, bool symmetric) {
  constexpr double kGoldenAngle = 2.39996322972865332223;
  std::vector<Vector3d> points(count);
  const int placed = symmetric ? count / 2 : count;
  for (int i = 0; i < placed; ++i) {
    const double z = symmetric ? (i + 0.5) / placed : (2 * i + 1.0) / placed - 1;
    const double radius = std::sqrt((1 - z) * (1 + z));
    points[i] = {radius * std::cos(kGoldenAngle * i), radius * std::sin(kGoldenAngle * i), z};
    if (symmetric) points[placed + i] = -points[i];
  }
  return points;
}

}  // namespace

std::vector<HullFacet> convex_hull(const std::vector<Vector3d>& points) {
  double size = 0;
  for (const Vector3d& point : points) size = std::max(size, point.cwiseAbs().maxCoeff());
  const double tolerance = 1e-12 * size;
  std::vector<HullFacet> facets;
  int corner[4];
  if (!first_tetrahedron(points, tolerance, corner)) return facets;
  facets.push_back(facet_through(points, corner[0], corner[1], corner[2]));
  for (int side = 0; side < 3; ++side)
    facets.push_back(facet_through(points, corner[(side + 1) % 3], corner[side], corner[3]));

  const std::size_t count = points.size();
  std::vector<HullFacet> kept;
  std::vector<std::uint64_t> rim, reversed;  // directed edges of the facets that a point sees
  for (std::size_t p = 0; p < count; ++p) {
    kept.clear();
    rim.clear();
    for (const HullFacet& facet : facets) {
      if (facet.normal.dot(points[p]) <= facet.offset + tolerance) {
        kept.push_back(facet);
        continue;
      }
      for (int side = 0; side < 3; ++side)
        rim.push_back(std::uint64_t(facet.vertex[side]) << 32 |
                      std::uint64_t(facet.vertex[(side + 1) % 3]));
    }
    if (rim.empty()) continue;
    // An edge whose reverse is also seen lies inside the region to be replaced.
    reversed.clear();
    for (const std::uint64_t edge : rim) reversed.push_back(edge << 32 | edge >> 32);
    std::sort(reversed.begin(), reversed.end());
    for (const std::uint64_t edge : rim)
      if (!std::binary_search(reversed.begin(), reversed.end(), edge))
        kept.push_back(facet_through(points, int(edge >> 32), int(edge & 0xffffffff), int(p)));
    facets.swap(kept);
  }
  return facets;
}

std::vector<Vector3d> sphere_covering(int count, bool symmetric) {
  count = std::max(count, 4);
  symmetric = symmetric && count % 2 == 0 && count >= 6;
  const int moved = symmetric ? count / 2 : count;
  const int steps = std::clamp(60000 / count, 60, 1500);
  std::vector<Vector3d> points = fibonacci_spiral(count, symmetric), best = points;
  std::vector<Vector3d> target(count);
  double best_offset = -1;
  for (int step = 0; step <= steps; ++step) {
    const std::vector<HullFacet> facets = convex_hull(points);
    const double offset = smallest_offset(facets);
    if (offset > best_offset) {
      best_offset = offset;
      best = points;
    }
    // The largest gaps count more and more, the steps become smaller.
    const double progress = double(step) / steps;
    const double sharpness = 2 + 40 * progress;
    const double stride = 0.6 * (1 - progress) + 0.01;
    std::fill(target.begin(), target.end(), Vector3d::Zero());
    for (const HullFacet& facet : facets) {
      const double gap = (1 - facet.offset) / (1 - offset);
      const double weight = std::pow(std::max(gap, 1e-3), sharpness) + 1e-6;
      for (const int i : facet.vertex) target[i] += weight * (facet.normal - points[i]);
    }
    // Relative to the average weight around a vertex, so that quiet regions move little.
    for (int i = 0; i < moved; ++i) {
      const Vector3d pull = target[i];
      points[i] = (points[i] + stride / 3 * pull).normalized();
      if (symmetric) points[moved + i] = -points[i];
    }
  }
  // Pure torque, the pole of the scaled wrench space, is always exact.
  // As Eigen::Quaterniond::FromTwoVectors, without its case of opposite vectors, which compiles a
  // singular value decomposition: the first point began next to the pole.
  const double doubled_cosine = std::sqrt((1 + best[0].z()) * 2);  // of half the angle
  Eigen::Quaterniond turn;
  turn.vec() = best[0].cross(Vector3d::UnitZ()) * (1 / doubled_cosine);
  turn.w() = doubled_cosine * 0.5;
  for (Vector3d& point : best) point = (turn * point).normalized();
  best[0] = Vector3d::UnitZ();
  if (symmetric)
    for (int i = 0; i < moved; ++i) best[moved + i] = -best[i];
  return best;
}

}  // namespace softfinger
