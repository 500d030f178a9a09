#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "meshes/scans/cloth.h"
#include "meshes/scans/eroded_core.h"
#include "meshes/scans/smooth_surface.h"

namespace softfinger::meshes {

/// A soft layer of uniform thickness under any smooth surface, around the finger as far as wanted.
/// It is the image of a flat block, -1 <= z <= 0:
///
///   position(x, y, z) = T(x, y) + z (T(x, y) - C(x, y))
///
/// T is a cloth on the surface, interpolated by bicubic Hermite patches; the core side C lies at
/// the depth h below it, or on a core's own surface, where the line to the depth h meets it. Where
/// the curvature exceeds 1/h, normals would cross inside the layer: there T - C is smoothed, or C
/// is the finger eroded by the thickness (eroded_core.h), with the ridge that it has there. Lengths
/// are in the surface's unit. Safe to share between threads.
class ScannedLayer {
 public:
  /// @param centre  of the contact
  /// @param x_axis  that the block's x follows there
  /// @param radius  of the surface to cover around the centre, along the surface
  /// @param core    with outward normals, inside the surface; null: offset by the thickness. The
  ///                layer ends where it has none, or none within six thicknesses
  /// @param erosion to find the core by; none: along normals, smoothed where they cross
  ScannedLayer(const SmoothSurface& surface, const SmoothSurface::Point& centre,
               const Eigen::Vector3d& x_axis, double thickness, double radius,
               const SmoothSurface* core = nullptr,
               const std::optional<Erosion>& erosion = std::nullopt);

  /// @pre (x, y) lies where the layer covers
  Eigen::Vector3d position(double x, double y, double z) const;
  Eigen::Vector3d normal(double x, double y) const;
  /// Surface area per area of the block.
  double area_ratio(double x, double y) const;

  /// Returns why a rectangle of the block is not covered by the layer; none where it is. A layer
  /// that ends at a sharp edge can be asked for its shape as if it went on.
  ClothEnd end_in(double low_x, double high_x, double low_y, double high_y) const;

  /// Largest distance from the centre that the layer covers in a direction of the block, and the
  /// reason for its end.
  struct Reach {
    double distance;
    ClothEnd end;
  };
  Reach reach(double angle_rad) const;

  /// Depths of the core below the surface within a distance from the centre, over the thickness:
  /// first and 99th percentile.
  struct Depths {
    double low = 1, high = 1;
  };
  Depths depths(double distance) const;

  double thickness() const { return thickness_; }

 private:
  /// Values and derivatives by the lattice's steps at a node.
  struct Jet {
    Eigen::Vector3d value, by_x, by_y, by_xy;
  };
  struct Patch {
    Eigen::Vector3d value, by_x, by_y;
  };
  using Field = std::vector<Eigen::Vector3d>;

  std::size_t index(int i, int j) const {
    return static_cast<std::size_t>((i + cloth_.half()) +
                                    (2 * cloth_.half() + 1) * (j + cloth_.half()));
  }
  std::vector<Jet> jets_of(const Field& values) const;
  Patch patch(const std::vector<Jet>& jets, double x, double y) const;
  Field smoothed(const Field& field, double length) const;
  Field core_by(double smoothing) const;
  Field core_by(const Erosion& erosion) const;
  ErodedCore eroded() const;
  Field on_core(const SmoothSurface& core, Field field) const;
  double depth_below(const Eigen::Vector3d& point, double x, double y, Eigen::Vector3d* foot) const;
  double find_cells();
  bool is_beyond_edge(int i, int j) const;
  void keep_connected();

  double thickness_, deepest_;
  Cloth cloth_;
  std::vector<Jet> top_, core_;
  std::vector<ClothEnd> cells_;  ///< of the cell whose lowest node is (i, j)
};

}  // namespace softfinger::meshes
