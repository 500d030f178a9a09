#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>

namespace softfinger::fem {

/// Height of a rigid object's surface above the contact plane with its derivatives by x and y.
struct ObjectHeight {
  double height = 0;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  Eigen::Matrix2d curvature = Eigen::Matrix2d::Zero();
};

/// A rigid object above the finger, touching the origin; its material lies above its surface z =
/// height(x, y). Lengths in h.
class RigidObject {
 public:
  virtual ~RigidObject() = default;
  /// None where the object has no surface over (x, y): nothing can touch it there.
  virtual std::optional<ObjectHeight> over(double x, double y) const = 0;
};

/// x²/(2 major) + y²/(2 minor); infinite radii make it a plane.
std::unique_ptr<const RigidObject> quadric(double major, double minor);

/// The sphere's half that faces the finger.
std::unique_ptr<const RigidObject> sphere(double radius);

/// Any surface by its height, with central differences over `step` for the derivatives: exact for
/// quadrics, relative error (step/radius)² for other smooth surfaces.
std::unique_ptr<const RigidObject> sampled(
    std::function<std::optional<double>(double x, double y)> height, double step);

/// A faceted surface by its height on a lattice of this spacing, the control points of a cubic
/// spline: twice differentiable, its edges rounded over two spacings. Planes stay as they are,
/// quadrics move along the load by spacing² times the mean curvature over 3, everywhere the same.
/// On the facets themselves Newton's method would find no slope where nodes touch at an edge.
std::unique_ptr<const RigidObject> smoothed(
    std::function<std::optional<double>(double x, double y)> height, double spacing);

}  // namespace softfinger::fem
