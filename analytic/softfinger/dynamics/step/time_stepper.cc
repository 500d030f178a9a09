#include "softfinger/dynamics/step/time_stepper.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unordered_map>

#include "softfinger/dynamics/contacts/contact_residual.h"
#include "softfinger/input/errors.h"
#include "softfinger/math/wide.h"

namespace softfinger {
namespace {

/// block += factor A_i A_j^T of the four rows from i and from j on.
[[gnu::always_inline]] inline void add_product(double factor, const Eigen::MatrixXd& a,
                                               Eigen::Index i, Eigen::Index j,
                                               Eigen::Matrix4d& block) {
  Four sums[4];
  for (int column = 0; column < 4; ++column) load(block.data() + 4 * column, sums[column]);
  const double *left = a.data() + i, *right = a.data() + j;
  for (Eigen::Index k = 0; k < a.cols(); ++k, left += a.rows(), right += a.rows()) {
    Four part;
    load(left, part);
    for (int column = 0; column < 4; ++column) sums[column] += factor * right[column] * part;
  }
  for (int column = 0; column < 4; ++column) store(sums[column], block.data() + 4 * column);
}

}  // namespace

TimeStepper::TimeStepper(Multibody bodies, std::vector<Motor> motors, Options options)
    : bodies_(std::move(bodies)),
      motors_(std::move(motors)),
      options_(std::move(options)),
      motor_limits_(motors_.size(), 0),
      motor_efforts_(motors_.size(), 0.),
      touching_(bodies_.trees().size()),
      factors_(bodies_.trees().size()),
      loop_jacobians_(bodies_.trees().size()),
      loop_openings_(bodies_.trees().size()),
      jacobians_(bodies_.trees().size()),
      halves_(bodies_.trees().size()),
      masses_(bodies_.trees().size()),
      driven_masses_(bodies_.trees().size()),
      smooth_motions_(bodies_.trees().size()),
      is_smooth_(bodies_.trees().size()) {
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
  new_velocity_ = momentum_ = passive_ = change_ = free_velocity_;
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
    // Limits farther away join them only when a step would break them: then it is solved again.
    const double reach = std::max(2 * dt * std::abs(bodies_.velocity()[dof]), 1e-2);
    const double position = bodies_.joint_position(j);
    if (joint.dry_friction > 0) limits_.push_back({j, kDryFriction, 0});
    if (position - joint.lower < reach) limits_.push_back({j, 1, position - joint.lower});
    if (joint.upper - position < reach) limits_.push_back({j, -1, joint.upper - position});
  }
  describe_rows();
  if (drop_locked_contacts()) describe_rows();
}

/// Leaves out contacts that no velocity can open or close: bodies that only slide along each other
/// on their joints. What they are pressed by is not determined, and nothing would change by it.
bool TimeStepper::drop_locked_contacts() {
  constexpr double kRounding = 1e-12;
  opening_.assign(contacts_.size(), {0, 0});
  for (std::size_t t = 0; t < touching_.size(); ++t)
    for (std::size_t n = 0; n < touching_[t].size(); ++n) {
      const Touching& touching = touching_[t][n];
      if (touching.joint >= 0) continue;
      const auto block = jacobians_[t].middleRows<3>(4 * Eigen::Index(n));
      const auto row = std::size_t(touching.row);
      auto& [along, any] = opening_[row];
      along = std::max(along, block.row(0).lpNorm<Eigen::Infinity>());
      any = std::max(any, block.lpNorm<Eigen::Infinity>());
    }
  const std::size_t before = contacts_.size();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < before; ++i)
    if (opening_[i].first > kRounding * opening_[i].second ||
        contacts_[i].role == Contact::FaceRole::friction)
      contacts_[kept++] = contacts_[i];
  contacts_.resize(kept);
  return kept < before;
}

/// Limits that the new velocities would break although they were thought far away: a stiff motor
/// or a blow can take a joint across its whole range within a step.
bool TimeStepper::add_broken_limits() {
  bool added = false;
  for (int j = 0; j < bodies_.joints(); ++j) {
    const int dof = bodies_.velocity_of_joint(j);
    if (dof < 0) continue;
    const JointDescription& joint = bodies_.joint(j);
    const double position = bodies_.joint_position(j);
    const double next = position + options_.time_step_s * new_velocity_[dof];
    for (const double sign : {1., -1.}) {
      if (!(sign > 0 ? next < joint.lower : next > joint.upper)) continue;
      const bool known = std::any_of(limits_.begin(), limits_.end(), [&](const Limit& limit) {
        return limit.joint == j && limit.sign == sign;
      });
      if (known) continue;
      limits_.push_back({j, sign, sign > 0 ? position - joint.lower : joint.upper - position});
      added = true;
    }
  }
  return added;
}

/// Finds the rows that act on each tree, and their Jacobians.
void TimeStepper::describe_rows() {
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
        const int dof = bodies_.velocity_of_joint(touching.joint) - tree.first;
        if (touching.sign == kDryFriction)
          rows(4 * n + 1, dof) = 1;
        else
          rows(4 * n, dof) = touching.sign;
        continue;
      }
      const Contact& contact = contacts_[std::size_t(touching.row)];
      auto block = rows.middleRows<4>(4 * n);
      if (touching.body_a >= 0)
        bodies_.add_contact_jacobian(touching.body_a, contact.point_m, contact.axes, -1, block);
      if (touching.body_b >= 0)
        bodies_.add_contact_jacobian(touching.body_b, contact.point_m, contact.axes, 1, block);
      if (contact.role == Contact::FaceRole::friction) block.row(0).setZero();
    }
  }
}

/// Mass matrices with the motors' implicit stiffness and damping, and the velocities that the
/// bodies would have without contact.
void TimeStepper::factorise() {
  const double dt = options_.time_step_s;
  free_velocity_ = momentum_ + dt * passive_;
  for (std::size_t t = 0; t < factors_.size(); ++t) {
    const Multibody::Tree& tree = bodies_.trees()[t];
    auto velocity = free_velocity_.segment(tree.first, tree.count);  // before, what drives it
    Eigen::MatrixXd& mass = driven_masses_[t];
    mass = masses_[t];
    for (std::size_t m = 0; m < motors_.size(); ++m) {
      const Motor& motor = motors_[m];
      const int dof = bodies_.velocity_of_joint(motor.joint) - tree.first;
      if (dof < 0 || dof >= tree.count) continue;
      if (motor_limits_[m] != 0) {
        velocity[dof] += dt * motor_limits_[m] * motor.max_effort;
        continue;
      }
      mass(dof, dof) += dt * (motor.damping + dt * motor.stiffness);
      velocity[dof] +=
          dt * (motor.feed_forward +
                motor.stiffness * (motor.target - bodies_.joint_position(motor.joint)) +
                motor.damping * motor.target_velocity);
    }
    if (tree.loop_rows == 0) {
      factors_[t].compute(mass);
      factors_[t].solve_in_place(velocity);
    } else {
      factors_[t].compute(mass, loop_jacobians_[t]);
      factors_[t].solve_in_place(velocity);
      velocity -= factors_[t].velocity_with(loop_openings_[t] / dt);
    }
  }
}

/// The islands' problems, but for what friction is like.
void TimeStepper::assemble() {
  const double dt = options_.time_step_s;
  const int nc = int(contacts_.size()), rows = nc + int(limits_.size());
  problem_.free_velocity.setZero(4 * rows);
  row_values_.resize(4 * rows);
  approach_.resize(nc);
  for (int i = 0; i < nc; ++i)
    problem_.free_velocity[4 * i] = approach_[i] = approach_m_per_s(contacts_[std::size_t(i)]);
  for (int i = nc; i < rows; ++i)
    problem_.free_velocity[4 * i] = limits_[std::size_t(i - nc)].gap / dt;
  for (Island& island : islands_) {
    island.problem.delassus.setZero(4 * int(island.rows.size()), 4 * int(island.rows.size()));
    island.has_springs = false;
  }
  begin_roots();
  for (std::size_t t = 0; t < touching_.size(); ++t)
    if (!touching_[t].empty()) add_tree(t);
  for (Island& island : islands_)
    if (island.problem.root.cols() > 0)
      island.problem.root.resizeNonZeros(island.problem.root.outerIndexPtr()[island.root_columns]);
  add_compliance();
  add_dry_friction();
  describe_rebounds();
}

/// Makes the normal impulse of a row known: its normal belongs to a body of its own, which nothing
/// else moves, so that there is no other solution. Its Jacobian there is zero.
void TimeStepper::know_normal_impulse(int row, double impulse) {
  const Place& place = place_of_row_[std::size_t(row)];
  Island& island = islands_[std::size_t(place.island)];
  const auto diagonal = island.problem.delassus.diagonal().segment<4>(4 * place.position);
  const Eigen::Vector3d arms(1, 1, problem_.eccentricity_m[row]);
  // A face that joints keep from sliding has no response to friction.
  double response = diagonal.tail<3>().cwiseProduct(arms.cwiseAbs2()).maxCoeff();
  if (!(response > 0)) response = 1;
  double& normal = island.problem.delassus(4 * place.position, 4 * place.position);
  double speed = -1;
  if (impulse > 0) {
    // Any response will do. Residuals are relative to the largest velocity of a problem: this one
    // is neither far above nor far below that of the friction.
    constexpr double kLeastPart = 1e-3;
    const double stopped = response * impulse;
    speed = std::clamp(problem_.free_velocity.segment<3>(4 * row + 1).cwiseProduct(arms).norm(),
                       kLeastPart * stopped, stopped);
    normal = speed / impulse;
  } else {
    normal = response;
  }
  problem_.free_velocity[4 * row] = -speed;
}

/// The dry friction of joints is that of contacts with a known normal impulse, dt times the largest
/// effort. The joint's velocity is the first tangential one. The others are at rest, and so are
/// their impulses zero.
void TimeStepper::add_dry_friction() {
  const double dt = options_.time_step_s;
  const int nc = int(contacts_.size());
  for (int i = 0; i < int(limits_.size()); ++i) {
    if (limits_[std::size_t(i)].sign != kDryFriction) continue;
    const int row = nc + i;
    const Place& place = place_of_row_[std::size_t(row)];
    auto diagonal = islands_[std::size_t(place.island)].problem.delassus.diagonal().segment<4>(
        4 * place.position);
    // Loops may lock the joint: then there is nothing to resist.
    problem_.friction_coefficient[row] = diagonal[1] > 0 ? 1 : 0;
    diagonal.tail<2>().setConstant(diagonal[1] > 0 ? diagonal[1] : 1);
    know_normal_impulse(row, dt * bodies_.joint(limits_[std::size_t(i)].joint).dry_friction);
  }
  for (int i = 0; i < nc; ++i)
    if (contacts_[std::size_t(i)].role == Contact::FaceRole::friction)
      know_normal_impulse(i, face_impulses_[std::size_t(i)]);
}

TimeStepper::Island& TimeStepper::island_of(const std::vector<Touching>& rows) {
  return islands_[std::size_t(place_of_row_[std::size_t(rows.front().row)].island)];
}

/// Reserves room for the root G of W where it is of use and exists: closed loops subtract from W,
/// and elastic contacts add to it.
void TimeStepper::begin_roots() {
  constexpr int kNone = -1;
  root_columns_.assign(islands_.size(), options_.friction_rule == FrictionRule::facets ? kNone : 0);
  root_elements_.assign(islands_.size(), 0);
  for (std::size_t t = 0; t < touching_.size(); ++t) {
    if (touching_[t].empty()) continue;
    const auto island = std::size_t(&island_of(touching_[t]) - islands_.data());
    int& columns = root_columns_[island];
    columns = columns == kNone || factors_[t].is_constrained() ? kNone
                                                               : columns + bodies_.trees()[t].count;
    root_elements_[island] += int(jacobians_[t].size());
  }
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    if (!contacts_[i].compliance.isZero(0) || contacts_[i].role != Contact::FaceRole::rigid_point)
      root_columns_[std::size_t(place_of_row_[i].island)] = kNone;
  for (std::size_t i = 0; i < limits_.size(); ++i)
    if (limits_[i].sign == kDryFriction)
      root_columns_[std::size_t(place_of_row_[contacts_.size() + i].island)] = kNone;
  for (std::size_t i = 0; i < islands_.size(); ++i) {
    const int rows = 4 * int(islands_[i].rows.size());
    islands_[i].root_columns = 0;
    Eigen::SparseMatrix<double>& root = islands_[i].problem.root;
    const int root_columns = root_columns_[i] < rows ? std::max(root_columns_[i], 0) : 0;
    // Eigen takes new memory for each matrix without columns.
    if (root_columns > 0 || root.cols() > 0) root.resize(rows, root_columns);
    if (root.cols() > 0) root.resizeNonZeros(root_elements_[i]);
  }
}

/// The columns of a tree.
/// @param half  X of the rows that touch it
void TimeStepper::add_to_root(const std::vector<Touching>& rows, const Eigen::MatrixXd& half) {
  Island& island = island_of(rows);
  Eigen::SparseMatrix<double>& root = island.problem.root;
  if (root.cols() == 0) return;
  int end = root.outerIndexPtr()[island.root_columns];
  for (Eigen::Index k = 0; k < half.cols(); ++k) {
    for (std::size_t n = 0; n < rows.size(); ++n) {
      const int first = 4 * place_of_row_[std::size_t(rows[n].row)].position;
      for (int row = 0; row < 4; ++row) {
        const double value = half(4 * Eigen::Index(n) + row, k);
        if (value == 0) continue;
        root.innerIndexPtr()[end] = first + row;
        root.valuePtr()[end++] = value;
      }
    }
    root.outerIndexPtr()[++island.root_columns] = end;
  }
}

/// Replaces the tangential velocities of elastic contacts by those of sliding. Soft faces always
/// have springs: the centre of their pressure depends on them.
void TimeStepper::add_compliance() {
  const double dt = options_.time_step_s;
  for (Island& island : islands_) add_springs(island, Contact::FaceRole::soft_point);
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const Contact& contact = contacts_[i];
    if (contact.compliance.isZero(0)) continue;
    const Place& place = place_of_row_[i];
    islands_[std::size_t(place.island)].problem.delassus.diagonal().segment<3>(
        4 * place.position + 1) += contact.compliance / (dt * dt);
    problem_.free_velocity.segment<3>(4 * int(i) + 1) -=
        contact.compliance.cwiseProduct(contact.elastic_wrench) / dt;
  }
}

/// J v, four per row.
Eigen::VectorXd TimeStepper::row_velocities(const Eigen::VectorXd& velocity) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(4 * Eigen::Index(ids_.size()));
  for (std::size_t t = 0; t < touching_.size(); ++t) {
    if (touching_[t].empty()) continue;
    const Multibody::Tree& tree = bodies_.trees()[t];
    const Eigen::VectorXd own = jacobians_[t] * velocity.segment(tree.first, tree.count);
    for (std::size_t n = 0; n < touching_[t].size(); ++n)
      result.segment<4>(4 * touching_[t][n].row) += own.segment<4>(4 * Eigen::Index(n));
  }
  return result;
}

/// Contacts that hit in this step: their gap's part in the condition becomes that of the rebound.
void TimeStepper::describe_rebounds() {
  rebounds_ = false;
  const bool may_rebound =
      std::any_of(contacts_.begin(), contacts_.end(),
                  [](const Contact& contact) { return contact.restitution > 0; });
  if (!may_rebound || restitution_used_ == 0) return;
  before_ = row_velocities(bodies_.velocity());
  for (int i = 0; i < int(contacts_.size()); ++i) {
    const double restitution = restitution_used_ * contacts_[std::size_t(i)].restitution;
    const double before = before_[4 * i];
    const double free = problem_.free_velocity[4 * i] - approach_[i];
    // A rebound at the speed u comes back after 2 u/|a|: eight steps of the change of speed dt |a|.
    constexpr double kLeastSteps = 8;
    const bool hits = approach_[i] + std::min(free, before) < 0;
    if (!hits || !(restitution * -before > kLeastSteps / 2 * std::abs(free - before))) continue;
    rebounds_ = true;
    // n^T v' = v_free - (1 + e) v
    problem_.free_velocity[4 * i] = (1 + restitution) * before;
    approach_[i] = problem_.free_velocity[4 * i] - free;
  }
}

/// Whether the step's impulses add more energy than they take, the bodies' motion against the known
/// forces counted.
bool TimeStepper::makes_energy() const {
  const Eigen::VectorXd free = row_velocities(free_velocity_),
                        after = row_velocities(new_velocity_);
  const Eigen::VectorXd& impulse = solution_.impulse;
  // E' - E = T(v') - T(v) - dt f^T v', with dt f = M (v_free - v) and v' = v_free + M^-1 J^T r.
  const double gained = impulse.dot(after + 2 * before_ - free) / 2;
  const double scale = impulse.cwiseAbs().dot(before_.cwiseAbs());
  return gained > 1e-9 * scale;
}

/// The part of a tree in the velocities of the rows that act on it, and in how they feel each
/// other.
void TimeStepper::add_tree(std::size_t t) {
  const auto& list = touching_[t];
  const Multibody::Tree& tree = bodies_.trees()[t];
  auto velocities = row_values_.head(jacobians_[t].rows());
  velocities.noalias() = jacobians_[t] * free_velocity_.segment(tree.first, tree.count);
  for (std::size_t n = 0; n < list.size(); ++n)
    problem_.free_velocity.segment<4>(4 * list[n].row) +=
        velocities.segment<4>(4 * Eigen::Index(n));
  Eigen::MatrixXd& half = halves_[t];
  factors_[t].half(jacobians_[t], half);
  const Eigen::MatrixXd taken = factors_[t].half_taken(jacobians_[t]);
  add_to_root(list, half);
  Eigen::MatrixXd& delassus = island_of(list).problem.delassus;
  with_best_instructions([&] {
    for (std::size_t n = 0; n < list.size(); ++n) {
      const int i = 4 * place_of_row_[std::size_t(list[n].row)].position;
      for (std::size_t k = n; k < list.size(); ++k) {
        const int j = 4 * place_of_row_[std::size_t(list[k].row)].position;
        Eigen::Matrix4d block = Eigen::Matrix4d::Zero();
        add_product(1, half, 4 * Eigen::Index(k), 4 * Eigen::Index(n), block);
        const double free_response = block(0, 0);
        add_product(-1, taken, 4 * Eigen::Index(k), 4 * Eigen::Index(n), block);
        // A motion that loops lock answers to impulses with the rounding of this difference, or
        // less.
        constexpr double kLocked = 1e-12;
        if (k == n) block(0, 0) = std::max(block(0, 0), kLocked * free_response);
        // Loops may leave a joint a response of nothing, which rounding makes negative.
        if (k == n && list[n].joint >= 0 && list[n].sign == kDryFriction)
          block(1, 1) = std::max(block(1, 1), 0.);
        delassus.block<4, 4>(j, i) += block;
        if (k != n) delassus.block<4, 4>(i, j) += block.transpose();
      }
    }
  });
}

/// The part of the gap in the condition of a contact. A gap is known to the rounding of the places
/// that it lies between. Bodies at rest touch within that, and what it is exactly would only be
/// noise in their impulses: that much of each gap does not count.
double TimeStepper::approach_m_per_s(const Contact& contact) const {
  constexpr double kRoundings = 8;
  const double rounding_m =
      kRoundings * std::numeric_limits<double>::epsilon() * contact.point_m.lpNorm<1>();
  const double gap_m = contact.gap_m - std::clamp(contact.gap_m, -rounding_m, rounding_m);
  return std::max(gap_m / options_.time_step_s, -options_.correction_m_per_s);
}

/// Sets the friction of all contacts, without those e_n that depend on the load.
void TimeStepper::describe_friction() {
  const int nc = int(contacts_.size()), rows = nc + int(limits_.size());
  problem_.friction_coefficient.setZero(rows);
  problem_.eccentricity_m.setZero(rows);
  problem_.shapes.assign(std::size_t(rows), nullptr);
  problem_.friction_rule = options_.friction_rule;
  problem_.vertices = options_.friction_vertices;
  for (int i = 0; i < nc; ++i) {
    const Contact& contact = contacts_[std::size_t(i)];
    problem_.friction_coefficient[i] = contact.friction_coefficient;
    if (!contact.eccentricity_law) problem_.eccentricity_m[i] = contact.eccentricity_m;
    problem_.shapes[std::size_t(i)] = contact.shape;
  }
}

/// Trees that a row joins, and all that they are joined to, are one island.
void TimeStepper::find_islands() {
  const int nc = int(contacts_.size()), rows = nc + int(limits_.size());
  island_of_tree_.resize(bodies_.trees().size());
  for (std::size_t t = 0; t < island_of_tree_.size(); ++t) island_of_tree_[t] = int(t);
  const auto root = [this](int tree) {
    while (island_of_tree_[std::size_t(tree)] != tree) tree = island_of_tree_[std::size_t(tree)];
    return tree;
  };
  const auto tree_of_row = [&](int row) {
    if (row >= nc)
      return bodies_.tree_of(bodies_.joint(limits_[std::size_t(row - nc)].joint).child);
    const Contact& contact = contacts_[std::size_t(row)];
    const int a = bodies_.tree_of(contact.a);
    return a >= 0 ? a : bodies_.tree_of(contact.b);
  };
  for (const Contact& contact : contacts_) {
    const int a = bodies_.tree_of(contact.a), b = bodies_.tree_of(contact.b);
    if (a >= 0 && b >= 0) island_of_tree_[std::size_t(root(a))] = root(b);
  }
  last_ids_.swap(ids_);
  last_places_.swap(place_of_row_);
  ids_.clear();
  for (const Contact& contact : contacts_) ids_.push_back(contact.id);
  for (const Limit& limit : limits_)
    ids_.push_back(-2 - 3 * long(limit.joint) - (limit.sign > 0 ? 1 : limit.sign < 0 ? 0 : 2));
  place_of_row_.clear();
  face_impulses_.assign(std::size_t(rows), 0);
  island_of_root_.assign(island_of_tree_.size(), -1);
  island_sizes_.clear();
  for (int row = 0; row < rows; ++row) {
    int& index = island_of_root_[std::size_t(root(tree_of_row(row)))];
    if (index < 0) {
      index = int(island_sizes_.size());
      island_sizes_.push_back(0);
    }
    place_of_row_.push_back({index, island_sizes_[std::size_t(index)]++});
  }
  // Most steps have the islands of the last one.
  if (ids_ == last_ids_ && place_of_row_ == last_places_)
    continue_same_islands();
  else
    continue_other_islands();
}

void TimeStepper::continue_same_islands() {
  for (Island& island : islands_) {
    for (std::size_t i = 0; i < island.rows.size(); ++i)
      continue_row(island, i, island, island.ids[i] == Contact::kNoId ? -1 : int(i));
    island.step = steps_;
  }
}

/// Each island takes over the solver, and e_n, of a last one with which it shares a row.
void TimeStepper::continue_other_islands() {
  std::vector<Island> last(island_sizes_.size());
  last.swap(islands_);
  for (std::size_t row = 0; row < place_of_row_.size(); ++row)
    islands_[std::size_t(place_of_row_[row].island)].rows.push_back(int(row));
  std::unordered_map<long, Place> last_places;
  for (std::size_t island = 0; island < last.size(); ++island)
    for (std::size_t i = 0; i < last[island].ids.size(); ++i)
      if (last[island].ids[i] != Contact::kNoId)
        last_places.emplace(last[island].ids[i], Place{int(island), int(i)});
  for (Island& island : islands_) {
    for (const int row : island.rows) island.ids.push_back(ids_[std::size_t(row)]);
    const std::size_t count = island.rows.size();
    island.continued.assign(count, -1);
    island.earlier_eccentricity_m.setZero(Eigen::Index(count));
    island.step = steps_;
    const auto place_of = [&](std::size_t i) {
      const auto found = last_places.find(island.ids[i]);
      return found == last_places.end() ? Place{-1, -1} : found->second;
    };
    int from = -1;
    for (std::size_t i = 0; i < count && from < 0; ++i) {
      const int candidate = place_of(i).island;
      if (candidate < 0) continue;
      const Island& before = last[std::size_t(candidate)];
      if (before.solver && before.capacity >= int(count)) from = candidate;
    }
    if (from < 0) {
      island.capacity = int(count) + int(count) / 2 + 1;
      island.solver.emplace(island.capacity, int(options_.friction_vertices.cols()));
      continue;
    }
    Island& before = last[std::size_t(from)];
    for (std::size_t i = 0; i < count; ++i) {
      const Place place = place_of(i);
      if (place.island == from) continue_row(island, i, before, place.position);
    }
    island.problem.delassus.swap(before.problem.delassus);  // their memory
    island.problem.root.swap(before.problem.root);
    island.solver = std::move(before.solver);
    before.solver.reset();  // taken
    island.capacity = before.capacity;
    island.solved = before.solved;
    island.faces_slid = before.faces_slid;
  }
}

/// @param position  of the row in `before`, which may be the island itself; -1: it was not there
void TimeStepper::continue_row(Island& island, std::size_t i, const Island& before, int position) {
  island.continued[i] = position;
  if (position < 0) return;
  const double earlier_m = before.earlier_eccentricity_m[position];
  island.earlier_eccentricity_m[int(i)] = 0;
  const int row = island.rows[i];
  if (row >= int(contacts_.size())) return;
  if (before.solved) face_impulses_[std::size_t(row)] = before.solution.impulse[4 * position];
  const EccentricityLaw* law = contacts_[std::size_t(row)].eccentricity_law;
  if (!law) return;
  const double last_m = before.problem.eccentricity_m[position];
  double& next_m = problem_.eccentricity_m[row];
  next_m = last_m;
  if (before.step == steps_) {
    // This step is solved again, with more rows.
    island.earlier_eccentricity_m[int(i)] = earlier_m;
  } else if (before.solved && before.solution.impulse[4 * position] > 0) {
    // In smooth motion the next one lies on the line through the last two.
    if (earlier_m > 0) next_m = std::clamp(2 * last_m - earlier_m, last_m / 2, 2 * last_m);
    island.earlier_eccentricity_m[int(i)] = last_m;
  }
  if (law->friction_coefficient(1))  // of any load: whether it has one
    problem_.friction_coefficient[row] = before.problem.friction_coefficient[position];
}

/// Copies the island's part of the problem; its W is there.
void TimeStepper::describe(Island& island) {
  const int count = int(island.rows.size());
  ContactLcp& part = island.problem;
  part.free_velocity.resize(4 * count);
  part.friction_coefficient.resize(count);
  part.eccentricity_m.resize(count);
  part.vertices = problem_.vertices;
  part.friction_rule = problem_.friction_rule;
  part.shapes.resize(std::size_t(count));
  island.laws.assign(std::size_t(count), nullptr);
  for (int i = 0; i < count; ++i) {
    const int row = island.rows[std::size_t(i)];
    part.free_velocity.segment<4>(4 * i) = problem_.free_velocity.segment<4>(4 * row);
    part.friction_coefficient[i] = problem_.friction_coefficient[row];
    part.eccentricity_m[i] = problem_.eccentricity_m[row];
    part.shapes[std::size_t(i)] = problem_.shapes[std::size_t(row)];
    if (row < int(contacts_.size()))
      island.laws[std::size_t(i)] = contacts_[std::size_t(row)].eccentricity_law;
  }
}

ContactLcp TimeStepper::problem() const {
  ContactLcp whole = problem_;
  const int rows = int(ids_.size());
  whole.delassus.setZero(4 * rows, 4 * rows);
  for (const Island& island : islands_)
    for (std::size_t i = 0; i < island.rows.size(); ++i)
      for (std::size_t j = 0; j < island.rows.size(); ++j)
        whole.delassus.block<4, 4>(4 * island.rows[i], 4 * island.rows[j]) =
            island.problem.delassus.block<4, 4>(4 * int(i), 4 * int(j));
  const auto has_root = [](const Island& island) {
    return island.problem.root.cols() > 0 && !island.has_springs;
  };
  if (!std::all_of(islands_.begin(), islands_.end(), has_root)) return whole;
  std::vector<Eigen::Triplet<double>> elements;
  int columns = 0;
  for (const Island& island : islands_)
    for (int k = 0; k < island.problem.root.cols(); ++k, ++columns)
      for (Eigen::SparseMatrix<double>::InnerIterator one(island.problem.root, k); one; ++one)
        elements.emplace_back(4 * island.rows[std::size_t(one.row() / 4)] + int(one.row() % 4),
                              columns, one.value());
  whole.root.resize(4 * rows, columns);
  whole.root.setFromTriplets(elements.begin(), elements.end());
  return whole;
}

/// Solves an island, each e_n that of its own load.
LcpResult TimeStepper::solve(Island& island, StepResult& result) {
  const ConsistentResult consistent =
      island.solver->solve(island.problem, island.laws, options_.time_step_s, island.solution, {},
                           island.solved ? &island.continued : nullptr);
  LcpResult solved = consistent.lcp;
  const auto accepted = [&] {
    // Masses that differ by a billion leave fewer digits than that to their velocities.
    constexpr double kMostRounding = 1e-5;
    return std::max(options_.accepted_residual,
                    internal::rounding_of(island.problem, island.solution, kMostRounding));
  };
  if (solved.status == LcpStatus::iteration_limit && solved.residual <= accepted())
    solved.status = LcpStatus::solved;
  island.solved = solved.status == LcpStatus::solved;
  for (std::size_t i = 0; i < island.continued.size(); ++i) island.continued[i] = int(i);
  result.load_iterations = std::max(result.load_iterations, consistent.iterations);
  result.load_disagreement = std::max(result.load_disagreement, consistent.inconsistency);
  return solved;
}

/// Whether points of a rigid face slide that share its force with others.
bool TimeStepper::faces_slide(const Island& island) const {
  constexpr double kNone = 1e-7;
  const double least = kNone * island.problem.free_velocity.lpNorm<Eigen::Infinity>();
  for (std::size_t i = 0; i < island.rows.size(); ++i)
    if (has_springs(island, i, Contact::FaceRole::rigid_point) &&
        island.problem.friction_coefficient[int(i)] > 0 &&
        island.solution.impulse[4 * int(i)] > 0 && island.solution.slip[int(i)] > least)
      return true;
  return false;
}

/// Whether a row is a point of a face with others, in this role.
bool TimeStepper::has_springs(const Island& island, std::size_t i, Contact::FaceRole role) const {
  const auto face = [&](std::size_t other) {
    const auto row = std::size_t(island.rows[other]);
    return row < contacts_.size() ? contacts_[row].face : Contact::kNoFace;
  };
  if (face(i) == Contact::kNoFace) return false;
  if (contacts_[std::size_t(island.rows[i])].role != role) return false;
  return (i > 0 && face(i - 1) == face(i)) ||
         (i + 1 < island.rows.size() && face(i + 1) == face(i));
}

/// Equal springs under the points of each face.
/// @param sign  -1: takes them out again
void TimeStepper::add_springs(Island& island, Contact::FaceRole role, double sign) const {
  constexpr double kSpring = 1e-6;
  double spring = 0;
  long face = Contact::kNoFace;
  for (std::size_t i = 0; i < island.rows.size(); ++i) {
    if (!has_springs(island, i, role)) continue;
    double& normal = island.problem.delassus(4 * Eigen::Index(i), 4 * Eigen::Index(i));
    const long own = contacts_[std::size_t(island.rows[i])].face;
    if (own != face) spring = kSpring * normal;
    face = own;
    normal += sign * spring;
  }
}

LcpResult TimeStepper::solve_with_springs(Island& island, StepResult& result) {
  if (!island.has_springs) add_springs(island, Contact::FaceRole::rigid_point);
  island.has_springs = true;
  island.problem.root.swap(no_root_);
  const LcpResult solved = solve(island, result);
  island.problem.root.swap(no_root_);
  return solved;
}

/// Solves an island, with springs if its rigid faces slide.
LcpResult TimeStepper::solve_faces(Island& island, StepResult& result) {
  LcpResult solved;
  if (!island.faces_slid && !island.has_springs) {
    solved = solve(island, result);
    if (solved.status != LcpStatus::solved || !faces_slide(island)) return solved;
    island.solved = false;  // of many solutions: the one with springs may be far from it
  }
  solved = solve_with_springs(island, result);
  island.faces_slid = solved.status == LcpStatus::solved && faces_slide(island);
  if (solved.status == LcpStatus::solved) return solved;
  add_springs(island, Contact::FaceRole::rigid_point, -1);
  island.has_springs = false;
  return solve(island, result);
}

double TimeStepper::load_of_face(const Island& island, long face) const {
  double sum = 0;
  for (std::size_t i = 0; i < island.rows.size(); ++i) {
    const auto row = std::size_t(island.rows[i]);
    if (row < contacts_.size() && contacts_[row].face == face &&
        contacts_[row].role == Contact::FaceRole::soft_point)
      sum += island.solution.impulse[4 * Eigen::Index(i)];
  }
  return sum;
}

/// Gives the friction of soft faces the load that they have now. Returns by how much the loads
/// differ from those before, relative.
double TimeStepper::take_own_loads(Island& island) {
  double worst = 0;
  for (const int row : island.rows) {
    if (row >= int(contacts_.size())) continue;
    const Contact& contact = contacts_[std::size_t(row)];
    if (contact.role != Contact::FaceRole::friction) continue;
    double& known = face_impulses_[std::size_t(row)];
    const double own = load_of_face(island, contact.face);
    if (own != known) worst = std::max(worst, std::abs(own - known) / std::max(own, known));
    known = own;
    know_normal_impulse(row, own);
    island.problem.free_velocity[4 * place_of_row_[std::size_t(row)].position] =
        problem_.free_velocity[4 * row];
  }
  return worst;
}

LcpResult TimeStepper::solve_under_own_loads(Island& island, StepResult& result) {
  constexpr int kMostIterations = 50;
  constexpr double kAgree = 1e-9;
  for (int iteration = 1;; ++iteration) {
    const LcpResult solved = solve_faces(island, result);
    if (solved.status != LcpStatus::solved) return solved;
    const double disagreement = take_own_loads(island);
    if (disagreement > kAgree && iteration < kMostIterations) continue;
    result.load_iterations = std::max(result.load_iterations, iteration);
    result.load_disagreement = std::max(result.load_disagreement, disagreement);
    return solved;
  }
}

LcpResult TimeStepper::solve_islands(StepResult& result) {
  LcpResult all;
  all.status = LcpStatus::solved;
  solution_.resize(int(ids_.size()));
  for (Island& island : islands_) {
    describe(island);
    if (all.status != LcpStatus::solved) {
      island.solved = false;
      continue;
    }
    const LcpResult solved = solve_under_own_loads(island, result);
    all.pivots += solved.pivots;
    all.attempts = std::max(all.attempts, solved.attempts);
    all.solved_by = std::max(all.solved_by, solved.solved_by);  // the lowest rung
    all.residual = std::max(all.residual, solved.residual);
    for (std::size_t i = 0; i < island.rows.size(); ++i) {
      const int row = island.rows[i], own = int(i);
      solution_.impulse.segment<4>(4 * row) = island.solution.impulse.segment<4>(4 * own);
      solution_.velocity.segment<4>(4 * row) = island.solution.velocity.segment<4>(4 * own);
      solution_.slip[row] = island.solution.slip[own];
      solution_.ray.segment<4>(4 * row) = island.solution.ray.segment<4>(4 * own);
      const double earlier_m = island.earlier_eccentricity_m[own];
      double& own_m = island.problem.eccentricity_m[own];
      // Without load the guess was not corrected, and the last one stays.
      if (earlier_m > 0 && !(island.solution.impulse[4 * own] > 0)) own_m = earlier_m;
      problem_.eccentricity_m[row] = own_m;
      problem_.friction_coefficient[row] = island.problem.friction_coefficient[own];
    }
    if (solved.status == LcpStatus::solved) continue;
    all.status = solved.status;
    all.proof = solved.proof;
  }
  return all;
}

double TimeStepper::unlimited_effort(int m) const {
  const Motor& motor = motors_[std::size_t(m)];
  const double velocity = new_velocity_[bodies_.velocity_of_joint(motor.joint)];
  const double position = bodies_.joint_position(motor.joint) + options_.time_step_s * velocity;
  return motor.feed_forward + motor.stiffness * (motor.target - position) +
         motor.damping * (motor.target_velocity - velocity);
}

/// Motors whose effort at the new velocities would exceed their limit are held at it; those held at
/// a limit that would need less are released.
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

/// Forces on a tree besides gravity that do not depend on its velocity; empty: there are none.
SmoothMotion::Forces TimeStepper::forces_on(std::size_t t) const {
  const Multibody::Tree& tree = bodies_.trees()[t];
  std::vector<const AppliedForce*> applied;
  for (const AppliedForce& force : applied_forces_)
    if (bodies_.tree_of(force.body) == int(t) &&
        (force.force_N.squaredNorm() > 0 || force.torque_Nm.squaredNorm() > 0))
      applied.push_back(&force);
  Eigen::VectorXd efforts = Eigen::VectorXd::Zero(tree.count);
  for (std::size_t m = 0; m < motors_.size(); ++m) {
    const int dof = bodies_.velocity_of_joint(motors_[m].joint) - tree.first;
    if (dof >= 0 && dof < tree.count) efforts[dof] += motor_efforts_[m];
  }
  if (applied.empty() && efforts.isZero(0)) return {};
  return [this, applied, efforts](Eigen::Ref<Eigen::VectorXd> forces) {
    forces += efforts;
    for (const AppliedForce* force : applied)
      bodies_.add_force(force->body, bodies_.pose(force->body) * force->point_in_body_m,
                        force->force_N, force->torque_Nm, forces);
  };
}

/// Finds which trees can move smoothly: nothing pushes at them but forces that are known.
void TimeStepper::prepare_smooth_motion() {
  std::fill(is_smooth_.begin(), is_smooth_.end(), 1);
  for (const Motor& motor : motors_) {
    if (motor.stiffness == 0 && motor.damping == 0) continue;
    is_smooth_[std::size_t(bodies_.tree_of(bodies_.joint(motor.joint).child))] = 0;
  }
  for (std::size_t t = 0; t < touching_.size(); ++t)
    for (const Touching& touching : touching_[t])
      if (!solution_.impulse.segment<4>(4 * touching.row).isZero(0)) is_smooth_[t] = 0;
  for (std::size_t t = 0; t < touching_.size(); ++t) {
    if (!is_smooth_[t]) continue;
    const Multibody::Tree& tree = bodies_.trees()[t];
    is_smooth_[t] = smooth_motions_[t].prepare(
        bodies_, tree, options_.time_step_s, options_.gravity_m_per_s2,
        passive_.segment(tree.first, tree.count), forces_on(t), factors_[t]);
  }
}

/// The contact problem keeps bodies apart that move by its velocities. Trees whose smooth motion
/// would close a gap, or break a joint's limit, are left to it.
void TimeStepper::keep_smooth_motion_apart() {
  if (std::none_of(is_smooth_.begin(), is_smooth_.end(), [](char smooth) { return smooth != 0; }))
    return;
  const double dt = options_.time_step_s;
  const auto mean_velocity = [this](std::size_t t) -> Eigen::VectorXd {
    const Multibody::Tree& tree = bodies_.trees()[t];
    if (is_smooth_[t]) return smooth_motions_[t].mean_velocity();
    return new_velocity_.segment(tree.first, tree.count);
  };
  for (int j = 0; j < bodies_.joints(); ++j) {
    const int dof = bodies_.velocity_of_joint(j);
    if (dof < 0) continue;
    const JointDescription& joint = bodies_.joint(j);
    const int t = bodies_.tree_of(joint.child);
    if (!is_smooth_[std::size_t(t)]) continue;
    const double next = bodies_.joint_position(j) +
                        dt * smooth_motions_[std::size_t(t)]
                                 .mean_velocity()[dof - bodies_.trees()[std::size_t(t)].first];
    if (next < joint.lower || next > joint.upper) is_smooth_[std::size_t(t)] = 0;
  }
  const int nc = int(contacts_.size());
  // A tree that is left to the contact problem may close the gaps of its neighbours.
  for (bool changed = true; changed;) {
    changed = false;
    Eigen::VectorXd closing = Eigen::VectorXd::Zero(Eigen::Index(ids_.size()));
    for (int row = 0; row < closing.size(); ++row)
      closing[row] = row < nc ? approach_[row] : limits_[std::size_t(row - nc)].gap / dt;
    for (std::size_t t = 0; t < touching_.size(); ++t) {
      if (touching_[t].empty()) continue;
      const Eigen::VectorXd velocities = jacobians_[t] * mean_velocity(t);
      for (std::size_t n = 0; n < touching_[t].size(); ++n)
        closing[touching_[t][n].row] += velocities[4 * Eigen::Index(n)];
    }
    for (std::size_t t = 0; t < touching_.size(); ++t)
      for (const Touching& touching : touching_[t])
        if (is_smooth_[t] && closing[touching.row] < 0) {
          is_smooth_[t] = 0;
          changed = true;
        }
  }
}

void TimeStepper::move(StepResult& result) {
  for (std::size_t t = 0; t < is_smooth_.size(); ++t) {
    const Multibody::Tree& tree = bodies_.trees()[t];
    if (is_smooth_[t] &&
        smooth_motions_[t].finish(bodies_, tree, options_.time_step_s, factors_[t])) {
      ++result.smooth_trees;
      continue;
    }
    bodies_.set_velocity(tree, new_velocity_.segment(tree.first, tree.count));
    bodies_.integrate(tree, options_.time_step_s);
  }
}

StepResult TimeStepper::step(ContactFinder& finder) {
  StepResult result;
  for (std::size_t t = 0; t < masses_.size(); ++t) {
    const Multibody::Tree& tree = bodies_.trees()[t];
    bodies_.mass_matrix(tree, masses_[t]);
    if (tree.loop_rows > 0) bodies_.loops(tree, loop_jacobians_[t], loop_openings_[t]);
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
  describe_friction();
  find_islands();
  restitution_used_ = 1;
  // Changing all contradicting motors at once usually ends sooner; changing one at a time always
  // ends.
  constexpr int kAtOnce = 8;
  const int most_changes = kAtOnce + 20 * int(motors_.size());
  for (int round = 0;; ++round) {
    factorise();
    assemble();
    new_velocity_ = free_velocity_;
    if (!ids_.empty()) {
      const LcpResult solved = solve_islands(result);
      const int pivots = result.lcp.pivots + solved.pivots;
      result.lcp = solved;
      result.lcp.pivots = pivots;
      if (solved.status != LcpStatus::solved) break;
      for (std::size_t t = 0; t < touching_.size(); ++t) {
        if (touching_[t].empty()) continue;
        const Multibody::Tree& tree = bodies_.trees()[t];
        auto impulse = row_values_.head(jacobians_[t].rows());
        for (int n = 0; n < int(touching_[t].size()); ++n)
          impulse.segment<4>(4 * n) =
              solution_.impulse.segment<4>(4 * touching_[t][std::size_t(n)].row);
        auto change = change_.segment(tree.first, tree.count);
        change.noalias() = jacobians_[t].transpose() * impulse;
        factors_[t].solve_in_place(change);
        new_velocity_.segment(tree.first, tree.count) += change;
      }
    } else {
      result.lcp.status = LcpStatus::solved;
    }
    if (add_broken_limits()) {
      describe_rows();
      describe_friction();
      find_islands();
      --round;
      continue;
    }
    if (rebounds_ && makes_energy()) {
      constexpr double kLeastUsed = 1e-3;
      restitution_used_ = restitution_used_ > kLeastUsed ? restitution_used_ / 2 : 0;
      --round;
      continue;
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
  result.restitution_used = restitution_used_;
  if (!result.done()) return result;
  prepare_smooth_motion();
  keep_smooth_motion_apart();
  move(result);
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
  velocity[0] -= approach_[contact];
  return velocity;
}

}  // namespace softfinger
