#pragma once

#include <Eigen/Core>
#include <memory>

#include "fem/finite/finite_pressing.h"
#include "fem/friction/friction_bound.h"

/// Pressing with friction from the first touch, on one mesh, at finite strain.
namespace softfinger::fem::finite {

/// Memory of a contact that was pressed with friction, in a form that another mesh
/// of the same contact can use: friction drags the surface away from where it would touch without.
struct Drag {
  Eigen::Matrix2Xd node;   ///< in the block: the nodes that touch
  Eigen::Matrix3Xd moved;  ///< each one's place on the object, from the place without friction
  double spacing = 0;      ///< of the nodes
  MirrorPlanes planes;     ///< of their mesh: images have the mirrored drag
  double stick_share = 0;  ///< of the area that touches, in the end
};

/// Places on the object to which this drag takes the touching nodes of a contact that was pressed
/// without friction, on any mesh of it; the other nodes stay. The drag is a smooth field, which the
/// nodes of a coarser mesh tell well.
Eigen::Matrix3Xd dragged_places(const FinitePressing& frictionless, const Drag& drag);

/// The drag that leads to these places, at the nodes that touch when the layer is pressed with
/// friction.
Drag drag_to(const Eigen::Matrix3Xd& places, const FinitePressing& with_friction,
             const FinitePressing& frictionless);

/// A contact that was pressed with friction.
struct RubbedPressing {
  std::shared_ptr<FinitePressing> pressing;  ///< in that state
  Drag drag;
};

/// Presses in load steps with memory: a node that touches keeps its place on the object as long as
/// it sticks. Such steps are of first order. The places of two numbers of steps, one twice the
/// other, are extrapolated, and the contact is brought into equilibrium with them: second order.
/// @param frictionless  the same contact without friction, on a mesh of the same nodes
/// @param layer         unloaded
/// @throws ConvergenceError
RubbedPressing press_rubbing(const FinitePressing& frictionless,
                             const std::shared_ptr<FiniteLayer>& layer, const FrictionBound& bound,
                             const Drive& drive);

/// Solves the contact as if its way had been that of another mesh: no load steps.
/// @param frictionless, layer  as above
/// @throws ConvergenceError
RubbedPressing press_dragged(const FinitePressing& frictionless,
                             const std::shared_ptr<FiniteLayer>& layer, const FrictionBound& bound,
                             const Drive& drive, const Drag& drag);

}  // namespace softfinger::fem::finite
