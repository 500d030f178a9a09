#include "softfinger/geometry/surface_region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::internal {
namespace {

using Eigen::Vector3d;

const double kCosFacing = std::cos(75.0 * kPi / 180);

std::string text(const Vector3d& v) {
  std::ostringstream out;
  out << "(" << v.x() << ", " << v.y() << ", " << v.z() << ")";
  return out.str();
}

double squared_distance_to_segment(const Vector3d& a, const Vector3d& b) {
  const Vector3d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double t = length2 > 0 ? std::clamp(-a.dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (a + t * ab).squaredNorm();
}

/// The point of triangle abc nearest to the origin, by the regions of its Voronoi diagram
/// (C. Ericson, Real-Time Collision Detection, section 5.1.5).
Vector3d nearest_to_origin(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a;
  const double d1 = -ab.dot(a), d2 = -ac.dot(a);
  if (d1 <= 0 && d2 <= 0) return a;
  const double d3 = -ab.dot(b), d4 = -ac.dot(b);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return a + d1 / (d1 - d3) * ab;
  const double d5 = -ab.dot(c), d6 = -ac.dot(c);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  const double along_b = d4 - d3, along_c = d5 - d6;
  if (va <= 0 && along_b >= 0 && along_c >= 0 && along_b + along_c > 0)
    return b + along_b / (along_b + along_c) * (c - b);
  const double sum = va + vb + vc;
  return sum > 0 ? Vector3d(a + vb / sum * ab + vc / sum * ac) : a;
}

}  // namespace

SurfaceNeighbourhood::SurfaceNeighbourhood(const TriangleSurface& surface, const Vector3d& point_m,
                                           const Vector3d* outward_normal)
    : surface_(surface), point_(point_m), centre_(point_m) {
  if (!point_m.allFinite())
    throw InputError("surface", "point", text(point_m), "finite coordinates");
  if (outward_normal && !(outward_normal->allFinite() && outward_normal->norm() > 0))
    throw InputError("surface", "normal", text(*outward_normal), "finite and not zero");
  if (surface.triangles.empty())
    throw InputError("surface", "triangles", "0", "a surface with at least one triangle");

  const std::size_t triangles = surface.triangles.size();
  area_vectors_.resize(triangles);
  std::vector<double> distances(triangles);
  std::vector<Vector3d> nearest(triangles);
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto& [i, j, k] = surface.triangles[t];
    const Vector3d a = relative(i), b = relative(j), c = relative(k);
    area_vectors_[t] = (b - a).cross(c - a);
    nearest[t] = nearest_to_origin(a, b, c);
    distances[t] = nearest[t].norm();
    smallest = std::min(smallest, distances[t]);
    extent_ = std::max({extent_, a.norm(), b.norm(), c.norm()});
  }

  // At a shared edge or vertex round-off must not decide which of the triangles starts the region.
  const double tie = smallest + 1e-9 * extent_;
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < triangles; ++t) {
    if (distances[t] > tie) continue;
    const double area = area_vectors_[t].norm();
    const double score = outward_normal && area > 0
                             ? area_vectors_[t].dot(*outward_normal) / area / outward_normal->norm()
                             : (area > 0 ? 0.0 : -2.0);
    if (score > best || (score == best && distances[t] < distances[seed_])) {
      best = score;
      seed_ = static_cast<int>(t);
    }
  }
  if (outward_normal && best < 0 && best >= -1) {
    throw InputError("surface", "normal", text(*outward_normal),
                     "the outward normal; the triangle nearest to the point faces " +
                         text(area_vectors_[seed_].normalized()) +
                         " (is the normal inward, or the mesh inside out?)");
  }
  distance_ = distances[seed_];
  centre_ = point_m + nearest[seed_];

  first_.assign(surface.vertices_m.size() + 1, 0);
  for (const auto& triangle : surface.triangles)
    for (int v : triangle) ++first_[v + 1];
  for (std::size_t v = 0; v + 1 < first_.size(); ++v) first_[v + 1] += first_[v];
  vertex_triangles_.resize(3 * triangles);
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (std::size_t t = 0; t < triangles; ++t)
    for (int v : surface.triangles[t]) vertex_triangles_[next[v]++] = static_cast<int>(t);
}

SurfaceNeighbourhood::Component SurfaceNeighbourhood::grow(double radius_m,
                                                           const Vector3d& reference_normal) const {
  const double radius2 = radius_m * radius_m * (1 + 1e-12);
  // Neighbouring triangles may disagree on their orientation. The sign of a triangle turns its
  // normal to the side of the first triangle, `seed_`.
  std::vector<char> seen(surface_.triangles.size(), 0), listed(surface_.vertices_m.size(), 0);
  std::vector<double> signs{1.0};
  Component found;
  found.triangles = {seed_};
  seen[seed_] = 1;
  Vector3d normal_sum = Vector3d::Zero();
  for (std::size_t head = 0; head < found.triangles.size(); ++head) {
    const int t = found.triangles[head];
    const double sign = signs[head];
    const auto& triangle = surface_.triangles[t];
    for (int corner = 0; corner < 3; ++corner) {
      const int v = triangle[corner], w = triangle[(corner + 1) % 3];
      const Vector3d a = relative(v), b = relative(w);
      if (a.squaredNorm() <= radius2) {
        // By thirds: a triangle counts with roughly that part of its area that lies inside.
        normal_sum += sign * area_vectors_[t];
        if (!listed[v]) found.vertices.push_back(v);
        listed[v] = 1;
      }
      if (squared_distance_to_segment(a, b) > radius2) continue;
      for (int n = first_[v]; n < first_[v + 1]; ++n) {
        const int other = vertex_triangles_[n];
        if (seen[other]) continue;
        const auto& corners = surface_.triangles[other];
        const auto at = std::find(corners.begin(), corners.end(), v) - corners.begin();
        const bool opposite = corners[(at + 2) % 3] == w;  // runs through the edge as w -> v
        if (!opposite && corners[(at + 1) % 3] != w) continue;
        const double other_sign = opposite ? sign : -sign;
        const double size = area_vectors_[other].norm();
        if (other_sign * area_vectors_[other].dot(reference_normal) < kCosFacing * size) continue;
        seen[other] = 1;
        found.triangles.push_back(other);
        signs.push_back(other_sign);
      }
    }
  }
  found.mean_normal = normal_sum.norm() > 0 ? Vector3d(normal_sum.normalized()) : reference_normal;
  return found;
}

SurfaceNeighbourhood::Component SurfaceNeighbourhood::component(double radius_m) const {
  const Vector3d seed_normal = area_vectors_[seed_].normalized();
  Component first = grow(radius_m, seed_normal);
  // One triangle of a coarse mesh says little about where the surface faces: its surroundings do.
  if (first.mean_normal.dot(seed_normal) < kCosFacing) return first;
  return grow(radius_m, first.mean_normal);
}

int SurfaceNeighbourhood::vertices_within(double radius_m) const {
  return static_cast<int>(component(radius_m).vertices.size());
}

namespace {

/// Collects quadrature samples of triangles clipped at a ball around the origin.
class BallQuadrature {
 public:
  explicit BallQuadrature(double radius_m) : radius_(radius_m) {}

  void add(const std::array<Vector3d, 3>& corners, const std::array<int, 3>& columns) {
    corners_ = corners;
    columns_ = columns;
    clip({Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()}, 0);
  }

  void finish(SurfaceRegion& region) const {
    const auto n = static_cast<Eigen::Index>(weights_.size());
    region.samples_m.resize(3, n);
    region.weights_m2.resize(n);
    region.corners.resize(3, n);
    region.barycentric.resize(3, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      region.samples_m.col(i) = samples_[at];
      region.weights_m2[i] = weights_[at];
      region.corners.col(i) = Eigen::Vector3i(sample_columns_[at].data());
      region.barycentric.col(i) = barycentric_[at];
    }
  }

 private:
  using Barycentric = std::array<Vector3d, 3>;  // the corners of a piece of the triangle

  Vector3d position(const Vector3d& b) const {
    return b[0] * corners_[0] + b[1] * corners_[1] + b[2] * corners_[2];
  }

  void clip(const Barycentric& piece, int depth) {
    const Vector3d a = position(piece[0]), b = position(piece[1]), c = position(piece[2]);
    const double radius2 = radius_ * radius_;
    const std::array<double, 3> outside{a.squaredNorm() - radius2, b.squaredNorm() - radius2,
                                        c.squaredNorm() - radius2};
    if (outside[0] <= 0 && outside[1] <= 0 && outside[2] <= 0) return sample(piece, a, b, c);
    if (nearest_to_origin(a, b, c).squaredNorm() >= radius2) return;
    // Pieces of a tenth of the radius, cut along straight lines, give the area to about 0.1 %.
    const double longest2 =
        std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    if (longest2 > 0.01 * radius2 && depth < 30) {
      // Halving the longest edge keeps slivers from multiplying.
      const int i = longest2 == (b - a).squaredNorm()   ? 0
                    : longest2 == (c - b).squaredNorm() ? 1
                                                        : 2;
      const Vector3d &p = piece[i], &q = piece[(i + 1) % 3], &r = piece[(i + 2) % 3];
      const Vector3d middle = (p + q) / 2;
      clip({p, middle, r}, depth + 1);
      clip({middle, q, r}, depth + 1);
      return;
    }
    std::array<Vector3d, 4> polygon;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      if (outside[i] <= 0) polygon[count++] = piece[i];
      if ((outside[i] <= 0) != (outside[j] <= 0)) {
        const double t = outside[i] / (outside[i] - outside[j]);
        polygon[count++] = (1 - t) * piece[i] + t * piece[j];
      }
    }
    for (std::size_t i = 2; i < count; ++i) {
      sample({polygon[0], polygon[i - 1], polygon[i]}, position(polygon[0]),
             position(polygon[i - 1]), position(polygon[i]));
    }
  }

  void sample(const Barycentric& piece, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const double area = (b - a).cross(c - a).norm() / 2;
    if (!(area > 0)) return;
    const double longest2 =
        std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    const auto add_point = [&](double u, double v, double w, double weight) {
      const Vector3d at = u * piece[0] + v * piece[1] + w * piece[2];
      barycentric_.push_back(at);
      samples_.push_back(position(at));
      weights_.push_back(weight * area);
      sample_columns_.push_back(columns_);
    };
    const auto add_three = [&](double u, double weight) {
      const double v = (1 - u) / 2;
      add_point(u, v, v, weight);
      add_point(v, u, v, weight);
      add_point(v, v, u, weight);
    };
    if (longest2 < radius_ * radius_ / 900) {
      add_point(1.0 / 3, 1.0 / 3, 1.0 / 3, 1);
    } else if (longest2 < radius_ * radius_ / 60) {
      add_three(2.0 / 3, 1.0 / 3);  // degree 2: enough for what is small against the region
    } else {  // degree 4, exact for all products of a quadric's terms (Dunavant 1985)
      add_three(0.108103018168070, 0.223381589678011);
      add_three(0.816847572980459, 0.109951743655322);
    }
  }

  double radius_;
  std::array<Vector3d, 3> corners_;
  std::array<int, 3> columns_;
  std::vector<Vector3d> samples_, barycentric_;
  std::vector<double> weights_;
  std::vector<std::array<int, 3>> sample_columns_;
};

}  // namespace

void SurfaceNeighbourhood::measure_kinks(const Component& found, double radius_m,
                                         SurfaceRegion& region) const {
  const double radius2 = radius_m * radius_m;
  struct Kink {
    double angle, length;
    bool sliver;
  };
  std::vector<Kink> kinks;
  double total = 0;
  std::vector<char> inside(surface_.triangles.size(), 0);
  for (int t : found.triangles) inside[t] = 1;
  for (int t : found.triangles) {
    const auto& triangle = surface_.triangles[t];
    const double area = area_vectors_[t].norm();
    for (int corner = 0; corner < 3; ++corner) {
      const int v = triangle[corner], w = triangle[(corner + 1) % 3];
      if (squared_distance_to_segment(relative(v), relative(w)) > radius2) continue;
      const double length = (relative(v) - relative(w)).norm();
      for (int n = first_[v]; n < first_[v + 1]; ++n) {
        const int other = vertex_triangles_[n];
        if (other == t || (inside[other] && other < t)) continue;  // each edge once
        const auto& corners = surface_.triangles[other];
        const auto at = std::find(corners.begin(), corners.end(), v) - corners.begin();
        const bool opposite = corners[(at + 2) % 3] == w;
        if (!opposite && corners[(at + 1) % 3] != w) continue;
        const double other_area = area_vectors_[other].norm();
        if (!(area > 0) || !(other_area > 0)) continue;
        // Neighbours run through their edge in opposite directions, or one of them is turned.
        const double cosine =
            (opposite ? 1 : -1) * area_vectors_[t].dot(area_vectors_[other]) / (area * other_area);
        // The normal of so thin a triangle is mostly noise.
        const double height = std::min(area, other_area) / length;
        kinks.push_back({std::acos(std::clamp(cosine, -1.0, 1.0)), length,
                         height < 0.2 * std::min(length, radius_m)});
        total += length;
      }
    }
  }
  std::sort(kinks.begin(), kinks.end(),
            [](const Kink& a, const Kink& b) { return a.angle < b.angle; });
  double sum = 0;
  for (const Kink& kink : kinks) {
    sum += kink.length;
    region.usual_kink_rad = kink.angle;
    if (sum >= total / 2) break;
  }
  // A sharp edge runs through the region or along its end: the largest kink that is exceeded along
  // at least half a radius of mesh edges.
  sum = 0;
  for (auto kink = kinks.rbegin(); kink != kinks.rend() && sum < radius_m / 2; ++kink) {
    if (kink->sliver) continue;
    sum += kink->length;
    if (sum >= radius_m / 2) region.sharp_kink_rad = kink->angle;
  }
}

SurfaceRegion SurfaceNeighbourhood::region(double radius_m) const {
  const Component found = component(radius_m);
  SurfaceRegion region;
  region.mean_normal = found.mean_normal;
  region.vertices_within = static_cast<int>(found.vertices.size());
  std::vector<int> column(surface_.vertices_m.size(), -1), vertices = found.vertices;
  for (std::size_t i = 0; i < vertices.size(); ++i) column[vertices[i]] = static_cast<int>(i);
  measure_kinks(found, radius_m, region);
  BallQuadrature quadrature(radius_m);
  for (int t : found.triangles) {
    std::array<Vector3d, 3> corners;
    std::array<int, 3> columns;
    for (std::size_t i = 0; i < 3; ++i) {
      const int v = surface_.triangles[t][i];
      if (column[v] < 0) {
        column[v] = static_cast<int>(vertices.size());
        vertices.push_back(v);
      }
      columns[i] = column[v];
      corners[i] = relative(v);
    }
    quadrature.add(corners, columns);
  }
  quadrature.finish(region);
  region.vertices_m.resize(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i)
    region.vertices_m.col(static_cast<Eigen::Index>(i)) = relative(vertices[i]);
  return region;
}

double SurfaceNeighbourhood::radius_with_points(int count) const {
  double radius = 1e-3 * extent_;
  Component found = component(radius);
  while (static_cast<int>(found.vertices.size()) < count && radius < extent_) {
    radius = std::min(1.5 * radius, extent_);
    found = component(radius);
  }
  if (static_cast<int>(found.vertices.size()) < count) {
    throw InputError("surface", "vertices around the point", std::to_string(found.vertices.size()),
                     "at least " + std::to_string(count) +
                         " connected vertices on the side of the surface that faces the contact");
  }
  std::vector<double> distances;
  for (int v : found.vertices) distances.push_back(relative(v).norm());
  std::nth_element(distances.begin(), distances.begin() + (count - 1), distances.end());
  const double tight = distances[static_cast<std::size_t>(count) - 1] * (1 + 1e-9);
  // A smaller region is not always a subset, as its mean normal differs.
  return vertices_within(tight) >= count ? tight : radius;
}

double SurfaceNeighbourhood::radius_with_facets(int count) const {
  for (double radius = 1e-3 * extent_; radius < extent_; radius *= 1.05)
    if (static_cast<int>(component(radius).triangles.size()) >= count) return radius;
  throw InputError("surface", "facets around the point", "",
                   "at least " + std::to_string(count) +
                       " connected facets on the side of the surface that faces the contact");
}

}  // namespace softfinger::internal
