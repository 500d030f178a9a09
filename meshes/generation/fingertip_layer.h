#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "meshes/generation/pad_surface.h"

namespace softfinger::meshes {

/// A soft layer of uniform thickness h over a fingertip's rigid core. It is the image of a flat
/// block under a map: x and y run along the surface, z from -1 on the core to 0 on the fingertip's
/// outside.
///
///   position(x, y, z) = T(x, y) + z h n(x, y)
///
/// A simple reference surface gives each point of the finger its (x, y): T(x, y) is where the
/// normal of the reference surface in its point (x, y) leaves the finger (PadSurface::meet), and n
/// is the outward unit normal of the finger there. The core is the finger's surface, offset inward
/// by h.
///
/// The reference surface is the torus with the pad's radii r_x and r_y at the pole. For r_x >= r_y
/// it is a tube along x of radius r_y, whose centre line turns by x/r_x about an axis parallel to y
/// at depth r_x; the point turns by y/r_y about the centre line:
///   ((r_x - d) sin a, r_y sin b, -r_x + (r_x - d) cos a), d = r_y (1 - cos b), a = x/r_x,
///   b = y/r_y.
/// For r_x < r_y, x and y are exchanged. An infinite radius means a straight direction. On an
/// analytic pad the map is smooth, and x and y are arc lengths at the pole: dT/dx = (1, 0, 0),
/// dT/dy = (0, 1, 0). On a triangulated pad it is continuous with kinks at the facets' edges, and
/// at the pole dT/dx and dT/dy also have the slope of the facet there.
///
/// The image of (-x, y, z) is the mirror image of that of (x, y, z), to the last bit, where
/// symmetric_x() says so; likewise y. Lengths are in the pad's unit. Safe to share between threads.
class FingertipLayer {
 public:
  /// Cost: finding the reach intersects 1e4 to 1e6 lines with the pad, 0.01 to 0.5 s; thin layers
  /// take longest.
  /// @param thickness  h
  /// @throws InputError unless 0 < h < 0.9 times the pad's smallest radius, or where the surface is
  /// not met or the map not regular at the pole itself.
  FingertipLayer(std::shared_ptr<const PadSurface> pad, double thickness);

  /// @param z  in [-1, 0], in units of the thickness
  /// @throws InputError with (x, y) if the normal of the reference surface does not meet the finger
  /// there.
  Eigen::Vector3d position(double x, double y, double z) const;
  /// Outward unit normal n at (x, y), along which the thickness is measured.
  Eigen::Vector3d normal(double x, double y) const;

  /// Columns: derivatives of the position with respect to x, y and z h; at the top of the pole they
  /// are the identity. By central differences over 1e-5 of the smallest radius, accurate to 1e-9 of
  /// the largest entry.
  Eigen::Matrix3d gradient(double x, double y, double z) const;

  /// Half sides of the largest rectangle |x| <= reach_x, |y| <= reach_y that a layer can cover. It
  /// is tested on a lattice, and in every facet of a triangulated pad, that
  /// - the normals of the reference surface meet the finger and the map is regular (see verify),
  /// - the reference surface turns by at most 75 degrees,
  /// - the finger's surface is inclined to it by at most 60 degrees,
  /// - neighbours do not lie on different parts of the finger.
  ///
  /// The rectangle ends at least one lattice cell before the first place where a test fails; it is
  /// 0 when the first cells fail. The cells are 1/48 of the shorter limit, or half a thickness if
  /// that is less (but at least 1/200 of the limit). The rectangle grows as a square until one side
  /// is limited, and then in the other direction. Its upper limits are 200 h, 30 times the smaller
  /// radius and the size of a triangulated finger.
  double reach_x() const { return reach_x_; }
  double reach_y() const { return reach_y_; }

  /// Smallest volume ratio, det gradient(x, y, z), over |x| <= half_x, |y| <= half_y, -1 <= z <= 0:
  /// at the nodes of a lattice of 2 steps by 2 steps cells in x and y, and in each facet of a
  /// triangulated pad, exactly in z.
  /// @throws InputError naming the place where the surface is not met, where the map is inverted
  /// (the ratio is below a twentieth of the reference layer's smallest, (1 - h/r_x)(1 - h/r_y)), or
  /// where it fails in one of the other ways that limit the reach.
  double verify(double half_x, double half_y, int steps) const;

  double thickness() const { return thickness_; }
  bool symmetric_x() const { return pad_->symmetric_x(); }
  bool symmetric_y() const { return pad_->symmetric_y(); }

 private:
  struct Sample;
  struct Finding;
  SurfaceHit reference(double x, double y) const;
  Eigen::Vector2d coordinates(const Eigen::Vector3d& point) const;
  std::optional<SurfaceHit> meet(double x, double y) const;
  SurfaceHit require(double x, double y) const;
  std::optional<Sample> sample(double x, double y) const;
  Finding examine(double x, double y, double step_x, double step_y) const;
  void find_facets();
  void find_reach();

  std::shared_ptr<const PadSurface> pad_;
  double thickness_, difference_ = 0, smallest_ratio_ = 0;
  double reach_x_ = 0, reach_y_ = 0;
  std::vector<Eigen::Vector2d>
      facets_;  ///< (x, y) of points in the facets, where the map is tested too
};

}  // namespace softfinger::meshes
