#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "meshes/placement/placed_surface.h"

namespace softfinger::meshes {

/// The outside of a fingertip in the contact frame: the contact point is the origin, the outward
/// normal there +z, the finger lies below. The analytic shapes take any unit of length, the
/// triangulated one is in metres.
class PadSurface {
 public:
  virtual ~PadSurface() = default;

  /// Returns the point where the line from + t direction, with t of either sign, leaves the finger:
  /// the crossing at which direction . normal > 0. A convex body has at most one. On a triangulated
  /// surface the one nearest to `from` counts, so that other parts of the finger and inner walls
  /// are ignored. Null if the line misses the finger. `direction` may have any length except zero.
  virtual std::optional<SurfaceHit> meet(const Eigen::Vector3d& from,
                                         const Eigen::Vector3d& direction) const = 0;

  /// Points in each facet, for checks of the whole surface: a facet may be smaller than the step of
  /// a lattice and be missed by it. Empty for a smooth surface.
  virtual std::vector<Eigen::Vector3d> facet_points() const { return {}; }

  /// Radii of the normal sections along x and y at the pole; > 0, infinite where straight.
  double radius_x() const { return radius_x_; }
  double radius_y() const { return radius_y_; }
  /// Smaller principal radius at the pole. A layer must be thinner than that, or no core is left.
  double smallest_radius() const { return smallest_radius_; }

  /// Whether (x, y, z) -> (-x, y, z), or (x, -y, z), maps the surface onto itself exactly, so that
  /// meet() returns mirrored points to the last bit.
  bool symmetric_x() const { return symmetric_x_; }
  bool symmetric_y() const { return symmetric_y_; }

 protected:
  PadSurface(double radius_x, double radius_y, double smallest_radius, bool symmetric_x,
             bool symmetric_y)
      : radius_x_(radius_x),
        radius_y_(radius_y),
        smallest_radius_(smallest_radius),
        symmetric_x_(symmetric_x),
        symmetric_y_(symmetric_y) {}

 private:
  double radius_x_, radius_y_, smallest_radius_;
  bool symmetric_x_, symmetric_y_;
};

/// u²/(2 radius_u) + v²/(2 radius_v) + z = 0, where u lies at `angle_rad` from x, counter-clockwise
/// seen from above. Symmetric for angle 0.
/// @throws InputError for radii that are not positive; infinite ones are straight directions.
std::unique_ptr<const PadSurface> paraboloid_pad(double radius_u, double radius_v,
                                                 double angle_rad = 0);

/// Ellipsoid u²/A² + v²/B² + (z + C)²/C² = 1 by its radii at the pole: A = sqrt(radius_u C),
/// B = sqrt(radius_v C), C = `semi_axis_z`, by default the smaller radius. An infinite radius
/// makes an elliptic cylinder. Symmetric for angle 0.
/// @throws InputError for radii that are not positive, a C that is not positive and finite.
std::unique_ptr<const PadSurface> ellipsoid_pad(double radius_u, double radius_v,
                                                std::optional<double> semi_axis_z = std::nullopt,
                                                double angle_rad = 0);

/// x² + y² + (z + radius)² = radius².
/// @throws InputError for a radius that is not positive and finite.
std::unique_ptr<const PadSurface> sphere_pad(double radius);

/// Finger along x whose cross-section narrows towards a rounded tip:
///   x²/(2 radius_x) + y²/(2 radius_y (1 - taper x)) + z²/(2 C) + z = 0.
/// The section at x is half an ellipse with the radius radius_y (1 - taper x) sqrt(1 - x²/A²) on
/// top, A = sqrt(radius_x C) the tip's distance: at the pole the radius of the cross-section
/// changes by -taper, relatively, per unit of length. y²/(1 - taper x) is a convex function, so
/// that the body is convex for each |taper| < 1/A; at that limit the tip becomes sharp. Positive
/// taper: the tip is at +x. Symmetric about y = 0 only.
/// @param semi_axis_z  C; by default the smaller radius
/// @throws InputError for radii or C that are not positive and finite, |taper| A >= 1.
std::unique_ptr<const PadSurface> tapered_pad(double radius_x, double radius_y, double taper,
                                              std::optional<double> semi_axis_z = std::nullopt);

/// A triangulated finger, metres. The top of a layer on it follows the facets; its normals are
/// smooth (see PlacedSurface). Not symmetric.
/// @param radius_x_m,radius_y_m  what radius_x() and radius_y() return, > 0 or infinite: those of
///   the reference surface of a map (see FingertipLayer). They need not be exact. Radii that are
///   fitted over the whole region that the map has to cover are better than those of the contact
///   alone.
/// @throws InputError as PlacedSurface does, and for radii that are not positive.
std::unique_ptr<const PadSurface> triangulated_pad(
    const TriangleSurface& surface, const SurfacePlacement& placement,
    double radius_x_m = std::numeric_limits<double>::infinity(),
    double radius_y_m = std::numeric_limits<double>::infinity());

}  // namespace softfinger::meshes
