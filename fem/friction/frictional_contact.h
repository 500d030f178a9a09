#pragma once

#include <Eigen/Core>

#include "fem/contact/normal_contact.h"
#include "fem/friction/coulomb_friction.h"
#include "fem/friction/friction_bound.h"
#include "fem/friction/surface_compliance.h"

namespace softfinger::fem {

/// Motion of the indenter in the plane of the contact: a shift and a turn about its normal.
struct PlaneMotion {
  double x = 0, y = 0, turn_rad = 0;
};

/// Friction's resultants on the layer about the centre of the contact.
struct FrictionWrench {
  double force_x = 0, force_y = 0, torque = 0;
};

/// A contact that was pressed with friction, per point or per node: the state that later motions
/// start from.
struct RubbedState {
  Eigen::VectorXd normal;      ///< n: force
  Eigen::VectorXd tangential;  ///< 2n: force on the layer
  Eigen::VectorXd slip;        ///< 2n: of the object against the layer, since they touched
  double approach = 0;
};

/// The state of nodes on the points of a contact that is composed of their images.
RubbedState on_points(const RubbedState& of_nodes, const SurfaceCompliance& surface);

/// A contact with friction, in the units of the model (h, E h²).
///
/// It is pressed without friction, and from then on friction resists at constant load; or friction
/// acts from the first touch. Every displacement of the surface is measured from there. Normal and
/// tangential problem are solved in turn until neither changes: tangential forces lift and lower
/// the surface, which moves pressure, which moves the limits.
class FrictionalContact {
 public:
  /// @param gap    per point of the surface
  /// @param bound  of friction's force on each point
  /// @throws ConvergenceError from the normal contact
  FrictionalContact(const SurfaceCompliance& surface, const Eigen::VectorXd& gap, double load,
                    FrictionBound bound);
  /// Goes on from a contact that was pressed with friction.
  FrictionalContact(const SurfaceCompliance& surface, const Eigen::VectorXd& gap, double load,
                    FrictionBound bound, RubbedState start);

  /// Raises the load to `load` in one increment with the slip law at its end; the object neither
  /// shifts nor turns. A point that comes to touch begins to stick where it was an increment ago,
  /// which is an error of first order in the increment.
  /// @pre the object has not moved
  void press_to(double load);
  /// Brings the present load into equilibrium with another slip since first touch.
  /// @pre the object has not moved
  void settle_slip(const Eigen::VectorXd& slip);
  RubbedState state() const { return {normal_.force, tangential_, slip_, normal_.approach}; }

  /// Moves the indenter from where it is to `motion`, in one increment with the slip law at its
  /// end.
  /// @throws ConvergenceError when the two problems do not settle
  void move_to(const PlaneMotion& motion);

  /// Slides with the given velocity until every point slips. Replaces the present state.
  void slide(const PlaneMotion& velocity);

  FrictionWrench wrench() const;
  /// Share of the contact's area that slips, 0 to 1.
  double slip_fraction() const;
  double approach() const { return normal_.approach; }
  /// int tau r dA, tau the shear law's stress under the present pressure.
  double torque_of_pressure() const;

  const SurfaceCompliance& surface() const { return surface_; }
  const Eigen::VectorXd& normal_force() const { return normal_.force; }
  const Eigen::VectorXd& tangential_force() const { return tangential_; }
  const Eigen::VectorXd& slip() const { return slip_; }
  bool slips(Eigen::Index point) const;

 private:
  /// Repeats `solve_tangential(precision)`, to that residual, and the normal contact until the
  /// pressure settles.
  template <class TangentialSolver>
  void settle(const char* stage, const TangentialSolver& solve_tangential);

  const SurfaceCompliance& surface_;
  const Eigen::VectorXd gap_;
  double load_;
  const FrictionBound bound_;
  NormalContact normal_;
  TouchingFactor touching_;
  StickSlipFactor stick_slip_;
  Eigen::VectorXd pressed_;      ///< normal forces when friction set in: none at first touch
  Eigen::VectorXd tangential_;   ///< per point x, y: on the layer
  Eigen::VectorXd last_change_;  ///< of the tangential forces, in the last increment
  Eigen::VectorXd slip_;         ///< per point x, y: of the indenter against the layer
  Eigen::VectorXd limit_;  ///< per point: what friction could hold when it was last solved for
};

}  // namespace softfinger::fem
