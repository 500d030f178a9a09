#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "fem/layer/layer_shape.h"
#include "fem/problem/fingertip.h"

namespace softfinger::fem {

/// Rule for the lines ("ways") from a scan's surface to its core where the finger's curvature
/// exceeds one over the thickness, so that its normals cross in the layer.
enum class CoreWays {
  smoothed,         ///< no more than necessary
  eroded,           ///< to the finger eroded by the thickness, which has a ridge there
  eroded_nearer,    ///< towards places half as much deeper
  eroded_smoother,  ///< and with directions smoothed over twice the length
};

/// The layer of the fingertip in units of its thickness, and how far its map is regular.
struct FingertipShape {
  std::shared_ptr<const LayerShape> shape;
  double reach_x = 0, reach_y = 0;  ///< in h; infinite where the shape itself says what it covers
  bool is_scan = false;
  CoreWays ways = CoreWays::smoothed;
  /// The normal of a scan's surface at the aimed point, before any turn. The frame's z is the
  /// normal of a quadric over a region, which is another one where the finger is no quadric.
  Eigen::Vector3d own_normal = Eigen::Vector3d::UnitZ();
  /// The place where object and finger touch first, in the contact's frame: the shape's origin. It
  /// is not the aimed point where the scan's surface is inclined there. Where they touch along a
  /// line it is the aimed point.
  Eigen::Vector3d first_touch = Eigen::Vector3d::Zero();
  /// The origin of coordinates in space, seen from the first touch across the load: motions turn
  /// the object about it, and torques are about it.
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();

  /// This shape in coordinates with another origin.
  /// @param place  the new origin in the present coordinates
  FingertipShape seen_from(const Eigen::Vector2d& place) const;
};

/// A scan's triangles as they are taken: by default unperturbed, else a perturbed scan. How far the
/// answers of perturbed scans differ estimates the error by facets and noise.
struct Reading {
  /// Factor on the length over which facets are smoothed: half the thickness, or an edge where
  /// these are longer.
  double smoothing = 1;
  double doubt = 0;          ///< part of what facets leave open by which vertices are moved
  unsigned int pattern = 0;  ///< of the signs with which they are
  /// The finger is turned about the aimed point until its surface's normal there is this one. None:
  /// it is held as it is given.
  std::optional<Eigen::Vector3d> normal;
};

/// Facets are looked at as far as contact and surroundings may reach, in thicknesses.
constexpr double farthest_facet = 20;

/// Reduces a scan and its core to what is seen from outside: the inner walls of an exported shell
/// go. Call it once: it takes seconds for shells of 500,000 facets.
Fingertip seen_of(Fingertip fingertip, double thickness_m);

/// @throws InputError where the layer is too thick for the pad's curvature, or the scan has no
/// surface at the contact
FingertipShape shape_fingertip(const Fingertip& fingertip, double thickness_m,
                               const Reading& reading = {}, CoreWays ways = CoreWays::smoothed);

}  // namespace softfinger::fem
