#pragma once

#include <memory>
#include <string>

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
  /// The share of the area over which the quadric of a scan's frame was fitted that the contact did
  /// not ask for. Facets may be too large for a smaller region.
  double region_excess = 0;
  bool symmetric_object = false;  ///< about x = 0 and y = 0
  std::string pad_name;           ///< pads of one name are one surface

  explicit operator bool() const { return pad != nullptr || scan != nullptr; }
};

}  // namespace softfinger::fem
