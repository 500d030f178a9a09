#include "comparisons/simulation/elliptic_contact.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace softfinger::simulation {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Plane = Eigen::Matrix<double, 3, 2>;  ///< two tangents

/// A surface over the plane across the normal, to second order about one of its points.
struct Paraboloid {
  Vector2d place, slope;
  Matrix2d curvature;
};

Paraboloid over_plane(const SurfacePoint& at, const Plane& plane, const Vector3d& normal,
                      const Vector3d& origin) {
  return {plane.transpose() * (at.point_m - origin),
          -plane.transpose() * at.normal / at.normal.dot(normal),
          plane.transpose() * at.curvature_per_m * plane};
}

/// Place where two paraboloids, `a` below and `b` above, are nearest to each other along the
/// normal.
Vector2d nearest_place(const Paraboloid& a, const Paraboloid& b) {
  const Matrix2d relative = a.curvature + b.curvature;
  const Vector2d pull = b.curvature * b.place + a.curvature * a.place - b.slope + a.slope;
  return relative.inverse() * pull;
}

/// The point of the tangent plane at `at` that lies over a place.
Vector3d tangent_point(const SurfacePoint& at, const Paraboloid& near, const Vector2d& place,
                       const Plane& plane, const Vector3d& normal) {
  const Vector2d step = place - near.place;
  return at.point_m + plane * step + near.slope.dot(step) * normal;
}

/// Whether a capsule that touches with one cap lies along the other surface: its other end is
/// within reach too, by the tilt and the other's curvature.
bool lies(const Part& part, const Vector3d& on_part, const SurfacePoint& other, double reach_m) {
  const auto* capsule = std::get_if<input::Capsule>(&part.kind());
  if (!capsule) return false;
  const double past_m = std::abs(part.local_point(on_part).z()) - capsule->length_m / 2;
  const Vector3d axis = part.pose.linear().col(2);
  const double rise_m = capsule->length_m * past_m / capsule->radius_m +
                        std::pow(capsule->length_m, 2) / 2 * axis.dot(other.curvature_per_m * axis);
  return rise_m < reach_m && past_m > -1e-9 * capsule->length_m;
}

/// The surfaces where they have come to, and the common normal there.
struct Meeting {
  SurfacePoint a, b;
  Vector3d normal;
  Plane plane;
  Matrix2d curvature;  ///< relative, over the plane
  Matrix2d curvature_of_a;
};

std::optional<Meeting> meet(const ShapePair& pair, const Fits& fits, const Nearest& nearest) {
  // The curvature is taken for zero below this part of the surfaces' largest one: a line.
  constexpr double kFlat = 1e-6;
  constexpr int kMostRounds = 12;  // convergence is quadratic: four or five are usual
  Meeting meeting;
  meeting.normal = nearest.normal;
  Vector3d on_a = nearest.on_a, on_b = nearest.on_b;
  const double far_m = 0.5 * pair.smaller_m();
  for (int round = 0; round < kMostRounds; ++round) {
    const SurfacePoint at_a = surface(pair.a, fits[0], on_a);
    const SurfacePoint at_b = surface(pair.b, fits[1], on_b);
    if (!at_a.smooth || !at_b.smooth) return std::nullopt;
    const Vector3d turned = (at_a.normal - at_b.normal).normalized();
    if (!(turned.dot(nearest.normal) > 0.5)) return std::nullopt;
    if (round > 0) meeting.normal = turned;
    meeting.plane = any_axes(meeting.normal).leftCols<2>();
    const Paraboloid a = over_plane(at_a, meeting.plane, meeting.normal, nearest.on_a);
    const Paraboloid b = over_plane(at_b, meeting.plane, meeting.normal, nearest.on_a);
    meeting.curvature = a.curvature + b.curvature;
    meeting.curvature_of_a = a.curvature;
    const double least =
        Eigen::SelfAdjointEigenSolver<Matrix2d>().computeDirect(meeting.curvature).eigenvalues()[0];
    const double largest = std::max(at_a.curvature_per_m.norm(), at_b.curvature_per_m.norm());
    if (!(least > kFlat * largest)) return std::nullopt;
    const Vector2d place = nearest_place(a, b);
    const Vector3d next_a = tangent_point(at_a, a, place, meeting.plane, meeting.normal);
    const Vector3d next_b = tangent_point(at_b, b, place, meeting.plane, meeting.normal);
    const double moved_m = (next_a - on_a).norm() + (next_b - on_b).norm();
    on_a = next_a;
    on_b = next_b;
    if ((on_a - nearest.on_a).norm() > far_m) return std::nullopt;
    if (round > 0 && moved_m < 1e-13 * far_m) break;  // round-off
  }
  meeting.a = surface(pair.a, fits[0], on_a);
  meeting.b = surface(pair.b, fits[1], on_b);
  if (!meeting.a.smooth || !meeting.b.smooth) return std::nullopt;
  return meeting;
}

/// Whether the quadrics tell how the surfaces bend: over the fitted region their relative curvature
/// has to lower the surface by several times what the meshes differ from the quadrics. A region
/// with a flat part, a rim or a fillet has no quadric.
bool fits_hold(const Fits& fits, double least_curvature_per_m) {
  constexpr double kTimes = 8;
  for (const auto& fit : fits) {
    if (!fit) continue;
    const double sagitta_m = least_curvature_per_m * std::pow(fit->region_radius_m, 2) / 2;
    const double rounding_m = 1e-6 * fit->region_radius_m;
    if (!(sagitta_m > kTimes * (fit->residual_rms_m + rounding_m))) return false;
  }
  return true;
}

}  // namespace

std::optional<TouchingPoint> find_elliptic_contact(const ShapePair& pair, const Fits& fits,
                                                   const Nearest& nearest) {
  if ((pair.a.is_mesh() && !fits[0]) || (pair.b.is_mesh() && !fits[1])) return std::nullopt;
  for (const auto& fit : fits)
    if (fit && fit->surface_kind != SurfaceKind::smooth) return std::nullopt;
  const std::optional<Meeting> meeting = meet(pair, fits, nearest);
  if (!meeting) return std::nullopt;
  const SurfacePoint &at_a = meeting->a, &at_b = meeting->b;
  if (lies(pair.a, at_a.point_m, at_b, pair.reach_m) ||
      lies(pair.b, at_b.point_m, at_a, pair.reach_m))
    return std::nullopt;
  Eigen::SelfAdjointEigenSolver<Matrix2d> principal;
  principal.computeDirect(meeting->curvature);
  if (!fits_hold(fits, principal.eigenvalues()[0])) return std::nullopt;
  TouchingPoint point;
  point.a = pair.a.body;
  point.b = pair.b.body;
  point.id = pair.first_id + slot::kElliptic;
  point.point_m = (at_a.point_m + at_b.point_m) / 2;
  // The quadric of a mesh gives its curvature, and the mesh itself its distance.
  const bool has_mesh = fits[0] || fits[1];
  point.gap_m = has_mesh ? nearest.gap_m : meeting->normal.dot(at_b.point_m - at_a.point_m);
  point.elliptic = true;
  point.radii = {1 / principal.eigenvalues()[0], 1 / principal.eigenvalues()[1], 0};
  const Matrix2d& to_axes = principal.eigenvectors();
  // The second axis follows from the first and the normal.
  const double side = to_axes.determinant();
  const Matrix2d of_a = to_axes.transpose() * meeting->curvature_of_a * to_axes;
  point.curvature_of_a = {of_a(0, 0), of_a(1, 1), side * of_a(0, 1)};
  point.a_is_sphere = std::holds_alternative<input::Sphere>(pair.a.kind());
  point.b_is_sphere = std::holds_alternative<input::Sphere>(pair.b.kind());
  point.axes.col(2) = meeting->normal;
  point.axes.col(0) = (meeting->plane * principal.eigenvectors().col(0)).normalized();
  point.axes.col(1) = meeting->normal.cross(point.axes.col(0));
  return point;
}

}  // namespace softfinger::simulation
