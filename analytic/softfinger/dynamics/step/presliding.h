#pragma once

#include <Eigen/Core>
#include <array>

#include "softfinger/friction/partial_slip.h"
#include "softfinger/layer/stuck_stiffness.h"
#include "softfinger/time/relaxation.h"

namespace softfinger {

/// Elastic displacement of a soft contact before it slides, and its memory of past loads: elements
/// in parallel, each a spring in series with a slider (Iwan, J. Appl. Mech. 34 (1967)). Their
/// shares of stiffness and limit reproduce the loading curves of a shift and of a twist; under
/// reversed loads they follow Masing's rules without further provision, in any mixture of forces
/// and torque.
///
/// Each element holds a wrench q = (f_x, f_y, tau) within |f|²/F_i² + tau²/T_i² <= 1. A
/// displacement d of body b against body a changes q by -K_i d; a q outside the limit is scaled
/// back to it (radial return), which only takes energy out of the springs. So does a falling load:
/// springs that soften keep their strain, and a part that leaves the contact loses its force. A
/// part that joins the contact joins unstrained.
///
/// The springs of rubber that relaxes are generalised Maxwell solids: of every load that a
/// displacement brings, the share g_i falls with exp(-t/tau_i).
class PreslidingElements {
 public:
  /// The curves are replaced by 16 chords, within 0.6 % of the limit.
  PreslidingElements(const ShiftCurve& shift, const TwistCurve& twist);

  /// All elements have this stiffness before they slide. It is a little less than the stuck one,
  /// which is that of a tangent, not a chord.
  Eigen::Vector3d stiffness() const;
  /// Wrench on body b, axes of the contact: f_x, f_y, tau.
  Eigen::Vector3d wrench() const;
  /// Energy in the springs, J.
  double energy_J() const;

  /// The contact as its load now is.
  /// @param stuck  stiffness of the stuck contact, > 0
  /// @param largest_force_N, largest_torque_Nm  mu P and mu P e_n, >= 0
  void set_limits(const StuckStiffness& stuck, double largest_force_N, double largest_torque_Nm);

  /// The axes turn about the normal by `angle_rad`, as seen from the bodies.
  void turn_axes(double angle_rad);

  /// Rubber that relaxes from now on.
  void set_relaxation(const Relaxation& relaxation);
  /// Time passes in which nothing moves.
  void relax(double time_s);

  /// Body b moves by `displacement` (m, m, rad) along the axes, without sliding.
  void move(const Eigen::Vector3d& displacement);

 private:
  struct Element {
    double force_stiffness = 0, torque_stiffness = 0;  ///< shares of the contact's
    double force_limit = 0, torque_limit = 0;          ///< likewise
    Eigen::Vector3d wrench = Eigen::Vector3d::Zero();
    Eigen::Matrix3Xd fading;  ///< of the wrench: what falls with each term of the relaxation

    void scale(const Eigen::Array3d& factors);
  };
  void return_to_limit(Element& element) const;

  std::array<Element, 16> elements_;
  Relaxation relaxation_;
  Eigen::Vector3d stiffness_ = Eigen::Vector3d::Zero();  ///< stuck: k_x, k_y, k_t
  double largest_force_N_ = 0, largest_torque_Nm_ = 0;
};

}  // namespace softfinger
