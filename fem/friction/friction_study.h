#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "fem/friction/frictional_contact.h"
#include "fem/friction/touched_region.h"
#include "fem/layer/layer_model.h"
#include "fem/problem/result.h"
#include "softfinger/input/errors.h"

/// Friction on a contact that was pressed on one mesh, in linear elasticity. All in the units of
/// the model.
namespace softfinger::fem {

/// The pressed contact that friction starts from.
struct PressedContact {
  const LayerModel& model;
  Eigen::VectorXd gap;    ///< per node of the model
  Eigen::VectorXd force;  ///< frictionless, along the load, per node of the model
  double a = 0, b = 0;    ///< semi-axes along the surface
  double load = 0;        ///< of the whole contact
  ShearLaw law;           ///< its strength in units of E
  /// Per node of the model, see `strength_share`; empty for Coulomb's law.
  Eigen::VectorXd strength_share{};
  double edge = 1;  ///< relative radius of the frictionless contact's edge, where it is no ellipse
  /// Distance by which the edge may move while friction moves the pressure, in cells of the refined
  /// patch.
  double margin = 1;
  /// Region that may touch, known from a coarser mesh; empty: wherever the margin lets it.
  TouchedRegion region{};
  /// The contact where friction acted from the first touch, per node; none: it was pressed without.
  std::optional<RubbedState> rubbed = std::nullopt;
};

/// Whether the contact may come to a node, as far as its region tells.
/// @param mesh  the node's
bool is_in_region(const TouchedRegion& region, const SurfaceNode& node,
                  const LayerDiscretisation& mesh);

/// Number of mirror images of the model that make the whole contact, by which sums over its nodes
/// are multiplied.
inline int copies(const PressedContact& contact) { return contact.model.planes().images(); }

/// The largest force of friction on each node of the model without friction's own effect.
Eigen::VectorXd largest_friction(const PressedContact& contact);

/// Outermost part of the margin, in cells. A node that touches there shows that the margin is too
/// small.
constexpr double spare_margin = 0.3;

/// Friction moved the contact's edge beyond the margin.
class EdgeLeftMargin : public ConvergenceError {
 public:
  using ConvergenceError::ConvergenceError;
};

/// The end of one increment.
struct FrictionState {
  PlaneMotion motion;
  FrictionWrench wrench;  ///< about the centre of the contact
  double slip_fraction = 0;
  double edge = 0;  ///< how far out it touches, relative to the semi-axes
  std::optional<ShearedContact> sheared = std::nullopt;
  std::vector<int> touching{};  ///< nodes of the model, of small motions
};

using OnState = std::function<void(const FrictionalContact&, const FrictionState&)>;

/// Compliances that an earlier contact on the mesh needed; null before the first.
using KeptCompliances = std::shared_ptr<const QuarterCompliances>;

/// Compliances of the contact's nodes and a margin around it.
/// @param kept  serves where it has them, is replaced where it has not; null: nothing is kept
QuarterCompliances friction_compliances(const PressedContact& contact, Invariance fewest,
                                        KeptCompliances* kept = nullptr);

/// Torque per angle while every point sticks, the slope at the start of a twist, of the contact as
/// it was pressed.
double stuck_torsional_stiffness(const PressedContact& contact, const QuarterCompliances& quarters);

/// Sets the nodes that touch in a state, and the relative radius of the outermost one.
/// @throws EdgeLeftMargin
void find_touching(const PressedContact& contact, const SurfaceCompliance& surface,
                   const FrictionalContact& state, FrictionState& result);

/// Moves the indenter through the motions, one increment each, after the contact was pressed.
/// Every state is given to `on_state` as it comes.
/// @throws EdgeLeftMargin, ConvergenceError
std::vector<FrictionState> move_through(const PressedContact& contact,
                                        const SurfaceCompliance& surface,
                                        const std::vector<PlaneMotion>& motions,
                                        const OnState& on_state);

/// Full slip with each velocity: points of the limit surface.
/// @throws EdgeLeftMargin, ConvergenceError
std::vector<FrictionState> slide_through(const PressedContact& contact,
                                         const SurfaceCompliance& surface,
                                         const std::vector<PlaneMotion>& velocities);

/// Velocities in all directions, turns scaled by 1 / arm: a Fibonacci spiral.
std::vector<PlaneMotion> spread_velocities(int count, double arm);

}  // namespace softfinger::fem
