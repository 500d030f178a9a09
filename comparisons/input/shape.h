#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <variant>

#include "softfinger/input/triangle_surface.h"

/// The shapes of bodies in a scene, for collision detection and for pictures.
namespace softfinger::input {

struct Sphere {
  double radius_m = 0;
};
struct Ellipsoid {
  Eigen::Vector3d semi_axes_m = Eigen::Vector3d::Zero();
};
/// A cylinder along its z axis, centred.
struct Cylinder {
  double radius_m = 0, length_m = 0;
};
/// A capsule along its z axis, centred; `length_m` without the caps.
struct Capsule {
  double radius_m = 0, length_m = 0;
};
struct Box {
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
};
/// All that lies below the plane z = 0.
struct HalfSpace {};
/// A triangulated surface.
struct Mesh {
  std::shared_ptr<const TriangleSurface> surface;
};

using ShapeKind = std::variant<Sphere, Ellipsoid, Cylinder, Capsule, Box, HalfSpace, Mesh>;

struct Shape {
  ShapeKind kind;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< in the body's frame
};

}  // namespace softfinger::input
