#include "comparisons/prediction/flat_faces.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "softfinger/geometry/quadric_fit.h"

namespace softfinger::prediction {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// A surface with what the search for faces asks of it again and again.
class Facets {
 public:
  explicit Facets(const TriangleSurface& surface) : surface_(surface) {
    const std::size_t count = surface.triangles.size();
    Vector3d low = Vector3d::Constant(kInfinite), high = -low;
    std::vector<std::tuple<int, int, int>> sides;
    sides.reserve(3 * count);
    for (std::size_t f = 0; f < count; ++f) {
      areas_.push_back((corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0)) / 2);
      for (std::size_t c = 0; c < 3; ++c) {
        low = low.cwiseMin(corner(f, c));
        high = high.cwiseMax(corner(f, c));
        const auto [from, to] =
            std::minmax(surface.triangles[f][c], surface.triangles[f][(c + 1) % 3]);
        sides.emplace_back(from, to, int(f));
      }
    }
    size_m_ = (high - low).norm();
    Vector3d sizes = high - low;
    std::sort(sizes.begin(), sizes.end());
    width_m_ = sizes[1];
    std::sort(sides.begin(), sides.end());
    neighbours_.resize(count);
    for (std::size_t start = 0; start < sides.size();) {
      std::size_t end = start + 1;
      const auto edge = [&](std::size_t k) {
        return std::pair(std::get<0>(sides[k]), std::get<1>(sides[k]));
      };
      while (end < sides.size() && edge(end) == edge(start)) ++end;
      // A face ends where more than two facets meet.
      if (end == start + 2) {
        const int one = std::get<2>(sides[start]), other = std::get<2>(sides[start + 1]);
        neighbours_[std::size_t(one)].push_back(other);
        neighbours_[std::size_t(other)].push_back(one);
      }
      start = end;
    }
  }

  const Vector3d& corner(std::size_t facet, std::size_t c) const {
    return surface_.vertices_m[static_cast<std::size_t>(surface_.triangles[facet][c])];
  }
  const Vector3d& area(std::size_t facet) const { return areas_[facet]; }
  const std::vector<int>& neighbours(std::size_t facet) const { return neighbours_[facet]; }
  std::size_t count() const { return areas_.size(); }
  double size_m() const { return size_m_; }
  double width_m() const { return width_m_; }

 private:
  const TriangleSurface& surface_;
  std::vector<Vector3d> areas_;  ///< along the normals
  std::vector<std::vector<int>> neighbours_;
  double size_m_ = 0, width_m_ = 0;
};

struct Plane {
  Vector3d point, normal;
};

/// The least-squares plane of the facets, weighted by their areas.
Plane plane_of(const Facets& facets, const std::vector<int>& face) {
  Vector3d sum = Vector3d::Zero(), normal = Vector3d::Zero();
  double area = 0;
  for (const int f : face) {
    const auto facet = std::size_t(f);
    const double weight = facets.area(facet).norm();
    sum +=
        weight * (facets.corner(facet, 0) + facets.corner(facet, 1) + facets.corner(facet, 2)) / 3;
    normal += facets.area(facet);
    area += weight;
  }
  Plane plane{sum / area, normal.normalized()};
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const int f : face)
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector3d from = facets.corner(std::size_t(f), c) - plane.point;
      spread += facets.area(std::size_t(f)).norm() * from * from.transpose();
    }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
  // A strip says nothing of the plane across it.
  if (!(eigen.eigenvalues()[1] > 1e-6 * eigen.eigenvalues()[2])) return plane;
  const Vector3d thin = eigen.eigenvectors().col(0);
  plane.normal = thin.dot(plane.normal) < 0 ? Vector3d(-thin) : thin;
  return plane;
}

/// Facets around a seed whose corners lie in the plane.
std::vector<int> grown(const Facets& facets, int seed, const Plane& plane, double tolerance_m,
                       std::vector<int>& visited, int visit) {
  constexpr double kSameSide = 0.99;  // needles apart
  const auto lies_in = [&](int f) {
    const auto facet = std::size_t(f);
    for (std::size_t c = 0; c < 3; ++c)
      if (!(std::abs((facets.corner(facet, c) - plane.point).dot(plane.normal)) <= tolerance_m))
        return false;
    const Vector3d& area = facets.area(facet);
    const bool is_needle = area.norm() < tolerance_m * tolerance_m;
    return is_needle || area.dot(plane.normal) >= kSameSide * area.norm();
  };
  std::vector<int> face{seed};
  visited[std::size_t(seed)] = visit;
  for (std::size_t next = 0; next < face.size(); ++next)
    for (const int other : facets.neighbours(std::size_t(face[next]))) {
      int& seen = visited[std::size_t(other)];
      if (seen == visit || !lies_in(other)) continue;
      seen = visit;
      face.push_back(other);
    }
  return face;
}

double cross(const Vector2d& one, const Vector2d& other) {
  return one.x() * other.y() - one.y() * other.x();
}

/// Convex hull, counter-clockwise (A. M. Andrew, Inf. Process. Lett. 9, 1979).
std::vector<Vector2d> hull_of(std::vector<Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const Vector2d& one, const Vector2d& other) {
    return std::pair(one.x(), one.y()) < std::pair(other.x(), other.y());
  });
  std::vector<Vector2d> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t start = hull.size();
    for (const Vector2d& point : points) {
      while (hull.size() >= start + 2 &&
             !(cross(hull.back() - hull[hull.size() - 2], point - hull.back()) > 0))
        hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

struct Rectangle {
  Vector2d along = Vector2d::UnitX();  ///< the longer side
  Vector2d middle = Vector2d::Zero();
  double length = kInfinite, width = kInfinite;
};

/// The smallest rectangle around a convex polygon: it lies along one of the edges.
Rectangle rectangle_of(const std::vector<Vector2d>& hull) {
  constexpr std::size_t kMostDirections = 500;
  const std::size_t step = 1 + hull.size() / kMostDirections;
  Rectangle best;
  for (std::size_t i = 0; i < hull.size(); i += step) {
    const Vector2d along = (hull[(i + 1) % hull.size()] - hull[i]).normalized();
    Vector2d low = Vector2d::Constant(kInfinite), high = -low;
    for (const Vector2d& point : hull) {
      const Vector2d turned(along.dot(point), cross(along, point));
      low = low.cwiseMin(turned);
      high = high.cwiseMax(turned);
    }
    const Vector2d sides = high - low, centre = (low + high) / 2, across(-along.y(), along.x());
    if (sides.prod() < best.length * best.width)
      best = {sides.x() < sides.y() ? across : along, centre.x() * along + centre.y() * across,
              sides.maxCoeff(), sides.minCoeff()};
  }
  return best;
}

double distance_to_segment(const Vector2d& point, const Vector2d& from, const Vector2d& to) {
  const Vector2d along = to - from;
  const double square = along.squaredNorm();
  const double part = square > 0 ? std::clamp(along.dot(point - from) / square, 0., 1.) : 0;
  return (from + part * along - point).norm();
}

/// Describes a face; its room is 0 where nothing of it lies apart from its edges.
FlatFace described(const Facets& facets, std::vector<int> triangles, const Plane& plane,
                   std::vector<int>& visited, int visit) {
  FlatFace face;
  face.normal = plane.normal;
  const Eigen::Matrix3d axes = surface_axes(plane.normal);
  const auto flat = [&](const Vector3d& point) -> Vector2d {
    return axes.leftCols<2>().transpose() * (point - plane.point);
  };
  std::vector<Vector2d> points;
  std::vector<std::pair<Vector2d, Vector2d>> edges;
  Vector2d centre = Vector2d::Zero();
  for (const int f : triangles) visited[std::size_t(f)] = visit;
  for (const int f : triangles) {
    const auto facet = std::size_t(f);
    const double area = facets.area(facet).norm();
    face.area_m2 += area;
    std::array<Vector2d, 3> corners;
    for (std::size_t c = 0; c < 3; ++c)
      points.push_back(corners[c] = flat(facets.corner(facet, c)));
    centre += area * (corners[0] + corners[1] + corners[2]) / 3;
    // An edge of the face has no neighbour in it.
    for (std::size_t c = 0; c < 3; ++c) {
      const Vector2d &from = corners[c], &to = corners[(c + 1) % 3];
      const auto& around = facets.neighbours(facet);
      const bool is_inner = std::any_of(around.begin(), around.end(), [&](int other) {
        if (visited[std::size_t(other)] != visit) return false;
        int shared = 0;
        for (std::size_t k = 0; k < 3; ++k)
          shared += facets.corner(std::size_t(other), k) == facets.corner(facet, c) ||
                    facets.corner(std::size_t(other), k) == facets.corner(facet, (c + 1) % 3);
        return shared == 2;
      });
      if (!is_inner) edges.emplace_back(from, to);
    }
  }
  centre /= face.area_m2;
  const Rectangle rectangle = rectangle_of(hull_of(points));
  face.length_m = rectangle.length;
  face.width_m = rectangle.width;

  // The roomiest of the face's centre and some of its facets' places.
  constexpr std::size_t kMostTried = 200, kMostEdges = 5000;
  std::sort(triangles.begin(), triangles.end(), [&](int one, int other) {
    const double first = facets.area(std::size_t(one)).squaredNorm(),
                 second = facets.area(std::size_t(other)).squaredNorm();
    return std::pair(-first, one) < std::pair(-second, other);
  });
  std::vector<Vector2d> tried;
  for (std::size_t i = 0; i < triangles.size(); i += 1 + triangles.size() / kMostTried) {
    std::array<Vector2d, 3> corners;
    for (std::size_t c = 0; c < 3; ++c)
      corners[c] = flat(facets.corner(std::size_t(triangles[i]), c));
    tried.push_back((corners[0] + corners[1] + corners[2]) / 3);
    for (std::size_t c = 0; c < 3; ++c) tried.push_back((corners[c] + corners[(c + 1) % 3]) / 2);
  }
  const bool holds_centre = std::any_of(triangles.begin(), triangles.end(), [&](int f) {
    std::array<Vector2d, 3> corners;
    for (std::size_t c = 0; c < 3; ++c) corners[c] = flat(facets.corner(std::size_t(f), c));
    for (std::size_t c = 0; c < 3; ++c)
      if (cross(corners[(c + 1) % 3] - corners[c], centre - corners[c]) < 0) return false;
    return true;
  });
  const std::size_t edge_step = 1 + edges.size() / kMostEdges;
  const auto room = [&](const Vector2d& point) {
    double nearest = kInfinite;
    for (std::size_t k = 0; k < edges.size(); k += edge_step)
      nearest = std::min(nearest, distance_to_segment(point, edges[k].first, edges[k].second));
    return nearest;
  };
  Vector2d middle = centre;
  face.room_m = holds_centre ? room(centre) : 0;
  constexpr double kRoomier = 1.2;  // the centre is what one expects
  for (const Vector2d& point : tried)
    if (const double there = room(point); there > kRoomier * face.room_m) {
      face.room_m = there;
      middle = point;
    }
  face.middle_m = plane.point + axes.leftCols<2>() * middle;
  face.triangles = std::move(triangles);
  return face;
}

}  // namespace

std::vector<FlatFace> flat_faces(const TriangleSurface& surface) {
  constexpr double kRounding = 1e-5, kLeastRoom = 0.05;
  const Facets facets(surface);
  const double tolerance_m = kRounding * facets.size_m(),
               least_room_m = kLeastRoom * facets.width_m();
  const double least_area_m2 = 3 * least_room_m * least_room_m;  // of a circle
  std::vector<int> order(facets.count());
  for (std::size_t f = 0; f < order.size(); ++f) order[f] = int(f);
  std::sort(order.begin(), order.end(), [&](int one, int other) {
    const double first = facets.area(std::size_t(one)).squaredNorm(),
                 second = facets.area(std::size_t(other)).squaredNorm();
    return std::pair(-first, one) < std::pair(-second, other);
  });
  std::vector<FlatFace> faces;
  std::vector<char> is_done(facets.count());
  std::vector<int> visited(facets.count(), -1);
  int visit = 0;
  for (const int seed : order) {
    if (is_done[std::size_t(seed)] || !(facets.area(std::size_t(seed)).norm() > 0)) continue;
    std::vector<int> face{seed};
    Plane plane{facets.corner(std::size_t(seed), 0), facets.area(std::size_t(seed)).normalized()};
    // One small facet knows the plane but roughly: it is fitted anew as the face grows.
    constexpr int kMostRounds = 6;
    for (int round = 0; round < kMostRounds; ++round) {
      std::vector<int> larger = grown(facets, seed, plane, tolerance_m, visited, visit++);
      const bool has_grown = larger.size() > face.size();
      face = std::move(larger);
      if (!has_grown) break;
      plane = plane_of(facets, face);
    }
    double area_m2 = 0;
    for (const int f : face) {
      is_done[std::size_t(f)] = true;
      area_m2 += facets.area(std::size_t(f)).norm();
    }
    if (area_m2 < least_area_m2) continue;
    FlatFace found = described(facets, std::move(face), plane, visited, visit++);
    if (found.room_m >= least_room_m) faces.push_back(std::move(found));
  }
  for (FlatFace& face : faces) {
    face.is_outermost = std::all_of(
        surface.triangles.begin(), surface.triangles.end(),
        [&](const std::array<int, 3>& triangle) {
          return std::all_of(triangle.begin(), triangle.end(), [&](int corner) {
            return (surface.vertices_m[std::size_t(corner)] - face.middle_m).dot(face.normal) <=
                   2 * tolerance_m;
          });
        });
  }
  std::sort(faces.begin(), faces.end(),
            [](const FlatFace& one, const FlatFace& other) { return one.area_m2 > other.area_m2; });
  return faces;
}

const FlatFace* face_at(const TriangleSurface& surface, const std::vector<FlatFace>& faces,
                        const Vector3d& point_m) {
  if (faces.empty()) return nullptr;
  const FlatFace* nearest = nullptr;
  double least = kInfinite;
  // Points are typed to a few digits, and lie a little beside the surface.
  constexpr double kBeside = 0.05;
  for (const FlatFace& face : faces) {
    const double height = std::abs((point_m - face.middle_m).dot(face.normal));
    if (height > kBeside * face.width_m || height >= least) continue;
    const Vector3d foot = point_m - (point_m - face.middle_m).dot(face.normal) * face.normal;
    const bool is_inside = std::any_of(face.triangles.begin(), face.triangles.end(), [&](int f) {
      const auto& triangle = surface.triangles[std::size_t(f)];
      for (std::size_t c = 0; c < 3; ++c) {
        const Vector3d &from = surface.vertices_m[std::size_t(triangle[c])],
                       &to = surface.vertices_m[std::size_t(triangle[(c + 1) % 3])];
        const Vector3d side = (to - from).cross(foot - from);
        if (side.dot(face.normal) < -1e-9 * (to - from).squaredNorm()) return false;
      }
      return true;
    });
    if (!is_inside) continue;
    least = height;
    nearest = &face;
  }
  return nearest;
}

bool FaceOutline::is_rectangle() const {
  constexpr double kRectangular = 0.98;
  double area_m2 = 0;
  for (std::size_t i = 0; i < hull_m.size(); ++i)
    area_m2 += cross(hull_m[i], hull_m[(i + 1) % hull_m.size()]) / 2;
  return area_m2 > kRectangular * length_m * width_m;
}

FaceOutline outline_of(const std::vector<Vector3d>& points_m, const Vector3d& normal,
                       double area_m2) {
  const Eigen::Matrix3d axes = surface_axes(normal);
  std::vector<Vector2d> points;
  for (const Vector3d& point_m : points_m)
    points.emplace_back(axes.leftCols<2>().transpose() * (point_m - points_m.front()));
  const std::vector<Vector2d> hull = hull_of(points);
  const Rectangle rectangle = rectangle_of(hull);
  FaceOutline outline;
  outline.length_m = rectangle.length;
  outline.width_m = rectangle.width;
  outline.in_surface.translation() = points_m.front() + axes.leftCols<2>() * rectangle.middle;
  const Vector3d along = axes.leftCols<2>() * rectangle.along;
  outline.in_surface.linear() << along, normal.cross(along), normal;
  double hull_area_m2 = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector2d from = hull[i] - rectangle.middle;
    hull_area_m2 += cross(from, hull[(i + 1) % hull.size()] - rectangle.middle) / 2;
    outline.hull_m.emplace_back(rectangle.along.dot(from), cross(rectangle.along, from));
  }
  outline.filled = area_m2 / hull_area_m2;
  return outline;
}

FaceOutline outline_of(const TriangleSurface& surface, const FlatFace& face) {
  std::vector<Vector3d> points_m = {face.middle_m};
  for (const int f : face.triangles)
    for (const int corner : surface.triangles[std::size_t(f)])
      points_m.push_back(surface.vertices_m[std::size_t(corner)]);
  return outline_of(points_m, face.normal, face.area_m2);
}

std::string in_words(const FlatFace& face) {
  return fmt::format("flat, {:.3g} x {:.3g} mm: a pad", 1e3 * face.width_m, 1e3 * face.length_m);
}

}  // namespace softfinger::prediction
