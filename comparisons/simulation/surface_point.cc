#include "comparisons/simulation/surface_point.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "softfinger/input/constants.h"

namespace softfinger::simulation {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A point lies on an edge when it is nearer to it than this part of the shape's size.
constexpr double kOnEdge = 1e-9;

Matrix3d tangential(const Vector3d& normal) {
  return Matrix3d::Identity() - normal * normal.transpose();
}

/// An axis that a direction is not along. Round-off in a direction along an axis does not change
/// it.
Vector3d axis_beside(const Vector3d& direction) {
  return std::abs(direction.x()) < 0.8 * direction.norm() ? Vector3d::UnitX() : Vector3d::UnitY();
}

/// The direction of a vector; `otherwise` for the zero vector, which has none.
Vector3d direction_of(const Vector3d& vector, const Vector3d& otherwise) {
  const double length = vector.norm();
  return length > 0 ? Vector3d(vector / length) : otherwise;
}

SurfacePoint near(const input::Sphere& sphere, const Vector3d& point) {
  SurfacePoint result;
  result.normal = direction_of(point, Vector3d::UnitZ());
  result.point_m = sphere.radius_m * result.normal;
  result.curvature_per_m = tangential(result.normal) / sphere.radius_m;
  return result;
}

SurfacePoint near(const input::Ellipsoid& ellipsoid, const Vector3d& point) {
  const Vector3d weights = ellipsoid.semi_axes_m.cwiseAbs2().cwiseInverse();
  const double level = std::sqrt(point.dot(weights.cwiseProduct(point)));
  SurfacePoint result;
  result.point_m =
      level > 0 ? Vector3d(point / level) : Vector3d(ellipsoid.semi_axes_m.z() * Vector3d::UnitZ());
  const Vector3d gradient = weights.cwiseProduct(result.point_m);
  result.normal = gradient.normalized();
  const Matrix3d plane = tangential(result.normal);
  result.curvature_per_m = plane * weights.asDiagonal() * plane / gradient.norm();
  return result;
}

SurfacePoint near(const input::Cylinder& cylinder, const Vector3d& point) {
  const double r = cylinder.radius_m, half = cylinder.length_m / 2;
  const double edge = kOnEdge * std::max(r, half);
  const Vector3d across(point.x(), point.y(), 0);
  const Vector3d outward = direction_of(across, Vector3d::UnitX());
  const double past_side = across.norm() - r, past_end = std::abs(point.z()) - half;
  const double end = point.z() < 0 ? -half : half;
  SurfacePoint result;
  if (past_side > edge && past_end > edge) {  // beyond the rim
    result.point_m = r * outward + end * Vector3d::UnitZ();
    result.normal = direction_of(point - result.point_m, outward);
    result.smooth = false;
  } else if (past_side > past_end) {
    result.point_m = r * outward + point.z() * Vector3d::UnitZ();
    result.normal = outward;
    result.curvature_per_m =
        (tangential(outward) - Vector3d::UnitZ() * Vector3d::UnitZ().transpose()) / r;
    result.smooth = past_end < -edge;
  } else {
    result.point_m = across + end * Vector3d::UnitZ();
    result.normal = Vector3d::UnitZ() * (end < 0 ? -1 : 1);
    result.smooth = past_side < -edge;
  }
  return result;
}

SurfacePoint near(const input::Capsule& capsule, const Vector3d& point) {
  const double half = capsule.length_m / 2;
  const Vector3d core(0, 0, std::clamp(point.z(), -half, half));
  SurfacePoint result = near(input::Sphere{capsule.radius_m}, point - core);
  result.point_m += core;
  if (std::abs(point.z()) < half)
    result.curvature_per_m -= Vector3d::UnitZ() * Vector3d::UnitZ().transpose() / capsule.radius_m;
  return result;
}

SurfacePoint near(const input::Box& box, const Vector3d& point) {
  const Vector3d half = box.size_m / 2;
  const double edge = kOnEdge * half.maxCoeff();
  const Vector3d past = point.cwiseAbs() - half;
  SurfacePoint result;
  if ((past.array() > edge).count() > 1) {  // beyond an edge or a corner
    result.point_m = point.cwiseMax(-half).cwiseMin(half);
    result.normal = (point - result.point_m).normalized();
    result.smooth = false;
    return result;
  }
  int face = 0;
  past.maxCoeff(&face);
  const double side = point[face] < 0 ? -1 : 1;
  result.point_m = point;
  result.point_m[face] = side * half[face];
  result.normal = side * Vector3d::Unit(face);
  result.smooth = past[(face + 1) % 3] < -edge && past[(face + 2) % 3] < -edge;
  return result;
}

SurfacePoint near(const input::HalfSpace&, const Vector3d& point) {
  SurfacePoint result;
  result.point_m = Vector3d(point.x(), point.y(), 0);
  return result;
}

SurfacePoint near(const input::Mesh&, const Vector3d& point) {
  SurfacePoint result;
  result.point_m = point;
  result.smooth = false;
  return result;
}

Vector3d support(const input::Sphere& sphere, const Vector3d& direction) {
  return sphere.radius_m * direction_of(direction, Vector3d::UnitZ());
}
Vector3d support(const input::Ellipsoid& ellipsoid, const Vector3d& direction) {
  const Vector3d scaled = ellipsoid.semi_axes_m.cwiseProduct(direction);
  return ellipsoid.semi_axes_m.cwiseProduct(direction_of(scaled, Vector3d::UnitZ()));
}
Vector3d support(const input::Cylinder& cylinder, const Vector3d& direction) {
  const Vector3d across(direction.x(), direction.y(), 0);
  return cylinder.radius_m * direction_of(across, Vector3d::Zero()) +
         std::copysign(cylinder.length_m / 2, direction.z()) * Vector3d::UnitZ();
}
Vector3d support(const input::Capsule& capsule, const Vector3d& direction) {
  return support(input::Sphere{capsule.radius_m}, direction) +
         std::copysign(capsule.length_m / 2, direction.z()) * Vector3d::UnitZ();
}
Vector3d support(const input::Box& box, const Vector3d& direction) {
  Vector3d corner = box.size_m / 2;
  for (int i = 0; i < 3; ++i) corner[i] = std::copysign(corner[i], direction[i]);
  return corner;
}
Vector3d support(const input::HalfSpace&, const Vector3d& direction) {
  return std::numeric_limits<double>::infinity() * direction;
}
Vector3d support(const input::Mesh& mesh, const Vector3d& direction) {
  const auto& vertices = mesh.surface->vertices_m;
  return *std::max_element(vertices.begin(), vertices.end(),
                           [&](const Vector3d& one, const Vector3d& other) {
                             return one.dot(direction) < other.dot(direction);
                           });
}

/// Six points of each rim: fixed to the body while it stands on its end, else counted from the
/// lowest one, so that a rolling rim is round.
std::vector<Vector3d> bearing(const input::Cylinder& cylinder, const Vector3d& direction) {
  std::vector<Vector3d> points;
  const Vector3d across(direction.x(), direction.y(), 0);
  const double tilt = across.norm(), along = std::abs(direction.z());
  constexpr double kUpright = 1e-6;
  const double start = tilt > kUpright * along ? std::atan2(across.y(), across.x()) : 0;
  for (const double end : {-0.5, 0.5}) {
    if (end * direction.z() < 0 && tilt < kUpright * along) continue;
    const bool stands = along > kUpright * tilt && end * direction.z() > 0;
    for (int i = 0; i < (stands ? 6 : 1); ++i) {
      const double angle = start + i * kPi / 3;
      points.emplace_back(cylinder.radius_m * std::cos(angle), cylinder.radius_m * std::sin(angle),
                          end * cylinder.length_m);
    }
  }
  return points;
}
std::vector<Vector3d> bearing(const input::Capsule& capsule, const Vector3d& direction) {
  const Vector3d low = support(input::Sphere{capsule.radius_m}, direction);
  const Vector3d end(0, 0, capsule.length_m / 2);
  return {low - end, low + end};
}
std::vector<Vector3d> bearing(const input::Box& box, const Vector3d&) {
  std::vector<Vector3d> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(box.size_m.cwiseProduct(
        Vector3d(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5)));
  return corners;
}
/// The farthest vertices in directions around a given one. A vertex is farthest in one of them
/// while the body could tip over it.
template <class Support>
std::vector<Vector3d> tipping_points(const Vector3d& direction, const Support& farthest) {
  constexpr int kDirections = 8;
  // Beside the direction, in radians: a side is flat where its vertices differ by less than this
  // part of its size.
  constexpr double kBeside = 0.01;
  // No tilt lies along an axis, where all of a straight edge would be equally far.
  const Vector3d one = direction.cross(axis_beside(direction)).normalized();
  const Vector3d other = direction.normalized().cross(one);
  std::vector<Vector3d> points;
  for (int i = 0; i < kDirections; ++i) {
    const double angle = (i + 0.37) * 2 * kPi / kDirections;
    const Vector3d point = farthest(direction.normalized() +
                                    kBeside * (std::cos(angle) * one + std::sin(angle) * other));
    if (std::find(points.begin(), points.end(), point) == points.end()) points.push_back(point);
  }
  return points;
}
std::vector<Vector3d> bearing(const input::Mesh& mesh, const Vector3d& direction) {
  return tipping_points(direction, [&](const Vector3d& beside) { return support(mesh, beside); });
}
std::vector<Vector3d> bearing(const input::HalfSpace&, const Vector3d&) { return {}; }
template <class Round>
std::vector<Vector3d> bearing(const Round& round, const Vector3d& direction) {
  return {support(round, direction)};
}

}  // namespace

SurfacePoint surface_near(const input::ShapeKind& kind, const Vector3d& point_m) {
  return std::visit([&](const auto& shape) { return near(shape, point_m); }, kind);
}

SurfacePoint surface_near(const QuadricFit& fit, const Vector3d& point_m) {
  const Vector3d y_axis = fit.normal.cross(fit.x_axis);
  const Vector3d arm = point_m - fit.origin_m;
  const double x = arm.dot(fit.x_axis), y = arm.dot(y_axis);
  const Quadric& q = fit.quadric;
  SurfacePoint result;
  result.point_m = fit.origin_m + x * fit.x_axis + y * y_axis -
                   (q.A_per_m * x * x + q.B_per_m * y * y + q.C_per_m * x * y) * fit.normal;
  const Vector3d outward = fit.normal + (2 * q.A_per_m * x + q.C_per_m * y) * fit.x_axis +
                           (2 * q.B_per_m * y + q.C_per_m * x) * y_axis;
  result.normal = outward.normalized();
  const Matrix3d second =
      2 * q.A_per_m * fit.x_axis * fit.x_axis.transpose() +
      2 * q.B_per_m * y_axis * y_axis.transpose() +
      q.C_per_m * (fit.x_axis * y_axis.transpose() + y_axis * fit.x_axis.transpose());
  const Matrix3d plane = tangential(result.normal);
  result.curvature_per_m = plane * second * plane / outward.norm();
  return result;
}

Vector3d support_point(const input::ShapeKind& kind, const Vector3d& direction) {
  return std::visit([&](const auto& shape) { return support(shape, direction); }, kind);
}

std::vector<Vector3d> bearing_points(const input::ShapeKind& kind, const Vector3d& direction) {
  return std::visit([&](const auto& shape) { return bearing(shape, direction); }, kind);
}

double bounding_radius_m(const input::ShapeKind& kind) {
  if (std::holds_alternative<input::HalfSpace>(kind))
    return std::numeric_limits<double>::infinity();
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    const double reach = std::max(support_point(kind, Vector3d::Unit(i))[i],
                                  -support_point(kind, -Vector3d::Unit(i))[i]);
    square += reach * reach;
  }
  return std::sqrt(square);
}

Vector3d support_point(const Part& part, const Vector3d& direction) {
  return part.tree ? part.tree->support(direction) : support_point(part.kind(), direction);
}

std::vector<Vector3d> bearing_points(const Part& part, const Vector3d& direction) {
  if (!part.tree) return bearing_points(part.kind(), direction);
  return tipping_points(direction,
                        [&](const Vector3d& beside) { return part.tree->support(beside); });
}

Vector3d Part::local_point(const Vector3d& point_m) const { return pose.inverse() * point_m; }

Vector3d Part::local_direction(const Vector3d& direction) const {
  return pose.linear().transpose() * direction;
}

Matrix3d any_axes(const Vector3d& normal) {
  Matrix3d axes;
  axes.col(2) = normal;
  axes.col(0) = axis_beside(normal).cross(normal).normalized();
  axes.col(1) = normal.cross(axes.col(0));
  return axes;
}

SurfacePoint surface(const Part& part, const std::optional<QuadricFit>& fit,
                     const Vector3d& point_m) {
  const Vector3d place = part.local_point(point_m);
  const SurfacePoint local = fit ? surface_near(*fit, place) : surface_near(part.kind(), place);
  const Matrix3d turn = part.pose.linear();
  return {part.pose * local.point_m, turn * local.normal,
          turn * local.curvature_per_m * turn.transpose(), local.smooth};
}

}  // namespace softfinger::simulation
