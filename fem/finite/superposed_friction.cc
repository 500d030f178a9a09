#include "fem/finite/superposed_friction.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "fem/coulomb_friction.h"
#include "fem/finite/deformed_contact.h"
#include "softfinger/input/errors.h"

namespace softfinger::fem::finite {

using Eigen::Index;

namespace {

/// e_z x x.
Eigen::Vector3d turned(const Eigen::Vector3d& position) { return {-position.y(), position.x(), 0}; }

}  // namespace

FrictionWrench slide(const FinitePressing& pressing, double friction_coefficient,
                     const PlaneMotion& velocity) {
  const TouchingNodes nodes = pressing.touching_nodes();
  FrictionWrench result;
  for (int image = 0; image < pressing.copies(); ++image) {
    const Eigen::Vector3d mirror(image & 1 ? -1 : 1, image & 2 ? -1 : 1, 1);
    for (Index i = 0; i < nodes.size(); ++i) {
      const Eigen::Vector3d position = mirror.cwiseProduct(nodes.position.col(i));
      const Eigen::Vector3d normal =
          mirror.cwiseProduct(nodes.axes[static_cast<std::size_t>(i)].col(2));
      Eigen::Vector3d along =
          Eigen::Vector3d(velocity.x, velocity.y, 0) + velocity.turn_rad * turned(position);
      along -= normal.dot(along) * normal;
      const double speed = along.norm();
      // At the centre of rotation nothing slides: no force is the mean of what its neighbours have.
      if (!(speed > 0)) continue;
      const Eigen::Vector3d force = friction_coefficient * nodes.normal_force[i] / speed * along;
      result.force_x += force.x();
      result.force_y += force.y();
      result.torque += turned(position).dot(force);
    }
  }
  return result;
}

SuperposedTwist::SuperposedTwist(FinitePressing& pressing, double friction_coefficient)
    : nodes_(pressing.touching_nodes()),
      copies_(pressing.copies()),
      area_(nodal_area(pressing)(nodes_.node)),
      limit_(friction_coefficient * nodes_.normal_force),
      stiffness_(pressing.superposed_stiffness({/*odd_x=*/true, /*odd_y=*/true})) {
  const Index count = nodes_.size();
  turn_.resize(2 * count);
  normal_turn_.resize(count);
  // Along the tangents: forces that hold the nodes while the object turns under them, because it
  // turns the forces' directions, and because its heights change.
  Eigen::VectorXd holding(2 * count);
  std::vector<Index> tangential, normal, free;
  for (Index i = 0; i < count; ++i) {
    const auto node = static_cast<std::size_t>(i);
    const Eigen::Matrix3d& axes = nodes_.axes[node];
    const ObjectHeight& object = nodes_.object[node];
    const Eigen::Vector3d turn = turned(nodes_.position.col(i));
    turn_.segment<2>(2 * i) = axes.leftCols<2>().transpose() * turn;
    normal_turn_[i] = axes.col(2).dot(turn);
    Eigen::Vector3d follower = Eigen::Vector3d::Zero();
    follower.head<2>() = nodes_.force[i] * (object.curvature * turn.head<2>() -
                                            Eigen::Vector2d(-object.slope.y(), object.slope.x()));
    holding.segment<2>(2 * i) = axes.leftCols<2>().transpose() * follower;
    for (const Index c : {0, 1}) {
      tangential.push_back(3 * i + c);
      if (stiffness_(3 * i + c, 3 * i + c) != 0) free.push_back(2 * i + c);
    }
    normal.push_back(3 * i + 2);
  }
  holding += stiffness_(tangential, normal) * normal_turn_;

  const Eigen::MatrixXd held = stiffness_(tangential, tangential);
  const Eigen::LLT<Eigen::MatrixXd> factor(held(free, free));
  if (factor.info() != Eigen::Success)
    throw ConvergenceError("twist of the deformed layer", 0, 0,
                           "the pressed state is not stable against a twist: less load");
  const auto free_count = static_cast<Index>(free.size());
  compliance_ = Eigen::MatrixXd::Zero(2 * count, 2 * count);
  const Eigen::MatrixXd of_free = factor.solve(Eigen::MatrixXd::Identity(free_count, free_count));
  compliance_(free, free) = of_free;
  frictionless_ = -compliance_ * holding;
  // What a mirror plane fixes is never pushed; any compliance keeps the node's two components apart
  // and lets the other one move.
  const double mean = compliance_.trace() / static_cast<double>(free_count);
  for (Index row = 0; row < 2 * count; ++row)
    if (compliance_(row, row) == 0) compliance_(row, row) = mean;
  force_ = slip_ = Eigen::VectorXd::Zero(2 * count);
}

double SuperposedTwist::stiffness() const {
  const Eigen::VectorXd stuck = compliance_.llt().solve(turn_ - frictionless_);
  return copies_ * turn_.dot(stuck);
}

void SuperposedTwist::turn_to(double angle_rad) {
  const Eigen::VectorXd target = angle_rad * (turn_ - frictionless_) - slip_;
  solve_friction(compliance_, limit_, target, force_);
  const Eigen::VectorXd slipped = target - compliance_ * force_;
  slip_ += slipped;
  dissipated_ += copies_ * force_.dot(slipped);
  angle_ = angle_rad;
}

double SuperposedTwist::torque() const { return copies_ * turn_.dot(force_); }

double SuperposedTwist::slip_fraction() const {
  double slipping = 0, touching = 0;
  for (Index i = 0; i < nodes_.size(); ++i) {
    // The centre of a twist does not move, and carries nothing.
    if (nodes_.position.col(i).head<2>().norm() < 1e-9) continue;
    touching += area_[i];
    if (force_.segment<2>(2 * i).norm() >= limit_[i] * (1 - 1e-9)) slipping += area_[i];
  }
  return slipping / touching;
}

double SuperposedTwist::stored_energy() const {
  return 0.5 * copies_ * force_.dot(compliance_ * force_);
}

Eigen::VectorXd SuperposedTwist::displacement() const {
  return compliance_ * force_ + angle_ * frictionless_;
}

double SuperposedTwist::pressure_change() const {
  const Eigen::VectorXd along = displacement();
  Eigen::VectorXd all(3 * nodes_.size());
  for (Index i = 0; i < nodes_.size(); ++i)
    all.segment<3>(3 * i) << along.segment<2>(2 * i), angle_ * normal_turn_[i];
  const Eigen::VectorXd reaction = stiffness_ * all;
  double change = 0;
  for (Index i = 0; i < nodes_.size(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    const Eigen::Matrix3d& axes = nodes_.axes[node];
    const Eigen::Vector2d moved = (axes * all.segment<3>(3 * i)).head<2>();
    // The reaction leaves out what the tangent counts as the contact force's own.
    change += std::abs(reaction[3 * i + 2] +
                       nodes_.force[i] *
                           axes.col(2).head<2>().dot(nodes_.object[node].curvature * moved));
  }
  return change / nodes_.force.sum();
}

double SuperposedTwist::largest_displacement() const {
  const Eigen::VectorXd along = displacement();
  double largest = 0;
  for (Index i = 0; i < nodes_.size(); ++i)
    largest = std::max(largest, along.segment<2>(2 * i).norm());
  return largest;
}

}  // namespace softfinger::fem::finite
