#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "fem/base/outcome.h"
#include "fem/layer/layer_model.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem {

/// The state of the surface's nodes, from which the edge of contacts of any shape is drawn.
struct TouchingState {
  const std::vector<SurfaceNode>& nodes;
  const std::vector<SurfaceFace>& faces;
  const Eigen::Matrix2Xd& position;  ///< of each node where the outline is wanted
  const Eigen::VectorXd& pressure;   ///< of each node, > 0 where it touches
  const Eigen::VectorXd& clearance;  ///< of each node from the object, 0 where it touches
  double modulus = 1;                ///< E / (1 - nu²) of the surface's material
  MirrorPlanes planes;               ///< the nodes are those of one image
  /// Triangles of the nodes, counter-clockwise. They replace the faces where these do not fit
  /// together: on a mesh from outside nodes may hang.
  std::vector<std::array<int, 3>> triangles = {};
};

/// An outline leaves the nodes that a state describes: the contact lies partly beside them.
struct OutgrownPatch {
  ConvergenceError error;  ///< for a caller that has no larger patch
};

/// Outlines of what touches, counter-clockwise, holes clockwise; of the whole contact with the
/// images of its nodes.
///
/// Between a node that touches and an open one, the edge is where both agree: at a distance s
/// inside a smooth edge the pressure is A sqrt(s), outside it the gap is 4 A/(3 E*) s^(3/2)
/// (K. L. Johnson, Contact Mechanics, 1985, chapter 5: the edge of every smooth contact looks like
/// that of a cylinder from nearby). A is found from the distance between the two nodes. Where nodes
/// on the finger's own edge touch, the contact ends at them.
Outcome<std::vector<Eigen::Matrix2Xd>, OutgrownPatch> touching_outlines(const TouchingState& state);

}  // namespace softfinger::fem
