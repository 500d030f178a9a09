#include "meshes/placement/placed_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "softfinger/input/constants.h"
#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

constexpr int kLeafTriangles = 4;
constexpr double kSteepestTangent = 0.1;  // cosine between a vertex's normal and a line
constexpr double kFarthest = 0.05;  // distance from point to surface, in the surface's extents

std::string text(const Vector3d& v) {
  std::ostringstream out;
  out << "(" << v.x() << ", " << v.y() << ", " << v.z() << ")";
  return out.str();
}

/// The point of triangle abc nearest to the origin: in its plane if that falls inside, else on the
/// nearest edge.
Vector3d nearest_to_origin(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a);
  if (a.cross(b).dot(normal) >= 0 && b.cross(c).dot(normal) >= 0 && c.cross(a).dot(normal) >= 0 &&
      normal.squaredNorm() > 0)
    return a.dot(normal) / normal.squaredNorm() * normal;
  Vector3d nearest = a;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    const Vector3d edge = to - from;
    const double length2 = edge.squaredNorm();
    const double t = length2 > 0 ? std::clamp(-from.dot(edge) / length2, 0.0, 1.0) : 0.0;
    const Vector3d point = from + t * edge;
    if (point.squaredNorm() < nearest.squaredNorm()) nearest = point;
  }
  return nearest;
}

/// The part of the line inside the box, as an interval of t; empty as (inf, -inf).
std::pair<double, double> clip(const Vector3d& low, const Vector3d& high, const Vector3d& from,
                               const Vector3d& direction) {
  double enter = -kInfinity, leave = kInfinity;
  for (int i = 0; i < 3; ++i) {
    if (direction[i] == 0) {
      if (from[i] < low[i] || from[i] > high[i]) return {kInfinity, -kInfinity};
      continue;
    }
    const double one = (low[i] - from[i]) / direction[i], two = (high[i] - from[i]) / direction[i];
    enter = std::max(enter, std::min(one, two));
    leave = std::min(leave, std::max(one, two));
  }
  return {enter, leave};
}

}  // namespace

PlacedSurface::PlacedSurface(const TriangleSurface& surface, const SurfacePlacement& placement,
                             Body body)
    : triangles_(surface.triangles) {
  if (triangles_.empty())
    throw InputError("surface", "triangles", "0", "a surface with at least one triangle");
  if (!placement.point_m.allFinite())
    throw InputError("surface", "point", text(placement.point_m), "finite coordinates");
  if (!(placement.outward_normal.allFinite() && placement.outward_normal.norm() > 0))
    throw InputError("surface", "normal", text(placement.outward_normal), "finite and not zero");
  if (!std::isfinite(placement.angle_rad))
    throw InputError("surface", "angle", placement.angle_rad, "finite");
  const Vector3d outward = placement.outward_normal.normalized();
  const Vector3d z = body == Body::below ? outward : Vector3d(-outward);
  const Vector3d across = placement.x_axis - placement.x_axis.dot(z) * z;
  if (!(across.norm() > 1e-6 * placement.x_axis.norm()) || !across.allFinite())
    throw InputError("surface", "x axis", text(placement.x_axis), "a direction across the normal");
  Eigen::Matrix3d frame;  // columns: the contact's axes in the body's coordinates
  frame << across.normalized(), z.cross(across.normalized()), z;

  // At an edge or a vertex several triangles are equally near: the one that faces the normal most
  // counts.
  double nearest = kInfinity, extent = 0, facing = -kInfinity;
  for (const auto& [i, j, k] : triangles_) {
    const Vector3d a = surface.vertices_m[i] - placement.point_m,
                   b = surface.vertices_m[j] - placement.point_m,
                   c = surface.vertices_m[k] - placement.point_m;
    extent = std::max({extent, a.norm(), b.norm(), c.norm()});
    const Vector3d point = nearest_to_origin(a, b, c);
    const double distance = point.norm(), faces = (b - a).cross(c - a).normalized().dot(outward);
    const double same = 1e-9 * extent;
    if (distance < nearest - same || (distance < nearest + same && faces > facing)) {
      nearest = distance;
      facing = faces;
      contact_point_ = placement.point_m + point;
    }
  }
  if (!(nearest <= kFarthest * extent)) {
    std::ostringstream distance;
    distance << nearest << " m from the surface";
    throw InputError("surface", "point", text(placement.point_m) + ", " + distance.str(),
                     "a point on the surface, within a twentieth of its extent");
  }
  if (!(facing > 0)) {
    throw InputError("surface", "normal", text(placement.outward_normal),
                     "the outward normal (is it inward, or the mesh inside out?)");
  }

  to_contact_ = Eigen::AngleAxisd(placement.angle_rad, Vector3d::UnitZ()).toRotationMatrix() *
                frame.transpose();
  vertices_ = in_contact_frame(surface).vertices_m;

  normals_.assign(vertices_.size(), Vector3d::Zero());
  for (const auto& triangle : triangles_) {
    const Vector3d area = (vertices_[triangle[1]] - vertices_[triangle[0]])
                              .cross(vertices_[triangle[2]] - vertices_[triangle[0]]);
    if (!(area.norm() > 0)) continue;
    for (int i = 0; i < 3; ++i) {
      const Vector3d& at = vertices_[triangle[i]];
      const Vector3d one = vertices_[triangle[(i + 1) % 3]] - at,
                     two = vertices_[triangle[(i + 2) % 3]] - at;
      normals_[triangle[i]] += std::atan2(one.cross(two).norm(), one.dot(two)) * area.normalized();
    }
  }
  for (Vector3d& normal : normals_)
    if (normal.norm() > 0) normal.normalize();

  nodes_.reserve(triangles_.size());
  build(0, static_cast<int>(triangles_.size()));
}

int PlacedSurface::build(int first, int last) {
  Node node{Vector3d::Constant(kInfinity), Vector3d::Constant(-kInfinity), first, last, -1};
  for (int t = first; t < last; ++t)
    for (const int vertex : triangles_[t]) {
      node.low = node.low.cwiseMin(vertices_[vertex]);
      node.high = node.high.cwiseMax(vertices_[vertex]);
    }
  int longest = 0;
  const double length = (node.high - node.low).maxCoeff(&longest);
  // Flat boxes get some thickness, so that rounding does not let a line miss them.
  node.low.array() -= 1e-9 * length;
  node.high.array() += 1e-9 * length;
  const int index = static_cast<int>(nodes_.size());
  nodes_.push_back(node);
  if (last - first <= kLeafTriangles) return index;

  const auto centre = [&](const std::array<int, 3>& t) {
    return vertices_[t[0]][longest] + vertices_[t[1]][longest] + vertices_[t[2]][longest];
  };
  const int middle = (first + last) / 2;
  std::nth_element(triangles_.begin() + first, triangles_.begin() + middle,
                   triangles_.begin() + last,
                   [&](const auto& s, const auto& t) { return centre(s) < centre(t); });
  build(first, middle);
  const int second = build(middle, last);
  nodes_[index].second = second;
  return index;
}

std::vector<Vector3d> PlacedSurface::facet_points() const {
  std::vector<Vector3d> points;
  points.reserve(4 * triangles_.size());
  for (const auto& triangle : triangles_) {
    const Vector3d centre =
        (vertices_[triangle[0]] + vertices_[triangle[1]] + vertices_[triangle[2]]) / 3;
    points.push_back(centre);
    for (const int corner : triangle) points.push_back(0.2 * centre + 0.8 * vertices_[corner]);
  }
  return points;
}

TriangleSurface PlacedSurface::in_contact_frame(const TriangleSurface& other) const {
  TriangleSurface result = other;
  for (Vector3d& vertex : result.vertices_m) vertex = to_contact_ * (vertex - contact_point_);
  return result;
}

std::optional<SurfaceHit> PlacedSurface::nearest_exit(const Vector3d& from,
                                                      const Vector3d& direction) const {
  // With this tolerance a line through an edge meets both triangles; without it rounding could let
  // it miss both.
  const double tolerance = 1e-9;
  std::optional<SurfaceHit> hit;
  double best = kInfinity;
  std::array<int, 64> stack;  // the tree is balanced: its depth is the logarithm of its size
  int size = 0;
  stack[size++] = 0;
  while (size > 0) {
    const int index = stack[--size];
    const Node& node = nodes_[index];
    const auto [enter, leave] = clip(node.low, node.high, from, direction);
    if (enter > leave || std::max(enter, -leave) > best) continue;
    if (node.second >= 0) {
      stack[size++] = node.second;
      stack[size++] = index + 1;
      continue;
    }
    for (int t = node.first; t < node.last; ++t) {  // Möller and Trumbore 1997
      const auto& [i, j, k] = triangles_[t];
      const Vector3d one = vertices_[j] - vertices_[i], two = vertices_[k] - vertices_[i];
      const Vector3d area = one.cross(two);
      const double flux = direction.dot(area);
      if (!(flux > tolerance * area.norm() * direction.norm())) continue;
      const Vector3d offset = from - vertices_[i], moment = offset.cross(direction);
      const double b = -two.dot(moment) / flux, c = one.dot(moment) / flux, a = 1 - b - c;
      if (a < -tolerance || b < -tolerance || c < -tolerance) continue;
      const double distance = -offset.dot(area) / flux;
      if (!(std::abs(distance) < best)) continue;
      best = std::abs(distance);
      const Vector3d normal = a * normals_[i] + b * normals_[j] + c * normals_[k];
      const Vector3d point = from + distance * direction;
      double rounding = 0;
      for (const auto& [weight, vertex] : {std::pair(a, i), std::pair(b, j), std::pair(c, k)}) {
        // Beside a sharp edge a tangent plane may be nearly parallel to the line: it is left out.
        const double faces = normals_[vertex].dot(direction) / direction.norm();
        if (faces > kSteepestTangent)
          rounding += 0.5 * weight * normals_[vertex].dot(vertices_[vertex] - point) / faces;
      }
      hit = {point, normal.norm() > 0 ? normal.normalized() : area.normalized(), rounding};
    }
  }
  return hit;
}

}  // namespace softfinger::meshes
