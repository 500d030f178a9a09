#pragma once

#include <memory>

#include "fem/finite/finite_pressing.h"
#include "fem/friction/friction_bound.h"

/// Pressing with friction from the first touch, on one mesh, at finite strain.
namespace softfinger::fem::finite {

/// A contact that was pressed with friction.
struct RubbedPressing {
  std::shared_ptr<FinitePressing> pressing;  ///< in that state
  double stick_share = 0;                    ///< of the area that touches, in the end
};

/// Presses in load steps with memory: a node that touches keeps its place on the object as long as
/// it sticks. Such steps are of first order. The places of two numbers of steps, one twice the
/// other, are extrapolated, and the contact is brought into equilibrium with them: second order.
/// @param layer  unloaded
/// @throws ConvergenceError
RubbedPressing press_rubbing(const std::shared_ptr<FiniteLayer>& layer,
                             const std::shared_ptr<const RigidObject>& object,
                             const FrictionBound& bound, const Drive& drive);

}  // namespace softfinger::fem::finite
