#include "comparisons/prediction/mesh_points.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "meshes/scans/hidden_facets.h"
#include "softfinger/geometry/quadric_fit_internal.h"
#include "softfinger/geometry/surface_region.h"
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

void keep_outer_skin(meshes::SurfaceFile& file, const std::vector<Vector3d>& touched_m) {
  constexpr std::size_t kMostTriangles = 1'000'000;
  const std::size_t all = file.surface.triangles.size();
  if (all > kMostTriangles) return;
  TriangleSurface skin = meshes::outer_skin(file.surface);
  if (skin.triangles.size() == all) return;
  for (const Vector3d& point : touched_m) {
    // Points are typed to a few digits.
    constexpr double kTyped = 1e-4;
    const double nearest_m =
        internal::SurfaceNeighbourhood(file.surface, point, nullptr).distance_m();
    if (internal::SurfaceNeighbourhood(skin, point, nullptr).distance_m() >
        nearest_m + kTyped * file.size_m)
      return;
  }
  file.hidden_triangles = all - skin.triangles.size();
  file.open_edges = facts_of(file.surface).open_edges;
  file.surface = std::move(skin);
}

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

namespace {

/// Relative deviation of the smaller radius; infinite where that is flat.
double doubt_part(const QuadricFit& fit) {
  return fit.radii_std_m[1] / std::abs(fit.principal.radii_m[1]);
}

/// See fit_around.
QuadricFit fit_known_better(const TriangleSurface& surface, const Vector3d& point_m,
                            const Vector3d* outward_normal, QuadricFit fit) {
  constexpr double kKnown = 0.01, kStep = 1.4;
  constexpr int kMostSteps = 8;
  // A fingertip's curvature is not the same beyond that.
  constexpr double kLargestSlope = 0.5;
  double radius_m = fit.region_radius_m;
  for (int step = 0; step < kMostSteps && !(doubt_part(fit) <= kKnown); ++step) {
    radius_m *= kStep;
    if (radius_m > kLargestSlope * std::abs(fit.principal.radii_m[1]) + 2 * fit.radii_std_m[1])
      break;
    try {
      const QuadricFit larger = fit_quadric(surface, point_m, outward_normal, radius_m);
      const double apart = std::abs(1 / larger.principal.radii_m[1] - 1 / fit.principal.radii_m[1]);
      const double allowed = 2 * (larger.radii_std_m[1] / std::pow(larger.principal.radii_m[1], 2) +
                                  fit.radii_std_m[1] / std::pow(fit.principal.radii_m[1], 2));
      if (larger.surface_kind == SurfaceKind::sharp_edge || apart > allowed) break;
      if (doubt_part(larger) < doubt_part(fit)) fit = larger;
    } catch (const InputError&) {
      break;
    } catch (const ConvergenceError&) {
      break;
    }
  }
  return fit;
}

/// The quadric of a wall that is straight in one direction, which has vertices at its ends only:
/// its facets are read as the surface itself, as contacts read them. Nothing where they are too
/// few.
std::optional<QuadricFit> fit_to_facets(const TriangleSurface& surface, const Vector3d& point_m,
                                        const Vector3d* outward_normal) {
  constexpr int kFewestFacets = 10;
  try {
    const internal::SurfaceNeighbourhood there(surface, point_m, outward_normal);
    return internal::fit_quadric_to_facets(
        there, std::max(there.radius_with_facets(kFewestFacets), there.distance_m() * (1 + 1e-9)));
  } catch (const InputError&) {
  } catch (const ConvergenceError&) {
  }
  return std::nullopt;
}

}  // namespace

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
      if (fit.points >= kEnough || attempt == kLastAttempt)
        return fit_known_better(surface, point_m, outward_normal, fit);
    } catch (const InputError&) {
      if (attempt < kLastAttempt) continue;
      if (const auto fit = fit_to_facets(surface, point_m, outward_normal)) return *fit;
      throw;
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
