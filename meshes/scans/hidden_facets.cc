#include "meshes/scans/hidden_facets.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <tuple>
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

/// Adds up how often a ray leaves the solids of other parts less how often it enters them: more
/// than 0 from inside of one.
class Crossings {
 public:
  Crossings(const std::vector<Triangle>& triangles, const std::vector<std::size_t>& parts,
            Vector3d from, const Vector3d& direction, std::size_t own)
      : ray_(triangles, std::move(from), direction, own),
        triangles_(triangles),
        parts_(parts),
        direction_(direction),
        own_(own) {}

  bool intersectVolume(const Box& box) { return ray_.intersectVolume(box); }
  bool intersectObject(std::size_t index) {
    if (parts_[index] == parts_[own_] || !ray_.intersectObject(index)) return false;
    const Triangle& triangle = triangles_[index];
    sum_ += triangle.first.cross(triangle.second).dot(direction_) > 0 ? 1 : -1;
    return false;
  }
  int sum() const { return sum_; }
  long steps() const { return ray_.steps(); }

 private:
  Ray ray_;
  const std::vector<Triangle>& triangles_;
  const std::vector<std::size_t>& parts_;
  Vector3d direction_;
  std::size_t own_;
  int sum_ = 0;
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

/// Looks at facets from outside.
class Sight {
 public:
  Sight(const TriangleSurface& surface, const std::vector<std::size_t>& facets,
        const std::vector<Vector3d>& normals)
      : steps_left_(kMostStepsPerFacet * static_cast<long>(facets.size())) {
    std::vector<std::size_t> numbers;
    std::vector<Box> boxes;
    for (const std::size_t facet : facets) {
      const auto corner = [&](std::size_t c) -> const Vector3d& {
        return surface.vertices_m[static_cast<std::size_t>(surface.triangles[facet][c])];
      };
      numbers.push_back(triangles_.size());
      triangles_.push_back({corner(0), corner(1) - corner(0), corner(2) - corner(0)});
      normals_.push_back(normals[facet]);
      Box box(corner(0));
      boxes.push_back(box.extend(corner(1)).extend(corner(2)));
    }
    tree_.init(numbers.begin(), numbers.end(), boxes.begin(), boxes.end());
  }

  /// Whether it is seen in none of the directions from any of its places.
  bool is_hidden(std::size_t i) {
    // The middle, then places near the corners.
    constexpr std::array<std::array<double, 2>, 4> places{
        {{1. / 3, 1. / 3}, {0.1, 0.1}, {0.8, 0.1}, {0.1, 0.8}}};
    const auto directions = directions_from(normals_[i]);
    const auto is_free = [&](const std::array<double, 2>& place, const Vector3d& direction) {
      Ray ray(triangles_, triangles_[i].at(place[0], place[1]), direction, i);
      if (steps_left_ > 0) Eigen::BVIntersect(tree_, ray);
      steps_left_ -= ray.steps();
      return !ray.meets();
    };
    return std::none_of(places.begin(), places.end(), [&](const auto& place) {
      return std::any_of(directions.begin(), directions.end(),
                         [&](const Vector3d& direction) { return is_free(place, direction); });
    });
  }

  /// Whether its middle lies in the solid of another part: along three directions, as parts may be
  /// open.
  bool is_inside_another(std::size_t i, const std::vector<std::size_t>& parts) {
    const auto directions = directions_from(normals_[i]);
    return std::all_of(directions.begin(), directions.begin() + 3, [&](const Vector3d& direction) {
      Crossings crossings(triangles_, parts, triangles_[i].at(1. / 3, 1. / 3), direction, i);
      if (steps_left_ > 0) Eigen::BVIntersect(tree_, crossings);
      steps_left_ -= crossings.steps();
      return crossings.sum() > 0;
    });
  }

  const std::vector<Triangle>& triangles() const { return triangles_; }

 private:
  // Rays take tens of steps. Slivers that cross each other by the thousand would take as many each:
  // from there on facets count as seen.
  static constexpr long kMostStepsPerFacet = 5000;
  std::vector<Triangle> triangles_;
  std::vector<Vector3d> normals_;
  Eigen::KdBVH<double, 3, std::size_t> tree_;
  long steps_left_;
};

}  // namespace

std::vector<bool> hidden_facets(const TriangleSurface& surface,
                                const std::vector<std::size_t>& facets,
                                const std::vector<Vector3d>& normals) {
  Sight sight(surface, facets, normals);
  std::vector<bool> hidden(facets.size());
  for (std::size_t i = 0; i < facets.size(); ++i) hidden[i] = sight.is_hidden(i);
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

namespace {

/// Numbers of sets that grow together (R. Tarjan, J. ACM 22, 1975).
class Sets {
 public:
  explicit Sets(std::size_t count) : parents_(count) {
    std::iota(parents_.begin(), parents_.end(), std::size_t{0});
  }
  std::size_t of(std::size_t one) {
    while (parents_[one] != one) one = parents_[one] = parents_[parents_[one]];
    return one;
  }
  void join(std::size_t one, std::size_t other) { parents_[of(one)] = of(other); }

 private:
  std::vector<std::size_t> parents_;
};

/// Facets that hang together over edges: `parts` over all of them, `faces` over those without a
/// kink of more than 35 degrees.
struct Pieces {
  std::vector<std::size_t> parts, faces;
};

Pieces pieces_of(const TriangleSurface& surface, const std::vector<std::size_t>& facets,
                 const std::vector<Vector3d>& normals) {
  const double smooth = std::cos(35 * M_PI / 180);
  struct Side {
    std::pair<int, int> edge;
    std::size_t facet;
  };
  std::vector<Side> sides;
  sides.reserve(3 * facets.size());
  for (std::size_t i = 0; i < facets.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& triangle = surface.triangles[facets[i]];
      sides.push_back({std::minmax({triangle[c], triangle[(c + 1) % 3]}), i});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& one, const Side& other) {
    return std::tie(one.edge, one.facet) < std::tie(other.edge, other.facet);
  });
  Sets parts(facets.size()), faces(facets.size());
  for (std::size_t start = 0; start < sides.size();) {
    std::size_t end = start + 1;
    while (end < sides.size() && sides[end].edge == sides[start].edge) ++end;
    for (std::size_t k = start + 1; k < end; ++k) parts.join(sides[k].facet, sides[start].facet);
    // Over an edge of more than two facets no face goes on.
    if (end == start + 2 &&
        normals[facets[sides[start].facet]].dot(normals[facets[sides[start + 1].facet]]) > smooth)
      faces.join(sides[start].facet, sides[start + 1].facet);
    start = end;
  }
  Pieces pieces;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    pieces.parts.push_back(parts.of(i));
    pieces.faces.push_back(faces.of(i));
  }
  return pieces;
}

/// Facets spread over a face by its area, at most `most`.
std::vector<std::size_t> spread(const std::vector<std::size_t>& face,
                                const std::vector<double>& areas, std::size_t most) {
  if (face.size() <= most) return face;
  double area = 0;
  for (const std::size_t i : face) area += areas[i];
  std::vector<std::size_t> chosen;
  double passed = 0;
  for (const std::size_t i : face) {
    passed += areas[i];
    if (passed * double(most) > area * (double(chosen.size()) + 0.5)) chosen.push_back(i);
  }
  return chosen;
}

}  // namespace

TriangleSurface outer_skin(const TriangleSurface& surface) {
  std::vector<std::size_t> facets;
  std::vector<double> areas;
  std::vector<Vector3d> normals(surface.triangles.size(), Vector3d::Zero());
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    const auto corner = [&](std::size_t c) -> const Vector3d& {
      return surface.vertices_m[static_cast<std::size_t>(surface.triangles[f][c])];
    };
    const Vector3d area = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    if (!(area.norm() > 0)) continue;
    normals[f] = area.normalized();
    areas.push_back(area.norm());
    facets.push_back(f);
  }
  const Pieces pieces = pieces_of(surface, facets, normals);
  std::map<std::size_t, std::vector<std::size_t>> faces;
  for (std::size_t i = 0; i < facets.size(); ++i) faces[pieces.faces[i]].push_back(i);
  // One smooth face cannot hide itself as a whole.
  if (faces.size() < 2) return surface;
  const bool is_one_part = std::all_of(pieces.parts.begin(), pieces.parts.end(),
                                       [&](std::size_t part) { return part == pieces.parts[0]; });

  constexpr std::size_t kSamples = 60, kFewFaces = 50;
  constexpr double kMostSeen = 0.1;
  // A facet that lies farthest along its own normal is seen: of convex bodies each does.
  const auto is_farthest = [&](std::size_t i) {
    const Vector3d& normal = normals[facets[i]];
    const auto height = [&](int vertex) {
      return normal.dot(surface.vertices_m[static_cast<std::size_t>(vertex)]);
    };
    const double own = height(surface.triangles[facets[i]][0]);
    const double tolerance = 1e-3 * std::sqrt(areas[i]);
    return std::all_of(surface.triangles.begin(), surface.triangles.end(),
                       [&](const auto& other) { return height(other[0]) <= own + tolerance; });
  };
  std::optional<Sight> sight;
  std::vector<bool> hidden(facets.size());
  for (const auto& [number, face] : faces) {
    const std::vector<std::size_t> samples = spread(face, areas, kSamples);
    const auto most_seen = static_cast<std::size_t>(kMostSeen * double(samples.size()));
    const auto count_seen = [&](const auto& is_seen) {
      std::size_t seen = 0;
      for (const std::size_t i : samples) {
        seen += is_seen(i);
        if (seen > most_seen) break;
      }
      return seen;
    };
    const bool is_few = faces.size() <= kFewFaces;
    if (is_one_part && is_few && count_seen(is_farthest) > most_seen) continue;
    if (!sight) sight.emplace(surface, facets, normals);
    if (count_seen([&](std::size_t i) { return !sight->is_hidden(i); }) <= most_seen)
      for (const std::size_t i : face) hidden[i] = true;
    else if (!is_one_part)
      for (const std::size_t i : face)
        hidden[i] = sight->is_inside_another(i, pieces.parts) && sight->is_hidden(i);
  }
  if (std::all_of(hidden.begin(), hidden.end(), [](bool is) { return is; })) return surface;
  std::vector<bool> left_out(surface.triangles.size());
  for (std::size_t i = 0; i < facets.size(); ++i) left_out[facets[i]] = hidden[i];
  TriangleSurface skin;
  std::vector<int> renumbered(surface.vertices_m.size(), -1);
  for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
    if (left_out[f]) continue;
    std::array<int, 3> triangle = surface.triangles[f];
    for (int& corner : triangle) {
      int& number = renumbered[static_cast<std::size_t>(corner)];
      if (number < 0) {
        number = static_cast<int>(skin.vertices_m.size());
        skin.vertices_m.push_back(surface.vertices_m[static_cast<std::size_t>(corner)]);
      }
      corner = number;
    }
    skin.triangles.push_back(triangle);
  }
  return skin;
}

}  // namespace softfinger::meshes
