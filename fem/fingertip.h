#pragma once

#include <memory>
#include <string>

#include "fem/layer_model.h"
#include "softfinger/input/triangle_surface.h"

namespace softfinger::meshes {
class PadSurface;
class ObjectSurface;
}  // namespace softfinger::meshes

namespace softfinger::fem {

/// A finger with its layer on its own curved core against an object with a surface of its own, in
/// place of a flat layer with the relative radii. Both in the contact's frame, in metres: x along
/// the longer relative radius. The finger is either a pad or a scan.
struct Fingertip {
  std::shared_ptr<const meshes::PadSurface> pad;
  std::shared_ptr<const TriangleSurface> scan;
  std::shared_ptr<const TriangleSurface> core;  ///< of a scan; null: offset by the thickness
  std::shared_ptr<const meshes::ObjectSurface> object;
  bool symmetric_object = false;  ///< about x = 0 and y = 0
  std::string pad_name;           ///< pads of one name are one surface

  explicit operator bool() const { return pad != nullptr || scan != nullptr; }
};

/// How the ways from a scan's surface to its core are found, where the finger bends more sharply
/// than one over the thickness and its normals cross in the layer.
enum class CoreWays {
  smoothed,         ///< as little as is necessary
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
  /// Where object and finger touch first, in the contact's frame: the shape's origin. Elsewhere
  /// than the aimed point where the scan's surface is inclined there.
  Eigen::Vector3d first_touch = Eigen::Vector3d::Zero();
};

/// What a scan's triangles may stand for. How far the answers differ tells what facets and noise
/// may change.
enum class Reading {
  best,           ///< smoothed over half the thickness, or over an edge where these are longer
  smooth,         ///< over half as much again
  doubted,        ///< with vertices moved by what facets leave open
  doubted_again,  ///< in another pattern
};

/// @throws InputError where the layer is too thick for the pad's curvature, or the scan has no
/// surface at the contact
FingertipShape shape_fingertip(const Fingertip& fingertip, double thickness_m,
                               Reading reading = Reading::best, CoreWays ways = CoreWays::smoothed);

}  // namespace softfinger::fem
