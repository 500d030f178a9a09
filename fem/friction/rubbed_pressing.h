#pragma once

#include "fem/friction/friction_study.h"
#include "fem/friction/frictional_contact.h"

/// Pressing with friction from the first touch, on one mesh, in linear elasticity.
namespace softfinger::fem {

/// The load or the approach that a contact is pressed to.
struct PressingGoal {
  double load = 0;      ///< of the whole contact
  double approach = 0;  ///< > 0: in place of the load
};

/// A contact that was pressed with friction, per node of the model.
struct RubbedPressing {
  RubbedState state;
  Eigen::VectorXd lift;    ///< of each node towards the object by friction
  double load = 0;         ///< of the whole contact
  double stick_share = 0;  ///< of the area that touches, in the end
};

/// Presses with the law of `contact`, in load steps with memory: a node that touches keeps its
/// place on the object as long as it sticks. Such steps are of first order. The slip of two numbers
/// of steps, one twice the other, is extrapolated, and the contact is brought into equilibrium with
/// it: second order.
/// @param contact  pressed without friction; its model's mirror planes are the state's
/// @throws EdgeLeftMargin, ConvergenceError
RubbedPressing press_rubbing(const PressedContact& contact, const QuarterCompliances& quarters,
                             const PressingGoal& goal);

}  // namespace softfinger::fem
