#pragma once

#include <Eigen/Core>
#include <functional>

#include "softfinger/dynamics/bodies/constrained_mass.h"
#include "softfinger/dynamics/bodies/multibody.h"

namespace softfinger {

/// A step of one tree without contacts, in second order of the time step dt.
///
/// Trees: the midpoint rule for positions q and momenta p = M v. With the velocity u that takes q
/// to q1 = q + dt u, and the positions q_m halfway,
///
///   M(q_m) u = (p + p1)/2,   p1 = p + dt rate(q_m, u),   v1 = M(q1)^-1 p1,
///
/// where rate is that of Multibody::momentum plus the forces. For joints of one axis on the world
/// it is the variational integrator of L((q + q1)/2, (q1 - q)/dt) (Marsden, West, Acta Numerica 10,
/// 2001, section 2.6.2): symplectic, so that energy does not drift. With ball joints and free roots
/// it is symmetric in time and keeps the linear and the angular momentum that nothing changes.
///
/// Closed loops c(q) = 0, G = dc/dq, add G(q)^T y to p so that c(q1) = 0, and G(q1)^T y1 to p1 so
/// that G(q1) v1 = 0, as RATTLE does.
///
/// A single free body moves with the mean of its velocities and turns as Multibody::integrate says:
/// its energy is kept to round-off, under constant gravity too.
class SmoothMotion {
 public:
  /// Adds generalised forces besides gravity, at the current pose.
  using Forces = std::function<void(Eigen::Ref<Eigen::VectorXd> forces)>;
  /// Finds u. Bodies and velocities stay as they are.
  /// @param mass  of the tree at the current pose, with its loops
  /// @param passive_forces  those of Multibody::passive_forces, and `forces` at the current pose
  /// @param forces  may be empty
  /// @return false where the equations are not solved to round-off: turns of about a radian per
  /// step. Such a step is not to be finished.
  bool prepare(Multibody& bodies, const Multibody::Tree& tree, double time_step_s,
               const Eigen::Vector3d& gravity_m_per_s2, const Eigen::VectorXd& passive_forces,
               const Forces& forces, const ConstrainedMass& mass);

  const Eigen::VectorXd& mean_velocity() const { return mean_velocity_; }  ///< u

  /// Does the prepared step. @return false where the equations are not solved to round-off; the
  /// bodies then stay as they were
  bool finish(Multibody& bodies, const Multibody::Tree& tree, double time_step_s,
              const ConstrainedMass& mass);

 private:
  using Residual = std::function<Eigen::VectorXd(const Eigen::VectorXd& mean_velocity)>;
  using Solve = std::function<Eigen::VectorXd(const Eigen::VectorXd& residual)>;
  bool iterate(const Residual& residual, const Eigen::VectorXd& guess, const Solve& solve,
               double rounding = 0);
  bool iterate_by_newton(const Residual& residual, const Eigen::VectorXd& guess);
  void prepare_single(Multibody& bodies, const Multibody::Tree& tree, double time_step_s,
                      const Forces& forces, const ConstrainedMass& mass);

  Eigen::VectorXd mean_velocity_;  ///< u
  Eigen::VectorXd change_;         ///< p1 - p
  Eigen::VectorXd momentum_, rate_;
};

}  // namespace softfinger
