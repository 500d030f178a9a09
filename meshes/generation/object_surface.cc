#include "meshes/generation/object_surface.h"

#include <cmath>
#include <limits>

#include "softfinger/input/errors.h"

namespace softfinger::meshes {
namespace {

using Eigen::Vector3d;

void require_angle(const char* shape, double angle_rad) {
  if (!std::isfinite(angle_rad)) throw InputError(shape, "angle", angle_rad, "finite");
}

void require_finite_radius(const char* shape, double radius) {
  if (!(radius != 0 && std::isfinite(radius)))
    throw InputError(shape, "radius", radius, "finite and not 0; negative where concave");
}

/// R - sqrt(R² - d²) from d², without cancellation near the contact.
std::optional<double> arc_height(double radius, double distance2) {
  const double rest = radius * radius - distance2;
  if (!(rest >= 0)) return std::nullopt;
  return distance2 / (radius + std::copysign(std::sqrt(rest), radius));
}

class QuadricObject : public ObjectSurface {
 public:
  QuadricObject(double radius_u, double radius_v, double angle_rad)
      : curvature_u_(1 / radius_u),
        curvature_v_(1 / radius_v),
        cos_(std::cos(angle_rad)),
        sin_(std::sin(angle_rad)) {}
  std::optional<double> height(double x, double y) const override {
    const double u = cos_ * x + sin_ * y, v = cos_ * y - sin_ * x;
    return (u * u * curvature_u_ + v * v * curvature_v_) / 2;
  }

 private:
  double curvature_u_, curvature_v_, cos_, sin_;
};

class SphereObject : public ObjectSurface {
 public:
  explicit SphereObject(double radius) : radius_(radius) {}
  std::optional<double> height(double x, double y) const override {
    return arc_height(radius_, x * x + y * y);
  }

 private:
  double radius_;
};

class CylinderObject : public ObjectSurface {
 public:
  CylinderObject(double radius, double axis_angle_rad)
      : radius_(radius), cos_(std::cos(axis_angle_rad)), sin_(std::sin(axis_angle_rad)) {}
  std::optional<double> height(double x, double y) const override {
    const double v = cos_ * y - sin_ * x;
    return arc_height(radius_, v * v);
  }

 private:
  double radius_, cos_, sin_;
};

class TriangulatedObject : public ObjectSurface {
 public:
  TriangulatedObject(const TriangleSurface& surface, const SurfacePlacement& placement)
      : surface_(surface, placement, PlacedSurface::Body::above) {}
  std::optional<double> height(double x, double y) const override {
    const auto hit = surface_.nearest_exit({x, y, 0}, -Vector3d::UnitZ());
    if (!hit) return std::nullopt;
    return hit->point.z();
  }
  bool faceted() const override { return true; }

 private:
  PlacedSurface surface_;
};

}  // namespace

std::unique_ptr<const ObjectSurface> plane_object() {
  const double straight = std::numeric_limits<double>::infinity();
  return std::make_unique<QuadricObject>(straight, straight, 0);
}

std::unique_ptr<const ObjectSurface> quadric_object(double radius_u, double radius_v,
                                                    double angle_rad) {
  for (const double radius : {radius_u, radius_v})
    if (radius == 0 || std::isnan(radius))
      throw InputError("quadric object", "radius", radius, "not 0; negative where concave");
  require_angle("quadric object", angle_rad);
  return std::make_unique<QuadricObject>(radius_u, radius_v, angle_rad);
}

std::unique_ptr<const ObjectSurface> sphere_object(double radius) {
  require_finite_radius("sphere object", radius);
  return std::make_unique<SphereObject>(radius);
}

std::unique_ptr<const ObjectSurface> cylinder_object(double radius, double axis_angle_rad) {
  require_finite_radius("cylinder object", radius);
  require_angle("cylinder object", axis_angle_rad);
  return std::make_unique<CylinderObject>(radius, axis_angle_rad);
}

std::unique_ptr<const ObjectSurface> triangulated_object(const TriangleSurface& surface,
                                                         const SurfacePlacement& placement) {
  return std::make_unique<TriangulatedObject>(surface, placement);
}

}  // namespace softfinger::meshes
