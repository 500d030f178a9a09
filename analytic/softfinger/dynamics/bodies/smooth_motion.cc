#include "softfinger/dynamics/bodies/smooth_motion.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace softfinger {
namespace {

/// An iteration's last change, compared with the one before.
class Convergence {
 public:
  enum class State { contracts, done, stalls };

  /// @param rounding  absolute, of the values
  explicit Convergence(double rounding = 0) : rounding_(rounding) {}

  State after(const Eigen::VectorXd& change, const Eigen::VectorXd& value) {
    constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
    const double size = change.lpNorm<Eigen::Infinity>();
    const double scale = value.lpNorm<Eigen::Infinity>();
    const bool slow = !(size < last_ / 2);
    last_ = size;
    if (size <= 4 * kEpsilon * scale) return State::done;
    // Rounding in a badly conditioned mass matrix keeps the changes from becoming smaller still.
    constexpr double kRoundings = 1e4;
    if (slow && size <= std::max(kRoundings * kEpsilon * scale, rounding_)) return State::done;
    return slow ? State::stalls : State::contracts;
  }

 private:
  double rounding_;
  double last_ = std::numeric_limits<double>::infinity();
};

}  // namespace

void SmoothMotion::prepare_single(Multibody& bodies, const Multibody::Tree& tree,
                                  double time_step_s, const Forces& forces,
                                  const ConstrainedMass& mass) {
  const Eigen::VectorXd start = bodies.velocity().segment(tree.first, tree.count);
  if (forces) {
    // They may turn with the body: those of the middle of the step count.
    const Multibody::Placement placement = bodies.placement(tree);
    rate_.setZero(tree.count);
    forces(rate_);
    change_ -= time_step_s * rate_;
    bodies.integrate(tree, time_step_s / 2);
    rate_.setZero();
    forces(rate_);
    change_ += time_step_s * rate_;
    bodies.place(tree, placement);
    bodies.set_velocity(tree, start);
  }
  mean_velocity_ = start + mass.solve(change_) / 2;
}

/// Corrects the mean velocity, from a guess, until the residual is round-off.
bool SmoothMotion::iterate(const Residual& residual, const Eigen::VectorXd& guess,
                           const Solve& solve, double rounding) {
  // With the mass matrix of the start the corrections shrink by about the angle of a step: of a
  // hundredth of a radian there are eight.
  constexpr int kMostRounds = 40;
  mean_velocity_ = guess;
  Convergence convergence(rounding);
  for (int round = 0; round < kMostRounds; ++round) {
    const Eigen::VectorXd change = solve(residual(mean_velocity_));
    mean_velocity_ += change;
    if (!mean_velocity_.allFinite()) return false;
    const Convergence::State state = convergence.after(change, mean_velocity_);
    if (state == Convergence::State::done) return true;
    if (state == Convergence::State::stalls) return false;
  }
  return false;
}

/// Newton's method, for bodies with moments of inertia that differ by so much that a turn within
/// the step changes the mass matrix by more than its least eigenvalue.
bool SmoothMotion::iterate_by_newton(const Residual& residual, const Eigen::VectorXd& guess) {
  const double step = std::sqrt(std::numeric_limits<double>::epsilon()) *
                      std::max(guess.lpNorm<Eigen::Infinity>(), 1e-3);
  const Eigen::VectorXd middle = residual(guess);
  Eigen::MatrixXd slopes(guess.size(), guess.size());
  for (Eigen::Index i = 0; i < guess.size(); ++i)
    slopes.col(i) =
        (middle - residual(guess + step * Eigen::VectorXd::Unit(guess.size(), i))) / step;
  const Eigen::PartialPivLU<Eigen::MatrixXd> factors(slopes);
  return iterate(residual, guess,
                 [&](const Eigen::VectorXd& r) { return factors.solve(r).eval(); });
}

bool SmoothMotion::prepare(Multibody& bodies, const Multibody::Tree& tree, double time_step_s,
                           const Eigen::Vector3d& gravity_m_per_s2,
                           const Eigen::VectorXd& passive_forces, const Forces& forces,
                           const ConstrainedMass& mass) {
  change_ = time_step_s * passive_forces;
  if (tree.single) {
    prepare_single(bodies, tree, time_step_s, forces, mass);
    return mean_velocity_.allFinite();
  }
  momentum_.resize(tree.count);
  rate_.resize(tree.count);
  const auto evaluate = [&] {
    bodies.momentum(tree, gravity_m_per_s2, momentum_, rate_);
    if (forces) forces(rate_);
  };
  evaluate();
  const Eigen::VectorXd start = bodies.velocity().segment(tree.first, tree.count);
  const Eigen::VectorXd start_momentum = momentum_;
  const Multibody::Placement placement = bodies.placement(tree);
  const Eigen::VectorXd guess = start + mass.solve(change_) / 2;
  const auto residual = [&](const Eigen::VectorXd& mean) -> Eigen::VectorXd {
    bodies.place(tree, placement);
    bodies.set_velocity(tree, mean);
    bodies.integrate(tree, time_step_s / 2);
    evaluate();
    return start_momentum + time_step_s / 2 * rate_ - momentum_;
  };
  bool converged = false;
  if (tree.loop_rows == 0) {
    converged = iterate(residual, guess, [&](const Eigen::VectorXd& r) { return mass.solve(r); }) ||
                iterate_by_newton(residual, guess);
    change_ = time_step_s * rate_;
  } else {
    Eigen::MatrixXd jacobian;
    Eigen::VectorXd opening;
    const auto correct = [&](const Eigen::VectorXd& r) -> Eigen::VectorXd {
      bodies.place(tree, placement);
      bodies.set_velocity(tree, mean_velocity_);
      bodies.integrate(tree, time_step_s);
      bodies.loops(tree, jacobian, opening);
      return mass.solve(r) - mass.velocity_with(opening / time_step_s);
    };
    // Positions of about a radian or a metre are known to a few roundings.
    constexpr double kPositionRounding = 64 * std::numeric_limits<double>::epsilon();
    converged = iterate(residual, guess, correct, kPositionRounding / time_step_s);
    // The loops' impulses are part of the momentum in the middle.
    change_ = momentum_ + time_step_s / 2 * rate_ - start_momentum;
  }
  bodies.place(tree, placement);
  bodies.set_velocity(tree, start);
  return converged;
}

namespace {

/// Ends a step with these velocities, unless they are not finite.
bool take(Multibody& bodies, const Multibody::Tree& tree, const Multibody::Placement& start,
          const Eigen::VectorXd& start_velocity, const Eigen::VectorXd& velocity) {
  const bool is_good = velocity.allFinite();
  if (!is_good) bodies.place(tree, start);
  bodies.set_velocity(tree, is_good ? velocity : start_velocity);
  return is_good;
}

}  // namespace

bool SmoothMotion::finish(Multibody& bodies, const Multibody::Tree& tree, double time_step_s,
                          const ConstrainedMass& mass) {
  const Eigen::VectorXd start = bodies.velocity().segment(tree.first, tree.count);
  if (tree.single) {
    bodies.set_velocity(tree, start + mass.solve(change_));
    bodies.integrate(tree, time_step_s, change_);
    return true;
  }
  const Multibody::Placement placement = bodies.placement(tree);
  bodies.momentum(tree, Eigen::Vector3d::Zero(), momentum_, rate_);
  const Eigen::VectorXd end_momentum = momentum_ + change_;
  bodies.set_velocity(tree, mean_velocity_);
  bodies.integrate(tree, time_step_s);
  if (tree.loop_rows > 0) {
    Eigen::MatrixXd matrix(tree.count, tree.count), jacobian;
    Eigen::VectorXd opening;
    bodies.mass_matrix(tree, matrix);
    bodies.loops(tree, jacobian, opening);
    ConstrainedMass at_end;
    at_end.compute(matrix, jacobian);
    return take(bodies, tree, placement, start, at_end.solve(end_momentum));
  }
  // M(q1) v1 = p1: with the factors of M(q) where that suffices.
  Eigen::VectorXd velocity = 2 * mean_velocity_ - start;
  Convergence convergence;
  Convergence::State state = Convergence::State::contracts;
  while (state == Convergence::State::contracts) {
    bodies.set_velocity(tree, velocity);
    bodies.momentum(tree, Eigen::Vector3d::Zero(), momentum_, rate_);
    const Eigen::VectorXd change = mass.solve(end_momentum - momentum_);
    velocity += change;
    state = convergence.after(change, velocity);
  }
  if (state == Convergence::State::stalls) {
    Eigen::MatrixXd matrix(tree.count, tree.count);
    bodies.mass_matrix(tree, matrix);
    ConstrainedMass at_end;
    at_end.compute(matrix);
    velocity = at_end.solve(end_momentum);
  }
  return take(bodies, tree, placement, start, velocity);
}

}  // namespace softfinger
