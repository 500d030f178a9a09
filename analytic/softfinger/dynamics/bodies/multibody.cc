#include "softfinger/dynamics/bodies/multibody.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "softfinger/dynamics/bodies/symmetric_matrix.h"
#include "softfinger/input/errors.h"

namespace softfinger {
namespace {

int count_velocities(JointKind kind) {
  return kind == JointKind::fixed ? 0 : kind == JointKind::ball ? 3 : 1;
}

/// Whether a loop of this kind holds the motion along x, y, z, or about them; z is its axis.
bool is_held(JointKind kind, int motion) {
  if (kind == JointKind::ball) return motion < 3;
  if (kind == JointKind::prismatic) return motion != 2;
  if (kind == JointKind::revolute) return motion != 5;
  return true;
}

int count_loop_rows(JointKind kind) {
  int rows = 0;
  for (int motion = 0; motion < 6; ++motion) rows += is_held(kind, motion);
  return rows;
}

/// A turn of the z axis to `axis`, of any length. Eigen's own decomposes a matrix for that.
Eigen::Matrix3d turned_to(const Eigen::Vector3d& axis) {
  const Eigen::Vector3d to = axis.normalized();
  if (to.z() < -0.5) {  // by half a turn about x first
    const Eigen::Vector3d opposite(1, -1, -1);
    return opposite.asDiagonal() * turned_to(opposite.cwiseProduct(to));
  }
  const double x = to.x(), y = to.y(), part = 1 / (1 + to.z());
  Eigen::Matrix3d turn;
  turn << 1 - x * x * part, -x * y * part, x, -x * y * part, 1 - y * y * part, y, -x, -y, to.z();
  return turn;
}

}  // namespace

/// Angular part, and linear part at the reference point: of a motion (w, u) or a force (torque,
/// force).
struct Multibody::SpatialVector {
  Eigen::Vector3d angular = Eigen::Vector3d::Zero(), linear = Eigen::Vector3d::Zero();

  SpatialVector& operator+=(const SpatialVector& other) {
    angular += other.angular;
    linear += other.linear;
    return *this;
  }
  SpatialVector operator*(double factor) const { return {angular * factor, linear * factor}; }
  double dot(const SpatialVector& other) const {
    return angular.dot(other.angular) + linear.dot(other.linear);
  }
};

struct Multibody::SpatialInertia {
  double mass = 0;
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< mass times centre
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();

  SpatialInertia& operator+=(const SpatialInertia& other) {
    mass += other.mass;
    moment += other.moment;
    inertia += other.inertia;
    return *this;
  }
  SpatialVector operator*(const SpatialVector& motion) const {
    return {inertia * motion.angular + moment.cross(motion.linear),
            mass * motion.linear + motion.angular.cross(moment)};
  }
};

Multibody::Multibody(std::vector<BodyDescription> bodies, std::vector<JointDescription> joints,
                     std::vector<LoopDescription> loops)
    : bodies_(std::move(bodies)),
      joints_(std::move(joints)),
      loops_(std::move(loops)),
      joints_below_(bodies_.size()),
      parent_joint_(bodies_.size(), -1),
      last_dof_(bodies_.size(), -1),
      tree_of_body_(bodies_.size(), -1),
      joint_dofs_(joints_.size(), -1) {
  for (const BodyDescription& body : bodies_) {
    if (body.massless) {
      if (body.mass.mass_kg != 0 || !body.mass.inertia_kg_m2.isZero(0))
        throw InputError("body \"" + body.name + "\"", "mass", "", "none: it is massless");
    } else if (!body.fixed) {
      require_physical(body.mass, "body \"" + body.name + "\"");
    }
    if (!body.pose.matrix().allFinite() || !body.velocity_m_per_s.allFinite() ||
        !body.angular_velocity_rad_per_s.allFinite())
      throw InputError("body \"" + body.name + "\"", "pose or velocity", "not finite",
                       "finite numbers");
    poses_.push_back(body.pose);
  }
  for (int j = 0; j < int(joints_.size()); ++j) {
    check(j);
    const JointDescription& joint = joints_[std::size_t(j)];
    parent_joint_[std::size_t(joint.child)] = j;
    const Eigen::Isometry3d parent = pose_or_world(joint.parent);
    child_in_parent_.push_back(parent.inverse() * poses_[std::size_t(joint.child)]);
    anchor_in_parent_.push_back(parent.inverse() * joint.anchor_m);
    const bool has_axis = joint.kind == JointKind::revolute || joint.kind == JointKind::prismatic;
    axis_in_parent_.push_back(
        parent.linear().transpose() *
        (has_axis ? joint.axis.normalized().eval() : Eigen::Vector3d::UnitZ().eval()));
    joint_positions_.push_back(joint.start);
    ball_turns_.push_back(Eigen::Quaterniond::Identity());
  }
  for (const LoopDescription& loop : loops_) {
    check(loop);
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
    frame.linear() = turned_to(loop.axis);
    frame.translation() = loop.anchor_m;
    loop_frames_.push_back(
        {pose_or_world(loop.a).inverse() * frame, pose_or_world(loop.b).inverse() * frame});
  }
  build_trees();
  velocity_.setZero(velocities());
  for (const int j : order_) place_child(j);
  for (const Tree& tree : trees_) place_children(tree);
  require_masses();
  for (int b = 0; b < this->bodies(); ++b) {
    const int last = last_dof_[std::size_t(b)];
    if (last < 0 || dofs_[std::size_t(last)].kind != DofKind::free_angular) continue;
    if (dofs_[std::size_t(last)].body != b) continue;
    velocity_.segment<3>(last - 5) = bodies_[std::size_t(b)].velocity_m_per_s;
    velocity_.segment<3>(last - 2) = bodies_[std::size_t(b)].angular_velocity_rad_per_s;
  }
}

void Multibody::check(int j) const {
  const JointDescription& joint = joints_[std::size_t(j)];
  const std::string where = "joint \"" + joint.name + "\"";
  const auto refuse = [&](const char* field, const std::string& value, const char* allowed) {
    throw InputError(where, field, value, allowed);
  };
  if (joint.child < 0 || joint.child >= bodies()) refuse("child", "", "one of the bodies");
  if (joint.parent < -1 || joint.parent >= bodies() || joint.parent == joint.child)
    refuse("parent", "", "another body, or the world");
  const std::string& child = bodies_[std::size_t(joint.child)].name;
  if (bodies_[std::size_t(joint.child)].fixed)
    refuse("child", child, "a body that is not fixed to the world");
  if (parent_joint_[std::size_t(joint.child)] >= 0)
    refuse("child", child, "a body without another parent: one joint holds it");
  if (joint.kind == JointKind::fixed) return;
  if (!joint.anchor_m.allFinite()) refuse("anchor", "", "three finite numbers");
  if (joint.kind == JointKind::ball) return;
  if (!(joint.axis.norm() > 0) || !joint.axis.allFinite())
    refuse("axis", "", "a direction: three finite numbers, not all 0");
  if (!(joint.rotor_inertia >= 0) || !std::isfinite(joint.rotor_inertia))
    refuse("rotor inertia", "", "a finite number >= 0");
  if (!(joint.dry_friction >= 0) || !std::isfinite(joint.dry_friction))
    refuse("dry friction", "", "a finite number >= 0");
  if (!(joint.lower <= joint.start && joint.start <= joint.upper) || !std::isfinite(joint.start))
    refuse("limits", "", "lower <= start <= upper");
  if (joint.leader < 0) return;
  const auto moves = [this](int one) {
    const JointKind kind = joints_[std::size_t(one)].kind;
    return kind == JointKind::revolute || kind == JointKind::prismatic;
  };
  if (joint.leader >= joints() || !moves(j) || !moves(joint.leader))
    refuse("leader", "", "a revolute or prismatic joint, of another such joint");
  if (!std::isfinite(joint.ratio)) refuse("ratio", "", "a finite number");
  int leader = joint.leader;
  for (int steps = 0; leader >= 0 && leader < joints() && steps <= joints(); ++steps) {
    if (leader == j) refuse("leader", "", "a joint that does not follow this one");
    leader = joints_[std::size_t(leader)].leader;
  }
}

void Multibody::check(const LoopDescription& loop) const {
  const auto refuse = [&](const char* field, const char* allowed) {
    throw InputError("loop \"" + loop.name + "\"", field, "", allowed);
  };
  for (const int body : {loop.a, loop.b})
    if (body < -1 || body >= bodies()) refuse("bodies", "two of the bodies, or one and the world");
  if (loop.a == loop.b) refuse("bodies", "two different ones");
  if (!loop.anchor_m.allFinite()) refuse("anchor", "three finite numbers");
  if (!(loop.axis.norm() > 0) || !loop.axis.allFinite())
    refuse("axis", "a direction: three finite numbers, not all 0");
}

void Multibody::add_free_dofs(int body) {
  for (const DofKind kind : {DofKind::free_linear, DofKind::free_angular})
    for (int axis = 0; axis < 3; ++axis) {
      Dof dof;
      dof.kind = kind;
      dof.parent = kind == DofKind::free_linear && axis == 0 ? -1 : velocities() - 1;
      dof.base = kind == DofKind::free_linear ? -1 : velocities() - 3 - axis;
      dof.body = body;
      dof.axis = Eigen::Vector3d::Unit(axis);
      dofs_.push_back(dof);
      tree_of_dof_.push_back(int(trees_.size()) - 1);
    }
}

/// Adds joints and all below them to the last tree, parents first.
void Multibody::add_joints_below(const std::vector<int>& joints) {
  std::vector<int> waiting(joints.rbegin(), joints.rend());
  while (!waiting.empty()) {
    const int j = waiting.back();
    waiting.pop_back();
    order_.push_back(j);
    const JointDescription& joint = joints_[std::size_t(j)];
    const std::size_t child = std::size_t(joint.child);
    const int above = joint.parent < 0 ? -1 : last_dof_[std::size_t(joint.parent)];
    last_dof_[child] = above;
    if (joint.kind != JointKind::fixed) joint_dofs_[std::size_t(j)] = velocities();
    for (int axis = 0; axis < count_velocities(joint.kind); ++axis) {
      Dof dof;
      dof.kind = joint.kind == JointKind::revolute    ? DofKind::revolute
                 : joint.kind == JointKind::prismatic ? DofKind::prismatic
                                                      : DofKind::ball;
      dof.parent = last_dof_[child];
      dof.base = above;
      dof.body = joint.child;
      dof.joint = j;
      last_dof_[child] = velocities();
      dofs_.push_back(dof);
      tree_of_dof_.push_back(int(trees_.size()) - 1);
    }
    if (last_dof_[child] >= 0) {
      tree_of_body_[child] = tree_of_dof_[std::size_t(last_dof_[child])];
      parts_.back().joints.push_back(j);
      parts_.back().bodies.push_back(joint.child);
    }
    const std::vector<int>& below = joints_below_[child];
    waiting.insert(waiting.end(), below.rbegin(), below.rend());
  }
}

/// The root that a body hangs on: a free body b, as b, or a joint j whose parent does not move, as
/// bodies() + j. -1 for a fixed body, the world, and joints in a ring.
int Multibody::seed_of(int body) const {
  for (int links = 0; body >= 0 && links <= joints(); ++links) {
    if (bodies_[std::size_t(body)].fixed) return -1;
    const int j = parent_joint_[std::size_t(body)];
    if (j < 0) return body;
    body = joints_[std::size_t(j)].parent;
    if (body < 0 || bodies_[std::size_t(body)].fixed) return bodies() + j;
  }
  return -1;
}

void Multibody::grow(const std::vector<int>& seeds) {
  const int first = velocities();
  trees_.push_back({first, 0, false, 0});
  parts_.emplace_back();
  for (const int seed : seeds) {
    if (seed >= bodies()) {
      add_joints_below({seed - bodies()});
      continue;
    }
    parts_.back().roots.push_back(seed);
    parts_.back().bodies.push_back(seed);
    add_free_dofs(seed);
    last_dof_[std::size_t(seed)] = velocities() - 1;
    tree_of_body_[std::size_t(seed)] = int(trees_.size()) - 1;
    add_joints_below(joints_below_[std::size_t(seed)]);
  }
  Tree& tree = trees_.back();
  tree.count = velocities() - first;
  tree.single = parts_.back().bodies.size() == 1 && parts_.back().roots.size() == 1;
  if (tree.count > 0) return;
  trees_.pop_back();
  parts_.pop_back();
}

void Multibody::build_trees() {
  // Bodies on different joints of the world, or of a fixed body, do not feel each other: a seed for
  // each, and one for each free body. Loops join their trees.
  std::vector<int> seeds;
  for (int j = 0; j < joints(); ++j) {
    const int parent = joints_[std::size_t(j)].parent;
    if (parent < 0) seeds.push_back(bodies() + j);
    if (parent >= 0) joints_below_[std::size_t(parent)].push_back(j);
  }
  for (int b = 0; b < bodies(); ++b) {
    if (bodies_[std::size_t(b)].fixed) {
      for (const int j : joints_below_[std::size_t(b)]) seeds.push_back(bodies() + j);
    } else if (parent_joint_[std::size_t(b)] < 0) {
      seeds.push_back(b);
    }
  }
  std::vector<int> first_of(std::size_t(bodies() + joints()));  // seed of the same tree
  std::iota(first_of.begin(), first_of.end(), 0);
  const auto first = [&](int seed) {
    while (first_of[std::size_t(seed)] != seed) seed = first_of[std::size_t(seed)];
    return seed;
  };
  for (const LoopDescription& loop : loops_) {
    const int a = seed_of(loop.a), b = seed_of(loop.b);
    if (a >= 0 && b >= 0) first_of[std::size_t(first(b))] = first(a);
  }
  for (const JointDescription& joint : joints_) {
    if (joint.leader < 0) continue;
    const int a = seed_of(joint.child), b = seed_of(joints_[std::size_t(joint.leader)].child);
    if (a >= 0 && b >= 0) first_of[std::size_t(first(b))] = first(a);
  }
  std::vector<char> has_grown(first_of.size(), 0);
  for (const int seed : seeds) {
    if (has_grown[std::size_t(first(seed))]) continue;
    has_grown[std::size_t(first(seed))] = 1;
    std::vector<int> same;
    std::copy_if(seeds.begin(), seeds.end(), std::back_inserter(same),
                 [&](int other) { return first(other) == first(seed); });
    grow(same);
  }
  if (int(order_.size()) != joints()) {
    for (int j = 0; j < joints(); ++j)
      if (std::find(order_.begin(), order_.end(), j) == order_.end())
        throw InputError("joint \"" + joints_[std::size_t(j)].name + "\"", "parent",
                         bodies_[std::size_t(joints_[std::size_t(j)].parent)].name,
                         "a body that does not hang on the joint's own child: joints in a ring");
  }
  for (std::size_t l = 0; l < loops_.size(); ++l) {
    const LoopDescription& loop = loops_[l];
    const auto tree_of_end = [this](int body) { return body < 0 ? -1 : tree_of(body); };
    const auto last_dof_of = [this](int body) {
      return body < 0 ? -1 : last_dof_[std::size_t(body)];
    };
    if (last_dof_of(loop.a) == last_dof_of(loop.b))
      throw InputError("loop \"" + loop.name + "\"", "bodies", "",
                       "two bodies that move against each other");
    const int tree = std::max(tree_of_end(loop.a), tree_of_end(loop.b));
    parts_[std::size_t(tree)].loops.push_back(int(l));
    trees_[std::size_t(tree)].loop_rows += count_loop_rows(loop.kind);
    trees_[std::size_t(tree)].single = false;
  }
  for (int j = 0; j < joints(); ++j) {
    if (joints_[std::size_t(j)].leader < 0) continue;
    const int tree = tree_of(joints_[std::size_t(j)].child);
    parts_[std::size_t(tree)].followers.push_back(j);
    ++trees_[std::size_t(tree)].loop_rows;
    trees_[std::size_t(tree)].single = false;
  }
}

void Multibody::loops(const Tree& tree, Eigen::MatrixXd& jacobian, Eigen::VectorXd& opening) const {
  jacobian.setZero(tree.loop_rows, tree.count);
  opening.setZero(tree.loop_rows);
  int row = 0;
  for (const int l : parts(tree).loops) {
    const LoopDescription& loop = loops_[std::size_t(l)];
    const Eigen::Isometry3d a = pose_or_world(loop.a) * loop_frames_[std::size_t(l)].in_a;
    const Eigen::Isometry3d b = pose_or_world(loop.b) * loop_frames_[std::size_t(l)].in_b;
    // Velocity of b against a at the anchor of b, linear and angular, along the axes of a.
    Eigen::MatrixXd relative = Eigen::MatrixXd::Zero(6, tree.count);
    Eigen::MatrixXd sizes = Eigen::MatrixXd::Zero(2, tree.count);  // of what it is made of
    for (const auto& [body, sign] : {std::pair(loop.a, -1.), std::pair(loop.b, 1.)}) {
      if (body < 0) continue;
      for (int d = last_dof_[std::size_t(body)]; d >= 0; d = dofs_[std::size_t(d)].parent) {
        const SpatialVector own = motion(dofs_[std::size_t(d)], b.translation());
        relative.col(d - tree.first).head<3>() += sign * (a.linear().transpose() * own.linear);
        relative.col(d - tree.first).tail<3>() += sign * (a.linear().transpose() * own.angular);
        sizes.col(d - tree.first) += Eigen::Vector2d(own.linear.norm(), own.angular.norm());
      }
    }
    // A direction in which nothing moves but by rounding must not look like one that is held.
    constexpr double kRounding = 1e-12;
    for (int i = 0; i < 6; ++i)
      for (Eigen::Index d = 0; d < tree.count; ++d)
        if (std::abs(relative(i, d)) <= kRounding * sizes(i / 3, d)) relative(i, d) = 0;
    const Eigen::Isometry3d open = a.inverse() * b;
    Eigen::Matrix<double, 6, 1> by;
    by.head<3>() = open.translation();
    const Eigen::AngleAxisd turn(open.linear());
    by.tail<3>() = loop.kind == JointKind::revolute
                       ? Eigen::Vector3d::UnitZ().cross(open.linear().col(2)).eval()
                       : (turn.angle() * turn.axis()).eval();
    for (int i = 0; i < 6; ++i) {
      if (!is_held(loop.kind, i)) continue;
      jacobian.row(row) = relative.row(i);
      opening[row++] = by[i];
    }
  }
  for (const int j : parts(tree).followers) {
    const JointDescription& joint = joints_[std::size_t(j)];
    const int leader = joint.leader;
    jacobian(row, velocity_of_joint(j) - tree.first) = 1;
    jacobian(row, velocity_of_joint(leader) - tree.first) -= joint.ratio;
    opening[row++] = joint_position(j) - joint.start -
                     joint.ratio * (joint_position(leader) - joints_[std::size_t(leader)].start);
  }
}

bool Multibody::are_joined(int body, int other) const {
  const auto holds = [this](int child, int parent) {
    const int j = parent_joint_[std::size_t(child)];
    return j >= 0 && joints_[std::size_t(j)].parent == parent;
  };
  const bool in_loop = std::any_of(loops_.begin(), loops_.end(), [&](const LoopDescription& loop) {
    return (loop.a == body && loop.b == other) || (loop.a == other && loop.b == body);
  });
  return last_dof_[std::size_t(body)] == last_dof_[std::size_t(other)] || holds(body, other) ||
         holds(other, body) || in_loop;
}

/// Sets the pose of a child and its joint's axes from the pose of its parent and the joint's
/// position.
void Multibody::place_child(int j) {
  const JointDescription& joint = joints_[std::size_t(j)];
  const Eigen::Isometry3d parent = pose_or_world(joint.parent);
  const Eigen::Vector3d& anchor = anchor_in_parent_[std::size_t(j)];
  const Eigen::Vector3d& axis = axis_in_parent_[std::size_t(j)];
  const double moved = joint_positions_[std::size_t(j)] - joint.start;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (joint.kind == JointKind::revolute)
    motion = Eigen::Translation3d(anchor) * Eigen::AngleAxisd(moved, axis) *
             Eigen::Translation3d(-anchor);
  if (joint.kind == JointKind::ball)
    motion =
        Eigen::Translation3d(anchor) * ball_turns_[std::size_t(j)] * Eigen::Translation3d(-anchor);
  if (joint.kind == JointKind::prismatic) motion.translation() = moved * axis;
  poses_[std::size_t(joint.child)] = parent * motion * child_in_parent_[std::size_t(j)];
  for (int k = 0; k < count_velocities(joint.kind); ++k) {
    Dof& dof = dofs_[std::size_t(joint_dofs_[std::size_t(j)] + k)];
    dof.axis = joint.kind == JointKind::ball ? parent.linear().col(k).eval()
                                             : (parent.linear() * axis).eval();
    dof.origin_m = parent * anchor;
  }
}

/// Sets the poses of all jointed bodies of a tree and the axes of all degrees of freedom, from the
/// poses of its free bodies and the positions of its joints.
void Multibody::place_children(const Tree& tree) {
  for (const int j : parts(tree).joints) place_child(j);
  for (const int root : parts(tree).roots) {
    const Eigen::Vector3d center = center_of_mass_m(root);
    for (int d = tree.first; d < tree.first + tree.count; ++d) {
      Dof& dof = dofs_[std::size_t(d)];
      if (dof.body == root && dof.joint < 0) dof.origin_m = center;
    }
  }
}

Multibody::SpatialVector Multibody::motion(const Dof& dof, const Eigen::Vector3d& reference) const {
  if (!is_angular(dof)) return {Eigen::Vector3d::Zero(), dof.axis};
  return {dof.axis, dof.axis.cross(reference - dof.origin_m)};
}

Multibody::SpatialVector Multibody::spatial_velocity(int body,
                                                     const Eigen::Vector3d& reference) const {
  SpatialVector velocity;
  for (int d = last_dof_[std::size_t(body)]; d >= 0; d = dofs_[std::size_t(d)].parent)
    velocity += motion(dofs_[std::size_t(d)], reference) * velocity_[d];
  return velocity;
}

Eigen::Vector3d Multibody::velocity_at(int body, const Eigen::Vector3d& point_m) const {
  return spatial_velocity(body, point_m).linear;
}

Eigen::Vector3d Multibody::angular_velocity(int body) const {
  return spatial_velocity(body, Eigen::Vector3d::Zero()).angular;
}

double Multibody::joint_position(int j) const {
  if (joints_[std::size_t(j)].kind == JointKind::ball)
    return Eigen::AngleAxisd(ball_turns_[std::size_t(j)]).angle();
  return joint_positions_[std::size_t(j)];
}

double Multibody::joint_velocity(int j) const {
  const int dof = joint_dofs_[std::size_t(j)];
  if (joints_[std::size_t(j)].kind == JointKind::ball) return velocity_.segment<3>(dof).norm();
  return dof < 0 ? 0 : velocity_[dof];
}

Eigen::Matrix3d Multibody::world_inertia(int body) const {
  const Eigen::Matrix3d turn = poses_[std::size_t(body)].linear();
  return turn * bodies_[std::size_t(body)].mass.inertia_kg_m2 * turn.transpose();
}

Multibody::SpatialInertia Multibody::inertia_about(int body,
                                                   const Eigen::Vector3d& reference) const {
  const double mass = bodies_[std::size_t(body)].mass.mass_kg;
  const Eigen::Vector3d arm = center_of_mass_m(body) - reference;
  SpatialInertia result;
  result.mass = mass;
  result.moment = mass * arm;
  result.inertia = world_inertia(body) +
                   mass * (arm.squaredNorm() * Eigen::Matrix3d::Identity() - arm * arm.transpose());
  return result;
}

void Multibody::mass_matrix(const Tree& tree, Eigen::Ref<Eigen::MatrixXd> matrix) const {
  if (tree.single) {
    const int body = dofs_[std::size_t(tree.first)].body;
    matrix.setZero();
    matrix.topLeftCorner<3, 3>().diagonal().setConstant(bodies_[std::size_t(body)].mass.mass_kg);
    matrix.bottomRightCorner<3, 3>() = world_inertia(body);
    return;
  }
  const Eigen::Vector3d reference = dofs_[std::size_t(tree.first)].origin_m;
  std::vector<SpatialInertia> composite(std::size_t(tree.count));
  for (const int b : parts(tree).bodies)
    composite[std::size_t(last_dof_[std::size_t(b)] - tree.first)] += inertia_about(b, reference);
  matrix.setZero();
  for (int i = tree.count - 1; i >= 0; --i) {
    const Dof& dof = dofs_[std::size_t(tree.first + i)];
    if (dof.parent >= 0)
      composite[std::size_t(dof.parent - tree.first)] += composite[std::size_t(i)];
    const SpatialVector force = composite[std::size_t(i)] * motion(dof, reference);
    for (int d = tree.first + i; d >= 0; d = dofs_[std::size_t(d)].parent) {
      const int other = d - tree.first;
      matrix(i, other) = matrix(other, i) = motion(dofs_[std::size_t(d)], reference).dot(force);
    }
    matrix(i, i) += rotor_inertia(dof);
  }
}

/// A joint of a massless body must move some mass all the same. @throws InputError
void Multibody::require_masses() const {
  for (const Tree& tree : trees_) {
    const auto is_massless = [this](int b) { return bodies_[std::size_t(b)].massless; };
    const std::vector<int>& own = parts(tree).bodies;
    if (std::none_of(own.begin(), own.end(), is_massless)) continue;
    const std::string& name =
        bodies_[std::size_t(*std::find_if(own.begin(), own.end(), is_massless))].name;
    for (const int root : parts(tree).roots)
      if (is_massless(root))
        throw InputError("body \"" + name + "\"", "mass", "0", "> 0 for a body without a joint");
    Eigen::MatrixXd matrix(tree.count, tree.count);
    mass_matrix(tree, matrix);
    const Eigen::VectorXd scale = matrix.diagonal().cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd scaled = scale.asDiagonal() * matrix * scale.asDiagonal();
    // The least eigenvalue of the scaled matrix has to be larger.
    constexpr double kLeast = 1e-12;
    scaled.diagonal().array() -= kLeast;
    if (!scaled.allFinite() || !internal::factorise_cholesky(scaled))
      throw InputError("body \"" + name + "\"", "mass", "0",
                       "bodies with mass on it, so that each joint about it moves some of its own");
  }
}

/// Rate of change of a degree of freedom's motion vector about a resting reference point.
/// @param base  velocity of the body that carries its axis
Multibody::SpatialVector Multibody::motion_rate(const Dof& dof, const Eigen::Vector3d& reference,
                                                const SpatialVector& base) const {
  SpatialVector rate;
  if (dof.kind == DofKind::free_linear) return rate;
  if (dof.kind == DofKind::free_angular) {  // about the centre, which moves
    rate.linear = -dof.axis.cross(velocity_.segment<3>(dof.base));
    return rate;
  }
  const Eigen::Vector3d turning = base.angular.cross(dof.axis);
  if (dof.kind == DofKind::prismatic) {
    rate.linear = turning;
    return rate;
  }
  const Eigen::Vector3d arm = dof.origin_m - reference;
  rate.angular = turning;
  rate.linear = -turning.cross(arm) - dof.axis.cross(base.linear + base.angular.cross(arm));
  return rate;
}

void Multibody::momentum(const Tree& tree, const Eigen::Vector3d& gravity_m_per_s2,
                         Eigen::Ref<Eigen::VectorXd> result,
                         Eigen::Ref<Eigen::VectorXd> rate) const {
  const Eigen::Vector3d reference = dofs_[std::size_t(tree.first)].origin_m;
  std::vector<SpatialVector> velocity(std::size_t(tree.count)), momentum(velocity), load(velocity);
  for (int i = 0; i < tree.count; ++i) {
    const Dof& dof = dofs_[std::size_t(tree.first + i)];
    if (dof.parent >= 0) velocity[std::size_t(i)] = velocity[std::size_t(dof.parent - tree.first)];
    velocity[std::size_t(i)] += motion(dof, reference) * velocity_[tree.first + i];
  }
  for (const int b : parts(tree).bodies) {
    const std::size_t i = std::size_t(last_dof_[std::size_t(b)] - tree.first);
    const SpatialInertia inertia = inertia_about(b, reference);
    momentum[i] += inertia * velocity[i];
    load[i] += {inertia.moment.cross(gravity_m_per_s2), (inertia.mass * gravity_m_per_s2).eval()};
  }
  for (int i = tree.count - 1; i >= 0; --i) {
    const Dof& dof = dofs_[std::size_t(tree.first + i)];
    const SpatialVector base =
        dof.base >= 0 ? velocity[std::size_t(dof.base - tree.first)] : SpatialVector{};
    const SpatialVector own = motion(dof, reference);
    result[i] = own.dot(momentum[std::size_t(i)]) + rotor_inertia(dof) * velocity_[tree.first + i];
    rate[i] = own.dot(load[std::size_t(i)]) +
              motion_rate(dof, reference, base).dot(momentum[std::size_t(i)]);
    if (dof.parent < 0) continue;
    momentum[std::size_t(dof.parent - tree.first)] += momentum[std::size_t(i)];
    load[std::size_t(dof.parent - tree.first)] += load[std::size_t(i)];
  }
}

void Multibody::passive_forces(const Tree& tree, const Eigen::Vector3d& gravity_m_per_s2,
                               Eigen::Ref<Eigen::VectorXd> forces) const {
  if (tree.single) {
    const int body = dofs_[std::size_t(tree.first)].body;
    forces.head<3>() = bodies_[std::size_t(body)].mass.mass_kg * gravity_m_per_s2;
    forces.tail<3>().setZero();
    return;
  }
  const Eigen::Vector3d reference = dofs_[std::size_t(tree.first)].origin_m;
  // Velocity of the body that each degree of freedom moves, and its acceleration when all
  // generalised accelerations are zero.
  std::vector<SpatialVector> velocity(std::size_t(tree.count)), acceleration(velocity),
      load(velocity);
  for (int i = 0; i < tree.count; ++i) {
    const Dof& dof = dofs_[std::size_t(tree.first + i)];
    SpatialVector above;
    if (dof.parent >= 0) {
      above = velocity[std::size_t(dof.parent - tree.first)];
      acceleration[std::size_t(i)] = acceleration[std::size_t(dof.parent - tree.first)];
    }
    const double speed = velocity_[tree.first + i];
    const SpatialVector base =
        dof.base >= 0 ? velocity[std::size_t(dof.base - tree.first)] : SpatialVector{};
    velocity[std::size_t(i)] = above;
    velocity[std::size_t(i)] += motion(dof, reference) * speed;
    acceleration[std::size_t(i)] += motion_rate(dof, reference, base) * speed;
  }
  for (const int b : parts(tree).bodies) {
    const std::size_t i = std::size_t(last_dof_[std::size_t(b)] - tree.first);
    const SpatialInertia inertia = inertia_about(b, reference);
    const SpatialVector momentum = inertia * velocity[i];
    SpatialVector force = inertia * acceleration[i];
    force.linear += velocity[i].angular.cross(momentum.linear);
    force.angular +=
        velocity[i].angular.cross(momentum.angular) + velocity[i].linear.cross(momentum.linear);
    force.linear -= inertia.mass * gravity_m_per_s2;
    force.angular -= inertia.moment.cross(gravity_m_per_s2);
    load[i] += force;
  }
  for (int i = tree.count - 1; i >= 0; --i) {
    const Dof& dof = dofs_[std::size_t(tree.first + i)];
    forces[i] = -motion(dof, reference).dot(load[std::size_t(i)]);
    if (dof.parent >= 0) load[std::size_t(dof.parent - tree.first)] += load[std::size_t(i)];
  }
}

void Multibody::add_contact_jacobian(int body, const Eigen::Vector3d& point_m,
                                     const Eigen::Matrix3d& axes, double sign,
                                     Eigen::Ref<Eigen::MatrixXd> rows) const {
  for (int d = last_dof_[std::size_t(body)]; d >= 0; d = dofs_[std::size_t(d)].parent) {
    const Dof& dof = dofs_[std::size_t(d)];
    const int column = d - trees_[std::size_t(tree_of_dof_[std::size_t(d)])].first;
    const SpatialVector at_point = motion(dof, point_m);
    rows(0, column) += sign * axes.col(2).dot(at_point.linear);
    rows(1, column) += sign * axes.col(0).dot(at_point.linear);
    rows(2, column) += sign * axes.col(1).dot(at_point.linear);
    rows(3, column) += sign * axes.col(2).dot(at_point.angular);
  }
}

void Multibody::add_force(int body, const Eigen::Vector3d& point_m, const Eigen::Vector3d& force_N,
                          const Eigen::Vector3d& torque_Nm,
                          Eigen::Ref<Eigen::VectorXd> forces) const {
  for (int d = last_dof_[std::size_t(body)]; d >= 0; d = dofs_[std::size_t(d)].parent) {
    const Dof& dof = dofs_[std::size_t(d)];
    forces[d - trees_[std::size_t(tree_of_dof_[std::size_t(d)])].first] +=
        motion(dof, point_m).dot({torque_Nm, force_N});
  }
}

/// The angular velocity w, world axes, with which a free body turns for a step: the mean of those
/// at its start and end, at constant angular momentum. In the body's frame, where l = R^T L turns
/// by the opposite angle to l', w = I^-1 (l + l')/2. A turn about w changes no component of l along
/// w, so that the change of energy, w . (l' - l), is zero.
Eigen::Vector3d Multibody::middle_spin(int body, const Eigen::Vector3d& angular_momentum_N_m_s,
                                       double time_step_s) const {
  const Eigen::Matrix3d turn = poses_[std::size_t(body)].linear();
  Eigen::Matrix3d factor = bodies_[std::size_t(body)].mass.inertia_kg_m2;
  internal::factorise_cholesky(factor);
  const auto spin_of = [&factor](Eigen::Vector3d momentum) {
    internal::solve_cholesky(factor, momentum);
    return momentum;
  };
  const Eigen::Vector3d start = turn.transpose() * angular_momentum_N_m_s;
  Eigen::Vector3d end = start, spin = spin_of(start);
  // Contracts by half the angle of the step; of turns beyond that the energy is kept less exactly.
  constexpr int kMostRounds = 50;
  double last = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds; ++round) {
    const double speed = spin.norm();
    if (!(speed > 0)) break;
    end = Eigen::AngleAxisd(-time_step_s * speed, spin / speed) * start;
    const Eigen::Vector3d next = spin_of((start + end) / 2);
    const double change = (next - spin).norm();
    spin = next;
    if (change <= 4 * std::numeric_limits<double>::epsilon() * speed || change >= last) break;
    last = change;
  }
  return turn * spin;
}

void Multibody::integrate(double time_step_s) {
  for (const Tree& tree : trees_) integrate(tree, time_step_s);
}

void Multibody::integrate(const Tree& tree, double time_step_s,
                          const Eigen::Matrix<double, 6, 1>& change_N_s) {
  for (const int root : parts(tree).roots) {
    const int first = last_dof_[std::size_t(root)] - 5;
    Eigen::Isometry3d& pose = poses_[std::size_t(root)];
    const MassProperties& mass = bodies_[std::size_t(root)].mass;
    const Eigen::Vector3d center = center_of_mass_m(root);
    auto velocity = velocity_.segment<3>(first), spin = velocity_.segment<3>(first + 3);
    const Eigen::Vector3d angular_momentum = world_inertia(root) * spin;
    const Eigen::Vector3d turning =
        tree.single ? middle_spin(root, angular_momentum - change_N_s.tail<3>() / 2, time_step_s)
                    : spin.eval();
    const double speed = turning.norm();
    if (speed > 0) {
      const Eigen::Quaterniond turned = Eigen::AngleAxisd(time_step_s * speed, turning / speed) *
                                        Eigen::Quaterniond(pose.linear());
      pose.linear() = turned.normalized().toRotationMatrix();
    }
    const Eigen::Vector3d mean = velocity - change_N_s.head<3>() / (2 * mass.mass_kg);
    pose.translation() = center + time_step_s * mean - pose.linear() * mass.center_m;
    if (!tree.single) continue;
    Eigen::Matrix3d inertia = world_inertia(root);
    internal::factorise_cholesky(inertia);
    spin = angular_momentum;
    internal::solve_cholesky(inertia, spin);
  }
  turn_joints(tree, time_step_s);
  place_children(tree);
}

void Multibody::turn_joints(const Tree& tree, double time_step_s) {
  for (const int j : parts(tree).joints) {
    const int first = joint_dofs_[std::size_t(j)];
    if (first < 0) continue;
    if (joints_[std::size_t(j)].kind != JointKind::ball) {
      joint_positions_[std::size_t(j)] += time_step_s * velocity_[first];
      continue;
    }
    const Eigen::Vector3d spin = velocity_.segment<3>(first);
    const double speed = spin.norm();
    if (!(speed > 0)) continue;
    Eigen::Quaterniond& turn = ball_turns_[std::size_t(j)];
    turn = (Eigen::AngleAxisd(time_step_s * speed, spin / speed) * turn).normalized();
  }
}

Multibody::Placement Multibody::placement(const Tree& tree) const {
  Placement result;
  for (const int root : parts(tree).roots) result.roots.push_back(poses_[std::size_t(root)]);
  for (const int j : parts(tree).joints) {
    result.joint_positions.push_back(joint_positions_[std::size_t(j)]);
    result.ball_turns.push_back(ball_turns_[std::size_t(j)]);
  }
  return result;
}

void Multibody::place(const Tree& tree, const Placement& placement) {
  const Parts& own = parts(tree);
  for (std::size_t i = 0; i < own.roots.size(); ++i)
    poses_[std::size_t(own.roots[i])] = placement.roots[i];
  for (std::size_t i = 0; i < own.joints.size(); ++i) {
    joint_positions_[std::size_t(own.joints[i])] = placement.joint_positions[i];
    ball_turns_[std::size_t(own.joints[i])] = placement.ball_turns[i];
  }
  place_children(tree);
}

double Multibody::kinetic_energy_J() const {
  double energy = 0;
  for (int b = 0; b < bodies(); ++b) {
    if (!moves(b)) continue;
    const SpatialVector velocity = spatial_velocity(b, center_of_mass_m(b));
    energy += (bodies_[std::size_t(b)].mass.mass_kg * velocity.linear.squaredNorm() +
               velocity.angular.dot(world_inertia(b) * velocity.angular)) /
              2;
  }
  for (std::size_t d = 0; d < dofs_.size(); ++d)
    energy += rotor_inertia(dofs_[d]) * velocity_[Eigen::Index(d)] * velocity_[Eigen::Index(d)] / 2;
  return energy;
}

double Multibody::potential_energy_J(const Eigen::Vector3d& gravity_m_per_s2) const {
  double energy = 0;
  for (int b = 0; b < bodies(); ++b)
    if (moves(b))
      energy -= bodies_[std::size_t(b)].mass.mass_kg * gravity_m_per_s2.dot(center_of_mass_m(b));
  return energy;
}

Eigen::Vector3d Multibody::linear_momentum_N_s() const {
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  for (int b = 0; b < bodies(); ++b)
    if (moves(b))
      momentum += bodies_[std::size_t(b)].mass.mass_kg * velocity_at(b, center_of_mass_m(b));
  return momentum;
}

Eigen::Vector3d Multibody::angular_momentum_N_m_s() const {
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  for (int b = 0; b < bodies(); ++b) {
    if (!moves(b)) continue;
    const Eigen::Vector3d center = center_of_mass_m(b);
    const SpatialVector velocity = spatial_velocity(b, center);
    momentum += world_inertia(b) * velocity.angular +
                center.cross(bodies_[std::size_t(b)].mass.mass_kg * velocity.linear);
  }
  return momentum;
}

}  // namespace softfinger
