#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "fem/finite/finite_pressing.h"
#include "fem/friction/coulomb_friction.h"
#include "fem/friction/friction_bound.h"
#include "fem/friction/frictional_contact.h"

/// Coulomb friction on a contact pressed at finite strain, in units of h and E.
///
/// The contact is pressed without friction; friction then acts on the surface as it lies deformed:
/// at the nodes' present positions x, in the object's tangent planes, with the limits mu N of the
/// present normal forces. Its motions are small ones superposed on that state (A. E. Green, R. S.
/// Rivlin, R. T. Shield, Proc. R. Soc. A 211, 1952): the tangent stiffness is that of the deformed
/// state, with the stresses' own stiffness and with contact forces that follow the object's
/// normals.
///
/// Left out are effects of second order in the strain that friction makes. They are even in the
/// angle of a twist: a layer that is sheared at constant thickness pushes the object away with the
/// force E/L, E the energy that friction stores, L the shorter of thickness and contact (exact for
/// the torsion of a neo-Hookean cylinder of length L: R. S. Rivlin, Phil. Trans. R. Soc. A 242,
/// 1949). As the load is constant, the pressure elsewhere falls by as much. So E/(P L) is the
/// relative size of what is left out. It is small where mu² p << G.
namespace softfinger::fem::finite {

/// Response of the touching nodes to forces along their tangents, for motions of one parity.
struct TangentialResponse {
  /// @param stiffness  3 n x 3 n, of the superposed motions
  /// @throws ConvergenceError where the pressed state is not stable against such motions
  TangentialResponse(const TouchingNodes& nodes, const Eigen::MatrixXd& stiffness);

  Eigen::MatrixXd displacement;        ///< 2n x 2n, along the tangents, normals held
  Eigen::MatrixXd normal_force, load;  ///< n x 2n: of N, and of its component along the load
};

/// Response of the touching nodes to the object's approach, per unit of approach.
struct ApproachResponse {
  ApproachResponse() = default;
  ApproachResponse(const TouchingNodes& nodes, const Eigen::MatrixXd& stiffness,
                   const TangentialResponse& tangential);

  Eigen::VectorXd displacement;        ///< 2n, along the tangents, against the object
  Eigen::VectorXd normal_force, load;  ///< n
};

/// Full slip with a rigid velocity of the object, v = (v_x, v_y) + omega e_z x x: each node carries
/// the bound of its normal force N, mu N under Coulomb's law, along the part of v in its tangent
/// plane. N is that of the frictionless contact. So a turn has the torque mu sum N r, and a shift
/// the force mu sum N sqrt(1 - n_x²), larger than mu P by what N exceeds its component along the
/// load.
/// @param bound  per node of the layer, here and in what follows
FrictionWrench slide(const FinitePressing& pressing, const FrictionBound& bound,
                     const PlaneMotion& velocity);

/// Full slip with a rigid velocity, as `slide`, with the pressure that friction moves: its forces
/// shear the pressed layer, which the object holds by other normal forces, N + dN, which change
/// friction. They also drag the nodes to where the velocity and its arm are others. The object
/// keeps its load and does not tilt; of the touching nodes none is pulled, and no other one comes
/// to touch. In the linear limit this is `FrictionalContact::slide`.
class SuperposedSlide {
 public:
  /// Factorises the layer's tangent: of a quarter four times, for motions odd or even in x and in
  /// y; of a whole layer once. Not of a half.
  /// @throws ConvergenceError where the pressed state is not stable against such motions
  SuperposedSlide(FinitePressing& pressing, const FrictionBound& bound);
  /// Starts on a whole layer whose tangent is known.
  /// @param stiffness  `pressing.superposed_stiffness`
  SuperposedSlide(const FinitePressing& pressing, const FrictionBound& bound,
                  const Eigen::MatrixXd& stiffness);

  struct Slid {
    FrictionWrench wrench;
    double stored_energy;  ///< of what friction's forces strain the pressed layer by, E h³
  };
  /// @param share  of full friction, 0 to 1
  /// @throws ConvergenceError when pressure and friction do not settle
  Slid slide(const PlaneMotion& velocity, double share = 1) const;

 private:
  SuperposedSlide(const FinitePressing& pressing, const FrictionBound& bound,
                  const std::function<Eigen::MatrixXd(Parity)>& stiffness_of);

  TouchingNodes nodes_;
  int images_;  ///< of what is meshed: 4 of a quarter, 1 of a whole layer
  double spacing_;
  FrictionBound bound_;                        ///< per touching node
  std::vector<TangentialResponse> responses_;  ///< per parity
  ApproachResponse approach_;
};

/// A motion of the object in the contact's plane, from stick to full slip at constant load: a twist
/// about the normal through the contact's centre, of whole layers any other one too.
///
/// When the object moves by m = (x, y, theta), the surface moves by W_0 m even without friction: a
/// twist moves it by nothing under an object of revolution, under any other one because its heights
/// turn. With the nodes held on the object along their normals, tangential forces q and slip s obey
///   C q + s = (V - W_0) m,  V m = (x, y, 0) + theta e_z x x
/// along the tangents, with bounded q (`solve_friction`).
///
/// Friction also changes the pressure. In a symmetric contact a twist changes it by an odd field,
/// which moves no torque to first order: the limits of friction leave it out. Elsewhere they follow
/// it, as in `SuperposedSlide`. How the motion of the object's heights alone changes the pressure
/// is left out.
class SuperposedMotion {
 public:
  /// Factorises the layer's tangent, of a quarter for motions odd in x and y.
  /// @throws ConvergenceError where the pressed state is not stable against a twist
  SuperposedMotion(FinitePressing& pressing, const FrictionBound& bound);
  /// Starts where the tangent is known.
  /// @param stiffness  `pressing.superposed_stiffness`, of a quarter for motions odd in x and y
  SuperposedMotion(const FinitePressing& pressing, const FrictionBound& bound,
                   const Eigen::MatrixXd& stiffness);

  /// Goes back to the contact as it was pressed, without friction.
  void restart();

  /// Torque per angle while every node sticks, E h³.
  double stiffness() const;

  /// Moves the object from where it is, one increment with the slip law at its end.
  /// @pre a quarter only turns
  /// @throws ConvergenceError from `solve_friction`, or when pressure and friction do not settle
  void move_to(const PlaneMotion& motion);
  void turn_to(double angle_rad) { move_to({0, 0, angle_rad}); }

  /// Friction's forces, and their moment about the normal through the centre, E h³. A quarter's
  /// forces cancel.
  FrictionWrench wrench() const;
  double torque() const { return wrench().torque; }
  /// Share of the deformed contact's area that slips, 0 to 1.
  double slip_fraction() const;
  /// Energy of what friction's forces strain the pressed layer by, E h³.
  double stored_energy() const;
  /// Friction's forces times their slip, summed over all increments, E h³.
  double dissipated_energy() const { return dissipated_; }
  /// Sum of the nodal normal forces' change by friction, in magnitude, over the load.
  double pressure_change() const;
  /// Largest tangential displacement of a touching node, in h.
  double largest_displacement() const;

  /// Displacements of the touching nodes along their tangents per angle without friction, w_0.
  Eigen::VectorXd frictionless() const { return frictionless_.col(2); }

 private:
  /// Finds friction and the limits that the pressure has as friction moves it.
  /// @param rub  finds friction from the limits
  void settle(const std::function<void()>& rub);

  TouchingNodes nodes_;
  int copies_;
  FrictionBound bound_;  ///< per touching node
  Eigen::VectorXd area_, limit_, present_normal_force_;
  TangentialResponse response_;
  StickSlipFactor stick_slip_;
  Eigen::MatrixXd compliance_;  ///< 2 n x 2 n along the tangents, normals held; no zero on it
  ApproachResponse approach_;   ///< of a whole contact
  Eigen::MatrixX3d rigid_;      ///< 2 n x 3: V, along the tangents
  Eigen::MatrixX3d frictionless_;
  Eigen::VectorXd force_, slip_;  ///< 2 n: on the layer; of the object against the layer
  Eigen::Vector3d motion_ = Eigen::Vector3d::Zero();
  double dissipated_ = 0;
  double approached_ = 0;  ///< by the object, to keep its load
};

}  // namespace softfinger::fem::finite
