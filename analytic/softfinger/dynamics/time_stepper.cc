#include "softfinger/dynamics/time_stepper.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "softfinger/input/errors.h"

namespace softfinger {

TimeStepper::TimeStepper(Multibody bodies, std::vector<Motor> motors, Options options)
    : bodies_(std::move(bodies)),
      motors_(std::move(motors)),
      options_(std::move(options)),
      motor_limits_(motors_.size(), 0),
      motor_efforts_(motors_.size(), 0.),
      touching_(bodies_.trees().size()),
      factors_(bodies_.trees().size()),
      jacobians_(bodies_.trees().size()),
      masses_(bodies_.trees().size()),
      solver_(0, 0) {
  if (!(options_.time_step_s > 0) || !std::isfinite(options_.time_step_s)) {
    char value[32];
    std::snprintf(value, sizeof value, "%g", options_.time_step_s);
    throw InputError("time stepper", "time_step_s", value, "a finite number > 0");
  }
  for (const Motor& motor : motors_)
    if (motor.joint < 0 || motor.joint >= bodies_.joints() ||
        bodies_.velocity_of_joint(motor.joint) < 0)
      throw InputError("time stepper", "motor", "", "a motor drives a revolute or prismatic joint");
  free_velocity_.setZero(bodies_.velocities());
  new_velocity_ = momentum_ = passive_ = free_velocity_;
  for (std::size_t t = 0; t < masses_.size(); ++t) {
    const Multibody::Tree& tree = bodies_.trees()[t];
    masses_[t].resize(tree.count, tree.count);
  }
}

void TimeStepper::collect(ContactFinder& finder) {
  const double dt = options_.time_step_s;
  contacts_.clear();
  limits_.clear();
  finder.find(bodies_, dt, contacts_);
  contacts_.erase(std::remove_if(contacts_.begin(), contacts_.end(),
                                 [this](const Contact& contact) {
                                   return !bodies_.moves(contact.a) && !bodies_.moves(contact.b);
                                 }),
                  contacts_.end());
  for (int j = 0; j < bodies_.joints(); ++j) {
    const int dof = bodies_.velocity_of_joint(j);
    if (dof < 0) continue;
    const JointDescription& joint = bodies_.joint(j);
    // Two steps ahead: a motor can make a joint faster within one.
    const double reach = std::max(2 * dt * std::abs(bodies_.velocity()[dof]), 1e-2);
    const double position = bodies_.joint_position(j);
    if (position - joint.lower < reach) limits_.push_back({j, 1, position - joint.lower});
    if (joint.upper - position < reach) limits_.push_back({j, -1, joint.upper - position});
  }
  for (auto& list : touching_) list.clear();
  const int nc = int(contacts_.size());
  for (int i = 0; i < nc; ++i) {
    const Contact& contact = contacts_[std::size_t(i)];
    const int tree_a = bodies_.tree_of(contact.a), tree_b = bodies_.tree_of(contact.b);
    if (tree_a >= 0)
      touching_[std::size_t(tree_a)].push_back(
          {i, contact.a, tree_b == tree_a ? contact.b : -1, -1, 1});
    if (tree_b >= 0 && tree_b != tree_a)
      touching_[std::size_t(tree_b)].push_back({i, -1, contact.b, -1, 1});
  }
  for (int i = 0; i < int(limits_.size()); ++i) {
    const int joint = limits_[std::size_t(i)].joint;
    const int tree = bodies_.tree_of(bodies_.joint(joint).child);
    touching_[std::size_t(tree)].push_back({nc + i, -1, -1, joint, limits_[std::size_t(i)].sign});
  }
  for (std::size_t t = 0; t < touching_.size(); ++t) {
    const Multibody::Tree& tree = bodies_.trees()[t];
    Eigen::MatrixXd& rows = jacobians_[t];
    rows.setZero(4 * int(touching_[t].size()), tree.count);
    for (int n = 0; n < int(touching_[t].size()); ++n) {
      const Touching& touching = touching_[t][std::size_t(n)];
      if (touching.joint >= 0) {
        rows(4 * n, bodies_.velocity_of_joint(touching.joint) - tree.first) = touching.sign;
        continue;
      }
      const Contact& contact = contacts_[std::size_t(touching.row)];
      auto block = rows.middleRows<4>(4 * n);
      if (touching.body_a >= 0)
        bodies_.add_contact_jacobian(touching.body_a, contact.point_m, contact.axes, -1, block);
      if (touching.body_b >= 0)
        bodies_.add_contact_jacobian(touching.body_b, contact.point_m, contact.axes, 1, block);
    }
  }
}

/// Mass matrices with the motors' implicit stiffness and damping, and the velocities that the
/// bodies would have without contact.
void TimeStepper::factorise() {
  const double dt = options_.time_step_s;
  for (std::size_t t = 0; t < factors_.size(); ++t) {
    const Multibody::Tree& tree = bodies_.trees()[t];
    Eigen::MatrixXd matrix = masses_[t];
    Eigen::VectorXd right =
        momentum_.segment(tree.first, tree.count) + dt * passive_.segment(tree.first, tree.count);
    for (std::size_t m = 0; m < motors_.size(); ++m) {
      const Motor& motor = motors_[m];
      const int dof = bodies_.velocity_of_joint(motor.joint) - tree.first;
      if (dof < 0 || dof >= tree.count) continue;
      if (motor_limits_[m] != 0) {
        right[dof] += dt * motor_limits_[m] * motor.max_effort;
        continue;
      }
      matrix(dof, dof) += dt * (motor.damping + dt * motor.stiffness);
      right[dof] += dt * (motor.feed_forward +
                          motor.stiffness * (motor.target - bodies_.joint_position(motor.joint)) +
                          motor.damping * motor.target_velocity);
    }
    factors_[t].compute(matrix);
    free_velocity_.segment(tree.first, tree.count) = factors_[t].solve(right);
  }
}

void TimeStepper::assemble() {
  const double dt = options_.time_step_s;
  const int nc = int(contacts_.size()), rows = nc + int(limits_.size());
  problem_.delassus.setZero(4 * rows, 4 * rows);
  problem_.free_velocity.setZero(4 * rows);
  problem_.friction_coefficient.setZero(rows);
  problem_.eccentricity_m.setZero(rows);
  problem_.vertices = options_.friction_vertices;
  const auto approach = [&](double gap_m) {
    return std::max(gap_m / dt, -options_.correction_m_per_s);
  };
  for (int i = 0; i < nc; ++i) {
    const Contact& contact = contacts_[std::size_t(i)];
    problem_.friction_coefficient[i] = contact.friction_coefficient;
    problem_.eccentricity_m[i] = contact.eccentricity_m;
    problem_.free_velocity[4 * i] = approach(contact.gap_m);
  }
  for (int i = nc; i < rows; ++i)
    problem_.free_velocity[4 * i] = limits_[std::size_t(i - nc)].gap / dt;
  for (std::size_t t = 0; t < touching_.size(); ++t) {
    const auto& list = touching_[t];
    if (list.empty()) continue;
    const Multibody::Tree& tree = bodies_.trees()[t];
    const Eigen::VectorXd velocities =
        jacobians_[t] * free_velocity_.segment(tree.first, tree.count);
    const Eigen::MatrixXd half = factors_[t].matrixL().solve(jacobians_[t].transpose());
    for (std::size_t n = 0; n < list.size(); ++n) {
      const int i = 4 * list[n].row;
      problem_.free_velocity.segment<4>(i) += velocities.segment<4>(4 * int(n));
      for (std::size_t k = 0; k <= n; ++k) {
        const int j = 4 * list[k].row;
        const Eigen::Matrix4d block =
            half.middleCols<4>(4 * int(n)).transpose() * half.middleCols<4>(4 * int(k));
        problem_.delassus.block<4, 4>(i, j) += block;
        if (k != n) problem_.delassus.block<4, 4>(j, i) += block.transpose();
      }
    }
  }
}

double TimeStepper::unlimited_effort(int m) const {
  const Motor& motor = motors_[std::size_t(m)];
  const double velocity = new_velocity_[bodies_.velocity_of_joint(motor.joint)];
  const double position = bodies_.joint_position(motor.joint) + options_.time_step_s * velocity;
  return motor.feed_forward + motor.stiffness * (motor.target - position) +
         motor.damping * (motor.target_velocity - velocity);
}

/// Motors that want more than they can at the new velocities, or less than the limit that they are
/// held at, change sides.
int TimeStepper::update_motors(bool one_only) {
  int changes = 0;
  for (std::size_t m = 0; m < motors_.size(); ++m) {
    const double effort = unlimited_effort(int(m)), most = motors_[m].max_effort;
    int& limit = motor_limits_[m];
    constexpr double kRounding = 1e-9;
    int wanted = limit;
    if (limit == 0 && std::abs(effort) > most * (1 + kRounding)) wanted = effort > 0 ? 1 : -1;
    if (limit != 0 && limit * effort < most * (1 - kRounding)) wanted = 0;
    motor_efforts_[m] = limit == 0 ? effort : limit * most;
    if (wanted == limit) continue;
    limit = wanted;
    ++changes;
    if (one_only) break;
  }
  return changes;
}

StepResult TimeStepper::step(ContactFinder& finder) {
  StepResult result;
  for (std::size_t t = 0; t < masses_.size(); ++t) {
    const Multibody::Tree& tree = bodies_.trees()[t];
    bodies_.mass_matrix(tree, masses_[t]);
    bodies_.passive_forces(tree, options_.gravity_m_per_s2,
                           passive_.segment(tree.first, tree.count));
    momentum_.segment(tree.first, tree.count).noalias() =
        masses_[t] * bodies_.velocity().segment(tree.first, tree.count);
  }
  for (const AppliedForce& applied : applied_forces_) {
    const int t = bodies_.tree_of(applied.body);
    if (t < 0) continue;
    const Multibody::Tree& tree = bodies_.trees()[std::size_t(t)];
    const Eigen::Vector3d point = bodies_.pose(applied.body) * applied.point_in_body_m;
    bodies_.add_force(applied.body, point, applied.force_N, applied.torque_Nm,
                      passive_.segment(tree.first, tree.count));
  }
  collect(finder);
  result.contacts = int(contacts_.size());
  const int rows = int(contacts_.size() + limits_.size());
  if (rows > capacity_) {
    capacity_ = std::max(rows, 2 * capacity_);
    solver_ = ContactLcpSolver(capacity_, int(options_.friction_vertices.cols()));
  }
  // Changes of many motors at once usually agree at once; one at a time always does.
  constexpr int kAtOnce = 8;
  const int most_changes = kAtOnce + 20 * int(motors_.size());
  for (int round = 0;; ++round) {
    factorise();
    assemble();
    new_velocity_ = free_velocity_;
    if (rows > 0) {
      const LcpResult solved = solver_.solve(problem_, solution_);
      const int pivots = result.lcp.pivots + solved.pivots;
      result.lcp = solved;
      result.lcp.pivots = pivots;
      if (solved.status != LcpStatus::solved) break;
      for (std::size_t t = 0; t < touching_.size(); ++t) {
        if (touching_[t].empty()) continue;
        const Multibody::Tree& tree = bodies_.trees()[t];
        Eigen::VectorXd impulse(jacobians_[t].rows());
        for (int n = 0; n < int(touching_[t].size()); ++n)
          impulse.segment<4>(4 * n) =
              solution_.impulse.segment<4>(4 * touching_[t][std::size_t(n)].row);
        new_velocity_.segment(tree.first, tree.count) +=
            factors_[t].solve(jacobians_[t].transpose() * impulse);
      }
    } else {
      result.lcp.status = LcpStatus::solved;
    }
    const int changes = update_motors(round >= kAtOnce);
    if (changes == 0) break;
    result.motor_changes += changes;
    if (round == most_changes) {
      result.motors_agree = false;
      break;
    }
  }
  result.time_s = time_s();
  if (!result.done()) return result;
  bodies_.set_velocity(new_velocity_);
  bodies_.integrate(options_.time_step_s);
  ++steps_;
  result.time_s = time_s();
  return result;
}

ContactWrench TimeStepper::wrench(int contact) const {
  const Eigen::Vector4d force = solution_.impulse.segment<4>(4 * contact) / options_.time_step_s;
  return {force[0], force[1], force[2], force[3]};
}

Eigen::Vector4d TimeStepper::contact_velocity(int contact) const {
  Eigen::Vector4d velocity = solution_.velocity.segment<4>(4 * contact);
  velocity[0] -= std::max(contacts_[std::size_t(contact)].gap_m / options_.time_step_s,
                          -options_.correction_m_per_s);
  return velocity;
}

}  // namespace softfinger
