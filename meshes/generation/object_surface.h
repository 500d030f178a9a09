#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "meshes/placement/placed_surface.h"

namespace softfinger::meshes {

/// The rigid object's surface in the contact frame: its contact point is the origin, its outward
/// normal there -z, towards the finger below. Any unit of length; the triangulated one in metres.
class ObjectSurface {
 public:
  virtual ~ObjectSurface() = default;

  /// Height of the surface above the contact plane z = 0; null where there is no surface over (x,
  /// y).
  virtual std::optional<double> height(double x, double y) const = 0;

  /// Whether the surface has edges, so that its slope is not continuous.
  virtual bool faceted() const { return false; }
};

/// Height 0.
std::unique_ptr<const ObjectSurface> plane_object();

/// Height u²/(2 radius_u) + v²/(2 radius_v), where u lies at `angle_rad` from x, counter-clockwise
/// seen from above. Radii are negative where the object is concave, infinite where straight.
/// @throws InputError for a radius of zero or values that are no numbers.
std::unique_ptr<const ObjectSurface> quadric_object(double radius_u, double radius_v,
                                                    double angle_rad = 0);

/// Height R - sqrt(R² - x² - y²), over x² + y² <= R²: the half of the sphere that faces the finger.
/// A negative radius is a spherical cup, the mirror image.
/// @throws InputError for a radius that is zero or not finite.
std::unique_ptr<const ObjectSurface> sphere_object(double radius);

/// Height R - sqrt(R² - v²), v the distance from the line through the origin at `axis_angle_rad`
/// from x, counter-clockwise seen from above: the cylinder's axis points that way. A negative
/// radius is a trough.
/// @throws InputError for a radius that is zero or not finite, an angle that is not finite.
std::unique_ptr<const ObjectSurface> cylinder_object(double radius, double axis_angle_rad = 0);

/// A triangulated object in metres. If several facets that face the finger lie over (x, y), the one
/// nearest to the contact plane counts: for a hollow body this is the wall in contact.
/// `placement.x_axis` becomes the finger's x, then the object is turned about z.
/// @throws InputError as PlacedSurface does.
std::unique_ptr<const ObjectSurface> triangulated_object(const TriangleSurface& surface,
                                                         const SurfacePlacement& placement);

}  // namespace softfinger::meshes
