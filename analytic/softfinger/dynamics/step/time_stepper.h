#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "softfinger/dynamics/bodies/constrained_mass.h"
#include "softfinger/dynamics/bodies/multibody.h"
#include "softfinger/dynamics/bodies/smooth_motion.h"
#include "softfinger/dynamics/contacts/contact_lcp.h"
#include "softfinger/dynamics/step/contact.h"

namespace softfinger {

/// Drives a joint: effort = stiffness (target - position) + damping (target velocity - velocity) +
/// feed-forward, within +-max_effort. Stiffness and damping act implicitly, at the end of the step:
/// no stiffness makes a step unstable. N m or N, rad or m.
struct Motor {
  int joint = -1;
  double stiffness = 0, damping = 0, feed_forward = 0;
  double max_effort = std::numeric_limits<double>::infinity();
  double target = 0, target_velocity = 0;
};

/// Pulls at a body from outside, world axes.
struct AppliedForce {
  int body = -1;
  Eigen::Vector3d point_in_body_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero(), torque_Nm = Eigen::Vector3d::Zero();
};

struct ContactWrench {
  double normal_force_N = 0, tangent_force_1_N = 0, tangent_force_2_N = 0, torque_Nm = 0;
};

struct StepResult {
  LcpResult lcp;
  int contacts = 0;             ///< rows of joints not counted
  int smooth_trees = 0;         ///< that moved in second order
  double restitution_used = 1;  ///< 1, or the part of it that makes no energy
  int motor_changes = 0;        ///< motors that met or left their limits within the step
  bool motors_agree = true;
  int load_iterations = 0;       ///< of e_n(P), faces' friction and P to agreement
  double load_disagreement = 0;  ///< of them at the end, relative
  double time_s = 0;             ///< at the end of the step
  bool done() const { return lcp.status == LcpStatus::solved; }
};

/// Time stepping of rigid bodies with contacts, joint limits and motors (Anitescu, Potra, Nonlinear
/// Dynamics 14, 1997): velocities and impulses at the end of a step solve one linear
/// complementarity problem for all contacts together,
///
///   M (v' - v) = dt (passive forces + motors) + J^T r,   0 <= P  compl.  n^T v' + gap/dt >= 0
///
/// with friction as in ContactLcp. Then the bodies move by v'; with gap/dt in the condition they
/// come just as far as they touch (Anitescu, Hart 2004). Bodies that do not feel each other,
/// through contacts or joints, are separate problems.
///
/// Closed loops are equations G v' + c/dt = 0 of the same problem, which bring back what they are
/// open by, c, and are eliminated from it (ConstrainedMass).
///
/// Restitution is Newton's: a contact that would close within the step at the speed s, before the
/// step, leaves with the impulse that turns s into e s, so that gravity's part of the step stays;
/// friction is that of the whole impulse. Impacts whose rebound would last fewer than eight steps
/// do not rebound. Where friction or several contacts together would make energy, as Newton's law
/// can, the step is solved again with half of all restitution, down to none. Bodies that touch
/// before an impact do not pass it on one by one: the last two balls of a cradle of three leave
/// together.
///
/// That is of first order in dt, and takes energy. Where no contact or limit of a problem carries
/// load, and its trees have no motors with stiffness or damping, which act implicitly, the trees
/// move in second order instead (SmoothMotion), unless that would close a gap: then v' stands, of
/// which the gaps know. So the energy of bodies that touch never grows, and that of bodies that do
/// not touch stays. Joint limits are contacts without friction. The dry friction of joints is part
/// of the same problem, too: an effort of at most that size which holds the joint where it can, and
/// else opposes its velocity.
///
/// The points of a flat face share its force as equal springs do, which give way a million times
/// less than the bodies. Rigid bodies leave open how much each bears, and with it the torque that a
/// pressed face holds. Where no rigid face slides that changes no motion, and there are no springs.
///
/// The friction of a soft face is one contact under the whole force that its points bear. It is
/// solved with that of the last step, and again with its own until both agree.
///
/// If a contact is elastic, the step uses its sliding velocity in place of its tangential velocity
/// J v':
///   J v' + C (r/dt - f)/dt,
/// C the compliance and f the wrench at the start. Implicit: no stiffness makes a step unstable.
///
/// Which motors are at their limits is found by trial: those that contradict the new velocities
/// change, at the end one by one, which terminates (Murty's principal pivoting on a positive
/// definite problem).
class TimeStepper {
 public:
  struct Options {
    double time_step_s = 1e-3;
    Eigen::Vector3d gravity_m_per_s2{0, 0, -9.81};
    /// Overlapping bodies are pushed apart at this speed at most.
    double correction_m_per_s = 0.1;
    FrictionRule friction_rule = FrictionRule::ellipsoid;
    /// If the solver has not reached its own tolerance, as can happen with nearly redundant
    /// contacts of stiff joints, its best point is taken up to this residual (see LcpResult). It is
    /// far below what a contact can feel.
    double accepted_residual = 1e-7;
    Eigen::Matrix3Xd friction_vertices;  ///< of FrictionRule::facets, see ContactLcp::vertices
  };

  /// @throws InputError for a time step that is not positive.
  TimeStepper(Multibody bodies, std::vector<Motor> motors, Options options);

  /// Makes one step. A step without solution moves nothing: bodies and time stay as they were.
  StepResult step(ContactFinder& finder);

  Multibody& bodies() { return bodies_; }
  const Multibody& bodies() const { return bodies_; }
  std::vector<Motor>& motors() { return motors_; }
  std::vector<AppliedForce>& applied_forces() { return applied_forces_; }
  void set_gravity(const Eigen::Vector3d& gravity_m_per_s2) {
    options_.gravity_m_per_s2 = gravity_m_per_s2;
  }
  double motor_effort(int m) const { return motor_efforts_[std::size_t(m)]; }
  double time_s() const { return double(steps_) * options_.time_step_s; }
  long steps() const { return steps_; }
  const Options& options() const { return options_; }

  /// Contacts of the last step, the mean force and torque that each exerts on body `b`, and the
  /// relative velocities at the end of the step, in the order of ContactLcp; of a contact with
  /// compliance the tangential ones are those of sliding.
  const std::vector<Contact>& contacts() const { return contacts_; }
  ContactWrench wrench(int contact) const;
  Eigen::Vector4d contact_velocity(int contact) const;
  double eccentricity_m(int contact) const { return problem_.eccentricity_m[contact]; }
  double friction_coefficient(int contact) const { return problem_.friction_coefficient[contact]; }
  /// The last problem, as solved; rows of joint limits and dry friction come behind the
  /// contacts. Assembled here. It
  /// has a root where those of all islands have.
  ContactLcp problem() const;
  const Eigen::VectorXd& free_velocity() const { return problem_.free_velocity; }  ///< its own
  const ContactSolution& solution() const { return solution_; }

 private:
  struct Island;
  struct Place {  ///< of a row: its island, and where in its list
    int island = -1, position = -1;
    bool operator==(const Place& other) const {
      return island == other.island && position == other.position;
    }
  };
  struct Touching {  ///< a row block of the problem and the columns of one tree
    int row = 0;
    int body_a = -1, body_b = -1;  ///< those of the tree, -1: the other side
    int joint = -1;                ///< a joint limit, or dry friction, instead
    double sign = 1;               ///< as that of `Limit`
  };

  void collect(ContactFinder& finder);
  bool drop_locked_contacts();
  bool add_broken_limits();
  void describe_rows();
  void factorise();
  void assemble();
  Island& island_of(const std::vector<Touching>& rows);
  void begin_roots();
  void add_to_root(const std::vector<Touching>& rows, const Eigen::MatrixXd& half);
  void add_tree(std::size_t tree);
  void add_compliance();
  bool faces_slide(const Island& island) const;
  bool has_springs(const Island& island, std::size_t row, Contact::FaceRole role) const;
  void add_springs(Island& island, Contact::FaceRole role, double sign = 1) const;
  void know_normal_impulse(int row, double impulse);
  double load_of_face(const Island& island, long face) const;
  double take_own_loads(Island& island);
  void add_dry_friction();
  double approach_m_per_s(const Contact& contact) const;
  Eigen::VectorXd row_velocities(const Eigen::VectorXd& velocity) const;
  void describe_rebounds();
  bool makes_energy() const;
  void describe_friction();
  void find_islands();
  void continue_same_islands();
  void continue_other_islands();
  void continue_row(Island& island, std::size_t i, const Island& before, int position);
  void describe(Island& island);
  LcpResult solve(Island& island, StepResult& result);
  LcpResult solve_with_springs(Island& island, StepResult& result);
  LcpResult solve_faces(Island& island, StepResult& result);
  LcpResult solve_under_own_loads(Island& island, StepResult& result);
  LcpResult solve_islands(StepResult& result);
  int update_motors(bool one_only);
  SmoothMotion::Forces forces_on(std::size_t tree) const;
  void prepare_smooth_motion();
  void keep_smooth_motion_apart();
  void move(StepResult& result);
  double unlimited_effort(int m) const;

  Multibody bodies_;
  std::vector<Motor> motors_;
  std::vector<AppliedForce> applied_forces_;
  Options options_;
  long steps_ = 0;
  std::vector<int> motor_limits_;  ///< -1, 0, 1: which limit the motor is at
  std::vector<double> motor_efforts_;
  std::vector<Contact> contacts_;
  struct Limit {
    int joint;
    double sign;  ///< 1: the lower one, -1: the upper one, or kDryFriction
    double gap;
  };
  static constexpr double kDryFriction = 0;
  std::vector<Limit> limits_;
  std::vector<std::vector<Touching>> touching_;  ///< per tree
  std::vector<ConstrainedMass> factors_;
  std::vector<Eigen::MatrixXd> loop_jacobians_;
  std::vector<Eigen::VectorXd> loop_openings_;
  std::vector<Eigen::MatrixXd> jacobians_, halves_;
  Eigen::VectorXd free_velocity_, new_velocity_, momentum_, passive_;
  std::vector<Eigen::MatrixXd> masses_, driven_masses_;  ///< driven: with those of motors
  Eigen::VectorXd change_;                               ///< of velocities by impulses
  Eigen::VectorXd row_values_;  ///< of one tree after the other, of the rows that touch it
  std::vector<int> root_columns_, root_elements_;  ///< per island, at most
  std::vector<double> face_impulses_;  ///< per row: the normal impulse under a face's friction
  Eigen::VectorXd approach_;           ///< per contact: its part in v_free besides velocities
  Eigen::VectorXd before_;             ///< row velocities before the step, of steps with rebounds
  double restitution_used_ = 1;
  bool rebounds_ = false;  ///< some contact, in this step
  ContactLcp problem_;     ///< of all rows, without W: each island has its own
  ContactSolution solution_;
  Eigen::SparseMatrix<double> no_root_;  ///< of islands whose faces have springs
  std::vector<Place> place_of_row_, last_places_;
  /// The largest entry of each contact's normal row, and of its first three rows.
  std::vector<std::pair<double, double>> opening_;
  std::vector<long> ids_, last_ids_;  ///< per row: contacts by their id, limits by -2 and less
  /// Rows that feel each other: a problem of its own, which remembers how it was solved.
  struct Island {
    std::vector<int> rows;
    std::vector<long> ids;
    ContactLcp problem;
    int root_columns = 0;  ///< of the problem's root, that are there
    ContactSolution solution;
    std::vector<const EccentricityLaw*> laws;
    std::optional<ConsistentContactSolver> solver;
    int capacity = 0;
    bool solved = false;                     ///< the last problem given to `solver`
    bool faces_slid = false;                 ///< in the last step
    bool has_springs = false;                ///< the problem's W, under rigid faces that slide
    std::vector<int> continued;              ///< see ContactLcpSolver::solve
    Eigen::VectorXd earlier_eccentricity_m;  ///< a step before that of `problem`; 0: none
    long step = -1;                          ///< in which it was found
  };
  std::vector<Island> islands_;
  std::vector<int> island_of_tree_;  ///< a tree of the same island
  std::vector<int> island_of_root_, island_sizes_;
  std::vector<SmoothMotion> smooth_motions_;  ///< per tree
  std::vector<char> is_smooth_;               ///< per tree: prepared, and of no loaded contact
};

}  // namespace softfinger
