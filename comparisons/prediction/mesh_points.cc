#include "comparisons/prediction/mesh_points.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::prediction {
namespace {

using Eigen::Vector3d;

/// The point of a segment nearest to `point`.
Vector3d nearest_on_segment(const Vector3d& from, const Vector3d& to, const Vector3d& point) {
  const Vector3d along = to - from;
  const double square = along.squaredNorm();
  const double part = square > 0 ? std::clamp(along.dot(point - from) / square, 0., 1.) : 0;
  return from + part * along;
}

}  // namespace

Vector3d extreme_point_m(const TriangleSurface& surface, const Vector3d& direction) {
  const auto vertex = [&](int index) -> const Vector3d& {
    return surface.vertices_m[static_cast<std::size_t>(index)];
  };
  double farthest = -std::numeric_limits<double>::infinity();
  Vector3d low = Vector3d::Constant(-farthest), high = -low;
  for (const auto& triangle : surface.triangles)
    for (const int corner : triangle) {
      farthest = std::max(farthest, vertex(corner).dot(direction));
      low = low.cwiseMin(vertex(corner));
      high = high.cwiseMax(vertex(corner));
    }
  constexpr double kSame = 1e-5;  // four decimals of a millimetre, on a fingertip
  const double level = farthest - kSame * (high - low).norm();
  const auto is_extreme = [&](int corner) { return vertex(corner).dot(direction) >= level; };

  // The centre of the extreme facets by their area; without facets of edges by their length;
  // without edges of vertices.
  Vector3d weighted = Vector3d::Zero(), of_edges = Vector3d::Zero(), of_vertices = Vector3d::Zero();
  double area = 0, length = 0, count = 0;
  const auto for_each_extreme_edge = [&](const auto& visit) {
    for (const auto& triangle : surface.triangles)
      for (std::size_t i = 0; i < 3; ++i)
        if (is_extreme(triangle[i]) && is_extreme(triangle[(i + 1) % 3]))
          visit(vertex(triangle[i]), vertex(triangle[(i + 1) % 3]));
  };
  for (const auto& triangle : surface.triangles) {
    const bool whole = std::all_of(triangle.begin(), triangle.end(), is_extreme);
    const Vector3d &a = vertex(triangle[0]), &b = vertex(triangle[1]), &c = vertex(triangle[2]);
    const double twice = whole ? (b - a).cross(c - a).norm() : 0;
    weighted += twice * (a + b + c) / 3;
    area += twice;
    for (const int corner : triangle)
      if (is_extreme(corner)) {
        of_vertices += vertex(corner);
        ++count;
      }
  }
  for_each_extreme_edge([&](const Vector3d& from, const Vector3d& to) {
    const double edge = (to - from).norm();
    of_edges += edge * (from + to) / 2;
    length += edge;
  });
  const Vector3d centre = area > 0     ? weighted / area
                          : length > 0 ? of_edges / length
                                       : Vector3d(of_vertices / count);

  // The part need not hold its centre: a ring does not.
  Vector3d best = Vector3d::Zero();
  double distance = std::numeric_limits<double>::infinity();
  const auto offer = [&](const Vector3d& point) {
    if ((point - centre).squaredNorm() >= distance) return;
    distance = (point - centre).squaredNorm();
    best = point;
  };
  for (const auto& triangle : surface.triangles) {
    for (const int corner : triangle)
      if (is_extreme(corner)) offer(vertex(corner));
    if (!std::all_of(triangle.begin(), triangle.end(), is_extreme)) continue;
    const Vector3d &a = vertex(triangle[0]), &b = vertex(triangle[1]), &c = vertex(triangle[2]);
    const Vector3d normal = (b - a).cross(c - a);
    if (!(normal.squaredNorm() > 0)) continue;
    const Vector3d inside = centre - normal * (normal.dot(centre - a) / normal.squaredNorm());
    const auto is_left = [&](const Vector3d& from, const Vector3d& to) {
      return (to - from).cross(inside - from).dot(normal) >= 0;
    };
    if (is_left(a, b) && is_left(b, c) && is_left(c, a)) offer(inside);
  }
  for_each_extreme_edge([&](const Vector3d& from, const Vector3d& to) {
    offer(nearest_on_segment(from, to, centre));
  });
  return best;
}

QuadricFit fit_around(const TriangleSurface& surface, const Vector3d& point_m,
                      const Vector3d* outward_normal) {
  constexpr std::size_t kVertices = 40;
  constexpr int kEnough = 15;
  std::vector<double> distances_m;
  for (const auto& vertex : surface.vertices_m) distances_m.push_back((vertex - point_m).norm());
  const std::size_t nth = std::min(kVertices, distances_m.size()) - 1;
  std::nth_element(distances_m.begin(), distances_m.begin() + static_cast<std::ptrdiff_t>(nth),
                   distances_m.end());
  double radius_m = distances_m[nth];
  // The count may include vertices on the other side of a thin body; then the region has to grow.
  for (int attempt = 0;; ++attempt, radius_m *= 1.3) {
    constexpr int kLastAttempt = 5;
    try {
      const QuadricFit fit = fit_quadric(surface, point_m, outward_normal, radius_m);
      if (fit.points >= kEnough || attempt == kLastAttempt) return fit;
    } catch (const InputError&) {
      if (attempt == kLastAttempt) throw;
    }
  }
}

std::vector<Vector3d> points_around(const TriangleSurface& surface, const Vector3d& centre_m) {
  constexpr double kFirst = 0.02, kSpread = 0.5;
  constexpr std::size_t kMost = 100;
  std::vector<std::pair<double, const Vector3d*>> sorted;
  for (const Vector3d& vertex : surface.vertices_m)
    sorted.emplace_back((vertex - centre_m).norm(), &vertex);
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& one, const auto& other) { return one.first < other.first; });
  std::vector<Vector3d> points;
  for (const auto& candidate : sorted) {
    const auto is_apart = [&](const Vector3d& other) {
      return (*candidate.second - other).norm() >= kSpread * candidate.first;
    };
    if (candidate.first >= kFirst * sorted.back().first &&
        std::all_of(points.begin(), points.end(), is_apart))
      points.push_back(*candidate.second);
    if (points.size() == kMost) break;
  }
  return points;
}

std::string doubt_of(const QuadricFit& fit) {
  std::string doubt;
  if (fit.surface_kind == SurfaceKind::sharp_edge)
    doubt = fmt::format("a sharp edge of {:.3g}° lies in the region",
                        fit.sharpest_kink_rad * 180 / kPi);
  // A fit knows the smaller one of the two radii best: if that is in doubt, both are.
  constexpr double kKnown = 0.5;
  const double part = fit.radii_std_m[1] / std::abs(fit.principal.radii_m[1]);
  if (part > kKnown && std::isfinite(part))
    doubt += fmt::format("{}the fit knows the smaller radius to ± {:.0f} % only",
                         doubt.empty() ? "" : "; ", 100 * part);
  return doubt;
}

std::optional<Vector3d> nearest_smooth_point(const TriangleSurface& surface,
                                             const Vector3d& centre_m, const Vector3d* normal) {
  const std::clock_t start = std::clock();
  for (const Vector3d& point : points_around(surface, centre_m)) {
    if (std::clock() - start > kLongestSearch) break;
    try {
      const QuadricFit fit = fit_around(surface, point, nullptr);
      const auto is_round = [&](int i) {
        const double radius_m = fit.principal.radii_m[i];
        return std::isfinite(radius_m) && radius_m > 2 * fit.radii_std_m[i];
      };
      if (is_round(0) && is_round(1) && doubt_of(fit).empty() &&
          (!normal || normal->dot(fit.normal) > 0))
        return point;
    } catch (const InputError&) {
    } catch (const ConvergenceError&) {
    }
  }
  return std::nullopt;
}

std::string in_millimetres(const Vector3d& point_m) {
  const auto rounded = [](double length_m) { return std::round(length_m * 1e7) / 1e4 + 0.0; };
  return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", rounded(point_m.x()), rounded(point_m.y()),
                     rounded(point_m.z()));
}

SurfaceFacts facts_of(const TriangleSurface& surface) {
  SurfaceFacts facts;
  const double infinity = std::numeric_limits<double>::infinity();
  facts.least_m.setConstant(infinity);
  facts.largest_m.setConstant(-infinity);
  // Each edge once per triangle: the smaller vertex first, and in which direction.
  struct Side {
    int from, to;
    bool forwards;
    bool operator<(const Side& other) const {
      return std::pair(from, to) < std::pair(other.from, other.to);
    }
  };
  std::vector<Side> sides;
  sides.reserve(3 * surface.triangles.size());
  for (const auto& triangle : surface.triangles) {
    const auto corner = [&](std::size_t i) -> const Vector3d& {
      return surface.vertices_m[static_cast<std::size_t>(triangle[i])];
    };
    facts.area_m2 += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
    for (std::size_t i = 0; i < 3; ++i) {
      facts.least_m = facts.least_m.cwiseMin(corner(i));
      facts.largest_m = facts.largest_m.cwiseMax(corner(i));
      const int from = triangle[i], to = triangle[(i + 1) % 3];
      sides.push_back({std::min(from, to), std::max(from, to), from < to});
    }
  }
  std::sort(sides.begin(), sides.end());
  for (std::size_t start = 0; start < sides.size();) {
    std::size_t end = start + 1;
    while (end < sides.size() && !(sides[start] < sides[end])) ++end;
    facts.open_edges += end - start != 2 || sides[start].forwards == sides[start + 1].forwards;
    start = end;
  }
  return facts;
}

}  // namespace softfinger::prediction
