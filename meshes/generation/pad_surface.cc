#include "meshes/generation/pad_surface.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

void require_positive(const char* shape, const char* field, double value) {
  if (!(value > 0)) throw InputError(shape, field, value, "> 0, infinite where straight");
}

void require_positive_finite(const char* shape, const char* field, double value) {
  if (!(value > 0 && std::isfinite(value))) throw InputError(shape, field, value, "> 0 and finite");
}

/// Radius of the normal section at `angle_rad` from the direction of `radius_u` (Euler).
double section_radius(double radius_u, double radius_v, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return 1 / (c * c / radius_u + s * s / radius_v);
}

/// g(p) = (u² / Ru + v² / Rv + z² / C) / 2 + z = 0: an ellipsoid, or a paraboloid for infinite C.
class QuadricPad : public PadSurface {
 public:
  QuadricPad(double radius_u, double radius_v, double semi_axis_z, double angle_rad)
      : PadSurface(angle_rad == 0 ? radius_u : section_radius(radius_u, radius_v, angle_rad),
                   angle_rad == 0 ? radius_v : section_radius(radius_v, radius_u, angle_rad),
                   std::min(radius_u, radius_v), angle_rad == 0, angle_rad == 0),
        curvature_(1 / radius_u, 1 / radius_v, 1 / semi_axis_z),
        cos_(std::cos(angle_rad)),
        sin_(std::sin(angle_rad)) {}

  std::optional<SurfaceHit> meet(const Vector3d& from, const Vector3d& direction) const override {
    const Vector3d p = turn(from, sin_), d = turn(direction, sin_);
    // g(p + t d) = a t² + b t + c; the line leaves where g grows with t: 2 a t + b = root > 0.
    const double a = d.cwiseAbs2().dot(curvature_) / 2,
                 b = d.z() + p.cwiseProduct(d).dot(curvature_),
                 c = p.cwiseAbs2().dot(curvature_) / 2 + p.z();
    const double square = b * b - 4 * a * c;
    if (!(square > 0)) return std::nullopt;
    const double root = std::sqrt(square);
    // Two forms of the same root: the one is taken whose sum does not cancel.
    if (!(b > 0) && a == 0) return std::nullopt;
    const double t = b > 0 ? -2 * c / (b + root) : (root - b) / (2 * a);
    const Vector3d q = p + t * d;
    const Vector3d gradient = q.cwiseProduct(curvature_) + Vector3d::UnitZ();
    return SurfaceHit{from + t * direction, turn(gradient, -sin_).normalized()};
  }

 private:
  Vector3d turn(const Vector3d& v, double sine) const {
    return {cos_ * v.x() + sine * v.y(), cos_ * v.y() - sine * v.x(), v.z()};
  }

  Vector3d curvature_;
  double cos_, sin_;
};

class TaperedPad : public PadSurface {
 public:
  TaperedPad(double radius_x, double radius_y, double taper, double semi_axis_z)
      : PadSurface(radius_x, radius_y, std::min(radius_x, radius_y), taper == 0, true),
        taper_(taper),
        semi_axis_z_(semi_axis_z) {
    const double length = std::sqrt(radius_x * semi_axis_z);
    const double width = std::sqrt(radius_y * semi_axis_z * (1 + std::abs(taper) * length));
    high_ = {length, width, 0};
    low_ = {-length, -width, -2 * semi_axis_z};
  }

  std::optional<SurfaceHit> meet(const Vector3d& from, const Vector3d& direction) const override {
    // Finds the t at which the line leaves the box around the body.
    double enter = -std::numeric_limits<double>::infinity(), t = -enter;
    for (int i = 0; i < 3; ++i) {
      if (direction[i] == 0) {
        if (from[i] < low_[i] || from[i] > high_[i]) return std::nullopt;
        continue;
      }
      const double one = (low_[i] - from[i]) / direction[i],
                   two = (high_[i] - from[i]) / direction[i];
      enter = std::max(enter, std::min(one, two));
      t = std::min(t, std::max(one, two));
    }
    if (enter > t) return std::nullopt;

    // Newton's iteration starts at t, where the line leaves the box: outside of the body. The
    // function is convex along the line. The iteration therefore decreases t monotonically to the
    // outer root, or beyond the minimum if there is no root. It ends when rounding stops the
    // decrease.
    for (int iteration = 0; iteration < 200; ++iteration) {
      const Vector3d p = from + t * direction;
      const double slope = gradient(p).dot(direction);
      if (!(slope > 0)) return std::nullopt;
      const double next = t - value(p) / slope;
      if (!(next < t)) break;
      t = next;
    }
    const Vector3d point = from + t * direction;
    return SurfaceHit{point, gradient(point).normalized()};
  }

 private:
  double width_factor(const Vector3d& p) const { return radius_y() * (1 - taper_ * p.x()); }
  double value(const Vector3d& p) const {
    return (p.x() * p.x() / radius_x() + p.y() * p.y() / width_factor(p) +
            p.z() * p.z() / semi_axis_z_) /
               2 +
           p.z();
  }
  Vector3d gradient(const Vector3d& p) const {
    const double ratio = p.y() / width_factor(p);
    return {p.x() / radius_x() + ratio * ratio * radius_y() * taper_ / 2, ratio,
            p.z() / semi_axis_z_ + 1};
  }

  double taper_, semi_axis_z_;
  Vector3d low_, high_;
};

class TriangulatedPad : public PadSurface {
 public:
  TriangulatedPad(const TriangleSurface& surface, const SurfacePlacement& placement,
                  double radius_x_m, double radius_y_m)
      : PadSurface(radius_x_m, radius_y_m, std::min(radius_x_m, radius_y_m), false, false),
        surface_(surface, placement, PlacedSurface::Body::below) {}

  std::optional<SurfaceHit> meet(const Vector3d& from, const Vector3d& direction) const override {
    return surface_.nearest_exit(from, direction);
  }
  std::vector<Vector3d> facet_points() const override { return surface_.facet_points(); }

 private:
  PlacedSurface surface_;
};

}  // namespace

std::unique_ptr<const PadSurface> paraboloid_pad(double radius_u, double radius_v,
                                                 double angle_rad) {
  require_positive("paraboloid pad", "radius_u", radius_u);
  require_positive("paraboloid pad", "radius_v", radius_v);
  if (!std::isfinite(angle_rad)) throw InputError("paraboloid pad", "angle", angle_rad, "finite");
  return std::make_unique<QuadricPad>(radius_u, radius_v, std::numeric_limits<double>::infinity(),
                                      angle_rad);
}

std::unique_ptr<const PadSurface> ellipsoid_pad(double radius_u, double radius_v,
                                                std::optional<double> semi_axis_z,
                                                double angle_rad) {
  require_positive("ellipsoid pad", "radius_u", radius_u);
  require_positive("ellipsoid pad", "radius_v", radius_v);
  const double c = semi_axis_z.value_or(std::min(radius_u, radius_v));
  require_positive_finite("ellipsoid pad", "semi_axis_z", c);
  if (!std::isfinite(angle_rad)) throw InputError("ellipsoid pad", "angle", angle_rad, "finite");
  return std::make_unique<QuadricPad>(radius_u, radius_v, c, angle_rad);
}

std::unique_ptr<const PadSurface> sphere_pad(double radius) {
  require_positive_finite("sphere pad", "radius", radius);
  return std::make_unique<QuadricPad>(radius, radius, radius, 0);
}

std::unique_ptr<const PadSurface> tapered_pad(double radius_x, double radius_y, double taper,
                                              std::optional<double> semi_axis_z) {
  require_positive_finite("tapered pad", "radius_x", radius_x);
  require_positive_finite("tapered pad", "radius_y", radius_y);
  const double c = semi_axis_z.value_or(std::min(radius_x, radius_y));
  require_positive_finite("tapered pad", "semi_axis_z", c);
  const double limit = 1 / std::sqrt(radius_x * c);
  if (!(std::abs(taper) < limit))
    throw InputError("tapered pad", "taper", taper, "|taper| < " + std::to_string(limit));
  return std::make_unique<TaperedPad>(radius_x, radius_y, taper, c);
}

std::unique_ptr<const PadSurface> triangulated_pad(const TriangleSurface& surface,
                                                   const SurfacePlacement& placement,
                                                   double radius_x_m, double radius_y_m) {
  require_positive("triangulated pad", "radius_x", radius_x_m);
  require_positive("triangulated pad", "radius_y", radius_y_m);
  return std::make_unique<TriangulatedPad>(surface, placement, radius_x_m, radius_y_m);
}

}  // namespace softfinger::meshes
