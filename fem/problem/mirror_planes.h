#pragma once

#include <Eigen/Core>

namespace softfinger::fem {

/// An image of what is meshed: itself, or mirrored at x = 0, at y = 0, or at both.
struct Image {
  bool mirror_x = false, mirror_y = false;

  /// Signs of x, y and z against those of what is meshed.
  Eigen::Vector3d signs() const { return {mirror_x ? -1.0 : 1.0, mirror_y ? -1.0 : 1.0, 1}; }
};

/// Planes x = 0 and y = 0 about which layer, object and load are their own mirror images. On one
/// side of each it is enough to mesh the layer: with both planes a quarter of it, with one of them
/// a half, without any the whole.
struct MirrorPlanes {
  bool x = false, y = false;

  bool any() const { return x || y; }
  bool both() const { return x && y; }

  /// Images that the whole layer consists of: 4, 2 or 1.
  int images() const { return (x ? 2 : 1) * (y ? 2 : 1); }
  /// The first is what is meshed.
  Image image(int number) const {
    return {x && (number & 1) != 0, y && (number & (x ? 2 : 1)) != 0};
  }
  /// The mean of a point's images.
  Eigen::Vector2d middle(const Eigen::Vector2d& point) const {
    return {x ? 0 : point.x(), y ? 0 : point.y()};
  }

  bool operator==(const MirrorPlanes& other) const { return x == other.x && y == other.y; }
};

constexpr MirrorPlanes no_plane{}, both_planes{true, true};

}  // namespace softfinger::fem
