#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>
#include <optional>

#include "fem/problem/mirror_planes.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

/// The curved ("bent") layer of a finger: the image of a flat block in the contact's frame. Lengths
/// in h.
class LayerShape {
 public:
  virtual ~LayerShape() = default;
  /// A copy for another thread: what the copy covers changes nothing here. Null where threads may
  /// share this one.
  virtual std::shared_ptr<const LayerShape> copy() const { return nullptr; }
  /// Position in space of the block's point (x, y, z), -1 <= z <= 0; z = 0 is the surface, z = -1
  /// the rigid core.
  virtual Eigen::Vector3d position(double x, double y, double z) const = 0;
  /// Outward unit normal of the surface.
  virtual Eigen::Vector3d normal(double x, double y) const = 0;
  /// Surface area per area of the block.
  virtual double area_ratio(double x, double y) const = 0;
  /// The mirror planes of the shape alone: x where position(-x, y) is the mirror image of
  /// position(x, y), and y likewise.
  virtual MirrorPlanes planes() const = 0;

  /// Makes sure that the shape is known up to this distance from the contact, where the surface
  /// goes that far.
  virtual void cover(double /*radius*/) const {}
  /// The part of the layer that there is under a rectangle of the block.
  enum class Cover {
    whole,
    cut,  ///< the shape cannot go on, though the finger does
    rim,  ///< the finger ends
    /// The finger ends in it, at a sharp edge or a little beside it; the shape goes on.
    edge,
  };
  virtual Cover covers(double /*low_x*/, double /*high_x*/, double /*low_y*/,
                       double /*high_y*/) const {
    return Cover::whole;
  }
  /// Whether the finger has sharp edges nearby: beyond them it ends.
  virtual bool has_edges() const { return false; }
  /// The distance by which a point of the surface lies beyond a sharp edge, negative on this side
  /// of it. The shape goes on a little beyond, so that cells can be fitted to the edge.
  virtual double beyond_edge(double /*x*/, double /*y*/) const {
    return -std::numeric_limits<double>::infinity();
  }
};

inline bool ends_finger(LayerShape::Cover cover) {
  return cover == LayerShape::Cover::rim || cover == LayerShape::Cover::edge;
}

/// A contact lies or reaches where a scan's layer would fold, though the finger goes on. On another
/// core the layer may not fold.
struct FoldedLayer {
  InputError refusal;  ///< for a caller that has no other core
  /// The share of the load or approach with which the contact does not reach the fold; none where
  /// it is not known.
  std::optional<double> fits = std::nullopt;
};

}  // namespace softfinger::fem
