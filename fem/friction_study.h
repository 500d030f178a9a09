#pragma once

#include <functional>
#include <vector>

#include "fem/frictional_contact.h"
#include "fem/layer_model.h"

namespace softfinger::fem {

/// Contact pressed on one mesh, in the units of the model: what friction starts from.
struct PressedContact {
  const LayerModel& model;
  const NormalContact& quarter;  ///< the frictionless contact of the quarter model
  Eigen::VectorXd gap;           ///< per node of the quarter model
  double a = 0, b = 0;           ///< semi-axes
  double load = 0;               ///< of the whole contact
  double friction_coefficient = 0;
};

/// One increment of a twist or of a path to full slip.
struct FrictionState {
  PlaneMotion motion;
  FrictionWrench wrench;  ///< about the centre of the contact
  double slip_fraction = 0;
};

using FrictionProgress = std::function<void(const std::string&)>;

/// The points of the quarter that take part in friction: the contact and a cell around it.
std::vector<int> friction_nodes(const PressedContact& contact);

/// Gap of each point of a surface made from the quarter's nodes.
Eigen::VectorXd gap_of(const SurfaceCompliance& surface, const PressedContact& contact);

/// Torque per angle of a contact that sticks everywhere: the slope of torque over angle at its start.
/// The contact area is that of the frictionless load.
double stuck_torsional_stiffness(const PressedContact& contact);

/// Turns the indenter through the angles, one increment each, from a contact pressed without
/// friction. Every state is given to `on_state` as it comes.
std::vector<FrictionState> twist(const PressedContact& contact, const SurfaceCompliance& surface,
                                 const std::vector<PlaneMotion>& motions,
                                 const std::function<void(const FrictionalContact&,
                                                          const FrictionState&)>& on_state);

/// Points of the limit surface: full slip with each velocity.
/// @param surface  without invariance
std::vector<FrictionState> limit_surface(const PressedContact& contact,
                                         const SurfaceCompliance& surface,
                                         const std::vector<PlaneMotion>& velocities);

/// Velocities spread over all directions, the turn scaled by 1 / arm: a Fibonacci spiral.
std::vector<PlaneMotion> spread_velocities(int count, double arm);

}  // namespace softfinger::fem
