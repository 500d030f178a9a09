#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <string>
#include <vector>

#include "softfinger/dynamics/bodies/mass_properties.h"

namespace softfinger {

/// A rigid body at the start.
struct BodyDescription {
  std::string name;
  MassProperties mass;  ///< ignored for a fixed body
  bool fixed = false;   ///< to the world
  /// A link between joints. What hangs on it must give each of its joints something to move.
  bool massless = false;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  /// Velocities of a free body's centre of mass along the world's axes. Ignored for bodies on
  /// joints, which have the velocities of their joints.
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity_rad_per_s = Eigen::Vector3d::Zero();
};

enum class JointKind { fixed, revolute, prismatic, ball };

/// A joint holds the child on its parent. Anchor and axis in world coordinates at the start, where
/// the joint's position is `start`. A ball joint lets the child turn about its anchor in every
/// direction; axis, start and limits are not used.
struct JointDescription {
  std::string name;
  int parent = -1;  ///< a body, -1: the world
  int child = -1;
  JointKind kind = JointKind::fixed;
  Eigen::Vector3d anchor_m = Eigen::Vector3d::Zero();       ///< revolute and ball only
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();          ///< any length
  double start = 0;                                         ///< rad or m
  double lower = -std::numeric_limits<double>::infinity();  ///< rad or m; lower <= start <= upper
  double upper = std::numeric_limits<double>::infinity();
  /// The inertia of a motor that turns with the joint, times its gear ratio squared; kg m2, or kg
  /// for a prismatic joint. It counts for the joint's own velocity alone (armature). >= 0
  double rotor_inertia = 0;
  /// The largest effort of dry friction, of a hinge or slide: below it the joint holds, above it
  /// slides against it; N m or N. >= 0
  double dry_friction = 0;
  /// The joint that this one follows, as gears or a linkage make it: it moves by `ratio` times what
  /// that one moves, from the start on. Both are hinges or slides. -1: none
  int leader = -1;
  double ratio = 1;  ///< rad/rad, m/m, rad/m or m/rad
};

/// Holds two bodies of a closed chain together, as the joint of that kind would: the chain's bodies
/// hang on joints, and this closes it. Anchor and axis in world coordinates at the start, where it
/// is closed.
struct LoopDescription {
  std::string name;
  int a = -1, b = -1;  ///< bodies, -1: the world
  JointKind kind = JointKind::ball;
  Eigen::Vector3d anchor_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< revolute and prismatic only; any length
};

/// Rigid bodies, free, fixed, or in articulated chains and trees. State, kinematics, mass matrix.
///
/// Velocities are generalised: six of a free body (of its centre of mass, then angular, both along
/// world axes), one of a revolute or prismatic joint, three of a ball joint (angular velocity of
/// the child against its parent, along the parent's axes). Bodies that move each other by joints
/// make a tree, whose velocities are contiguous; its mass matrix is that of the composite bodies
/// (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 6), its bias forces come from the
/// recursive Newton-Euler equations (chapter 5), all in world axes.
///
/// `integrate` turns a single free body by an implicit rule of second order, for less than a radian
/// per step. Without forces it keeps linear and angular momentum and energy to round-off. Those of
/// a tree are kept to first order in the time step; smooth_motion.h moves trees in second order.
class Multibody {
 public:
  /// @throws InputError for a body whose mass or inertia is impossible (require_physical), a joint
  /// or loop between unknown bodies, a body with two parents, joints in a ring, an axis without
  /// length, limits that exclude the start, a loop between bodies that do not move, a joint that
  /// moves no mass.
  Multibody(std::vector<BodyDescription> bodies, std::vector<JointDescription> joints,
            std::vector<LoopDescription> loops = {});

  int bodies() const { return int(bodies_.size()); }
  int joints() const { return int(joints_.size()); }
  int velocities() const { return int(dofs_.size()); }
  const BodyDescription& body(int b) const { return bodies_[std::size_t(b)]; }
  const JointDescription& joint(int j) const { return joints_[std::size_t(j)]; }
  bool moves(int body) const { return last_dof_[std::size_t(body)] >= 0; }
  /// Whether a joint, a loop, or a chain of fixed joints holds the two together: they never touch.
  bool are_joined(int body, int other) const;

  const Eigen::Isometry3d& pose(int body) const { return poses_[std::size_t(body)]; }
  Eigen::Vector3d center_of_mass_m(int b) const {
    return poses_[std::size_t(b)] * bodies_[std::size_t(b)].mass.center_m;
  }
  Eigen::Vector3d velocity_at(int body, const Eigen::Vector3d& point_m) const;
  Eigen::Vector3d angular_velocity(int body) const;
  /// A ball joint has the angle by which it has turned since the start, and its angular speed.
  double joint_position(int j) const;
  double joint_velocity(int j) const;
  /// Index of the velocity of a revolute or prismatic joint, -1 for others.
  int velocity_of_joint(int j) const {
    return joints_[std::size_t(j)].kind == JointKind::ball ? -1 : joint_dofs_[std::size_t(j)];
  }

  const Eigen::VectorXd& velocity() const { return velocity_; }
  void set_velocity(const Eigen::VectorXd& velocity) { velocity_ = velocity; }

  /// Bodies that feel each other through joints and loops.
  struct Tree {
    int first = 0, count = 0;  ///< of its velocities
    bool single = false;       ///< a free body without joints
    int loop_rows = 0;         ///< equations that its loops impose on its velocities
  };
  const std::vector<Tree>& trees() const { return trees_; }
  /// The tree that moves this body, -1 for a body that does not move.
  int tree_of(int body) const { return tree_of_body_[std::size_t(body)]; }

  /// M of one tree, symmetric positive definite, count x count, at the current pose.
  void mass_matrix(const Tree& tree, Eigen::Ref<Eigen::MatrixXd> matrix) const;
  /// Generalised forces that gravity and the current velocities exert on a tree: M dv/dt = this +
  /// joint efforts + contacts.
  void passive_forces(const Tree& tree, const Eigen::Vector3d& gravity_m_per_s2,
                      Eigen::Ref<Eigen::VectorXd> forces) const;

  /// Generalised momentum M v of a tree, and its rate of change by gravity and the current
  /// velocities: d(M v)/dt = rate + joint efforts + contacts. In coordinates the rate is the
  /// derivative of kinetic minus potential energy. Costs less than M.
  void momentum(const Tree& tree, const Eigen::Vector3d& gravity_m_per_s2,
                Eigen::Ref<Eigen::VectorXd> momentum, Eigen::Ref<Eigen::VectorXd> rate) const;

  /// Adds `sign` times the Jacobian of the velocity at a point along three axes, and of the angular
  /// velocity about the third, to four rows: (axis 3, axis 1, axis 2, about axis 3), columns of the
  /// body's tree.
  void add_contact_jacobian(int body, const Eigen::Vector3d& point_m, const Eigen::Matrix3d& axes,
                            double sign, Eigen::Ref<Eigen::MatrixXd> rows) const;

  /// G and c of a tree's loops: they stay closed with G v = 0, and c, in m and rad, is by how much
  /// they are open. A ball has three rows, a revolute or prismatic loop five, a fixed one six. A
  /// joint that follows another has one.
  void loops(const Tree& tree, Eigen::MatrixXd& jacobian, Eigen::VectorXd& opening) const;

  /// Adds the generalised forces of a force at a point and a torque, world axes.
  void add_force(int body, const Eigen::Vector3d& point_m, const Eigen::Vector3d& force_N,
                 const Eigen::Vector3d& torque_Nm, Eigen::Ref<Eigen::VectorXd> forces) const;

  /// Moves all bodies by their velocities for a time.
  void integrate(double time_step_s);
  /// Moves the bodies of one tree. @param change_N_s  of the momentum within the time, for a single
  /// free body: linear, then angular, both parts of what its velocity is at the end. It turns with
  /// the mean of its angular momentum.
  void integrate(
      const Tree& tree, double time_step_s,
      const Eigen::Matrix<double, 6, 1>& change_N_s = Eigen::Matrix<double, 6, 1>::Zero());

  /// The places of the bodies of a tree.
  struct Placement {
    std::vector<Eigen::Isometry3d> roots;  ///< free bodies
    std::vector<double> joint_positions;
    std::vector<Eigen::Quaterniond> ball_turns;
  };
  Placement placement(const Tree& tree) const;
  void place(const Tree& tree, const Placement& placement);
  void set_velocity(const Tree& tree, const Eigen::Ref<const Eigen::VectorXd>& velocity) {
    velocity_.segment(tree.first, tree.count) = velocity;
  }

  double kinetic_energy_J() const;
  double potential_energy_J(const Eigen::Vector3d& gravity_m_per_s2) const;
  Eigen::Vector3d linear_momentum_N_s() const;
  Eigen::Vector3d angular_momentum_N_m_s() const;  ///< about the world's origin

 private:
  enum class DofKind { free_linear, free_angular, revolute, prismatic, ball };
  struct Dof {
    DofKind kind;
    int parent = -1;  ///< the next one towards the root
    int base = -1;    ///< the one that moves its axis; of free_angular: the first of its body
    int body = -1;    ///< the first one that it moves
    int joint = -1;
    Eigen::Vector3d axis = Eigen::Vector3d::Zero(), origin_m = Eigen::Vector3d::Zero();  ///< world
  };
  struct SpatialVector;
  struct SpatialInertia;

  struct Parts {
    std::vector<int> roots, joints, bodies;  ///< joints: parents first; bodies: all that move
    std::vector<int> loops;
    std::vector<int> followers;  ///< joints that follow others
  };

  bool is_angular(const Dof& dof) const {
    return dof.kind == DofKind::revolute || dof.kind == DofKind::free_angular ||
           dof.kind == DofKind::ball;
  }
  const Parts& parts(const Tree& tree) const {
    return parts_[std::size_t(tree_of_dof_[std::size_t(tree.first)])];
  }
  void check(int joint) const;
  void check(const LoopDescription& loop) const;
  void build_trees();
  int seed_of(int body) const;
  void require_masses() const;
  double rotor_inertia(const Dof& dof) const {
    return dof.joint < 0 ? 0 : joints_[std::size_t(dof.joint)].rotor_inertia;
  }
  void grow(const std::vector<int>& seeds);
  void add_joints_below(const std::vector<int>& joints);
  void add_free_dofs(int body);
  void place_child(int joint);
  Eigen::Isometry3d pose_or_world(int body) const {
    return body >= 0 ? poses_[std::size_t(body)] : Eigen::Isometry3d::Identity();
  }
  void place_children(const Tree& tree);
  void turn_joints(const Tree& tree, double time_step_s);
  Eigen::Matrix3d world_inertia(int body) const;
  Eigen::Vector3d middle_spin(int body, const Eigen::Vector3d& angular_momentum_N_m_s,
                              double time_step_s) const;
  SpatialVector motion_rate(const Dof& dof, const Eigen::Vector3d& reference,
                            const SpatialVector& base) const;
  SpatialVector motion(const Dof& dof, const Eigen::Vector3d& reference) const;
  SpatialInertia inertia_about(int body, const Eigen::Vector3d& reference) const;
  SpatialVector spatial_velocity(int body, const Eigen::Vector3d& reference) const;

  std::vector<BodyDescription> bodies_;
  std::vector<JointDescription> joints_;
  std::vector<LoopDescription> loops_;
  struct LoopFrames {
    Eigen::Isometry3d in_a, in_b;  ///< anchor, and axis as z
  };
  std::vector<LoopFrames> loop_frames_;
  std::vector<std::vector<int>> joints_below_;                      ///< per body
  std::vector<Eigen::Isometry3d> child_in_parent_;                  ///< per joint, at the start
  std::vector<Eigen::Vector3d> anchor_in_parent_, axis_in_parent_;  ///< per joint
  std::vector<int> order_;         ///< joints, parents before children
  std::vector<int> parent_joint_;  ///< per body, -1: none
  std::vector<Dof> dofs_;
  std::vector<int> last_dof_, tree_of_body_, joint_dofs_, tree_of_dof_;
  std::vector<Tree> trees_;
  std::vector<Parts> parts_;  ///< per tree
  std::vector<Eigen::Isometry3d> poses_;
  std::vector<double> joint_positions_;
  std::vector<Eigen::Quaterniond> ball_turns_;  ///< per joint, since the start, parent's axes
  Eigen::VectorXd velocity_;
};

}  // namespace softfinger
